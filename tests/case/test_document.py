import pytest

from rbfem.case.document import MOST_VALUES, Origin, parse
from rbfem.errors import InputError


def at_line(line):
    return Origin(line, f"case.yaml:{line}")


def tree(text):
    document = parse(text, at_line)
    assert document.problems == []
    return document.tree


def refusal(text):
    with pytest.raises(InputError) as caught:
        parse(text, at_line)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2e-3", 2e-3),
        (".5e3", 500.0),
        ("1.", 1.0),
        ("010", 10),
        ("0o17", 15),
        ("0x1F", 31),
        ("-3", -3),
        ("+3", 3),
        ("1_000", "1_000"),
        ("_", "_"),
        ("yes", "yes"),
        ("on", "on"),
        ("true", True),
        ("12:30", "12:30"),
        ("2001-12-14", "2001-12-14"),
        ("1/60", "1/60"),
        ('"3"', "3"),
        ("'3'", "3"),
        ("~", None),
        ("", None),
        ("-.inf", float("-inf")),
        ("5 mm", "5 mm"),
        ("1" * 5000, float("inf")),
    ],
)
def test_a_plain_word_means_what_yaml_1_2_says(text, value):
    read = tree(f"key: {text}")["key"]
    assert read == value
    assert type(read) is type(value)


def test_every_value_knows_its_line():
    text = "a: 1\nb:\n  c: 2\n  d:\n    - x\n    - {e: 3,\n       f: 4}\ng:\nh:\n  5\n"
    lines = {path: origin.order for path, origin in parse(text, at_line).origins.items()}
    assert lines[("a",)] == 1
    assert lines[("b",)] == 2
    assert lines[("b", "c")] == 3
    assert lines[("b", "d")] == 4
    assert lines[("b", "d", 0)] == 5
    assert lines[("b", "d", 1, "e")] == 6
    assert lines[("b", "d", 1, "f")] == 7
    assert lines[("g",)] == 8
    assert lines[("h",)] == 10


def test_an_alias_is_a_copy():
    read = tree("a: &x [1, 2]\nb: *x")
    assert read == {"a": [1, 2], "b": [1, 2]}
    assert read["a"] is not read["b"]


def test_a_merge_key_brings_what_is_not_written():
    text = "a: &a {x: 1, y: 2}\nb: &b {y: 3, z: 4}\nc: {<<: [*a, *b], x: 5}"
    assert tree(text)["c"] == {"x": 5, "y": 2, "z": 4}


def test_a_merge_key_without_a_group_is_reported():
    document = parse("a:\n  <<: 3", at_line)
    assert [message for _, _, message in document.problems] == ["'<<' takes over the keys of a group, and this is none"]


def test_a_key_given_twice_is_reported_with_both_lines():
    document = parse("a: 1\nb: 2\na: 3", at_line)
    assert document.problems == [(at_line(3), ("a",), "the key is given twice, first at case.yaml:1")]


def test_a_key_that_is_no_word_is_reported():
    (problem,) = parse("[a, b]: 1", at_line).problems
    assert problem[2] == "a key is a word, not a list or a group"


def test_a_tag_is_reported():
    (problem,) = parse("a: !!python/object 3", at_line).problems
    assert "the tag 'tag:yaml.org,2002:python/object' is not used here" in problem[2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1, 2\nb: 3", "case.yaml:2: not YAML: while parsing a flow sequence"),
        ("a:\n\tb: 3", "indent with spaces, not with tabs"),
        ("a: b: c", "put text that holds ': ' in quotes"),
        ("a: *nobody", "case.yaml:1: not YAML: found undefined alias"),
        ("a: 1\n---\nb: 2", "case.yaml:2: not YAML: expected a single document"),
        ("a: 1\nb: \x07", "case.yaml:2: a character that text cannot hold"),
        ("a: " + "[" * 500, "nested deeper than 40 levels"),
        ("a: &a [*a]", "nested deeper than 40 levels, or an alias inside its own anchor"),
        ("a: &a {<<: *a}", "nested deeper than 40 levels, or an alias inside its own anchor"),
    ],
)
def test_what_is_not_yaml_is_refused_with_its_line(text, message):
    assert message in refusal(text)


@pytest.mark.parametrize("reference", ["[{}]", "{{<<: [{}]}}"])
def test_an_alias_bomb_is_refused_quickly(reference):
    lines = ["a0: &a0 {x: 1, y: 2}"]
    for level in range(1, 30):
        lines.append(f"a{level}: &a{level} " + reference.format(", ".join([f"*a{level - 1}"] * 10)))
    assert f"more than {MOST_VALUES} values" in refusal("\n".join(lines))


def test_an_anchor_may_be_used_again_without_a_warning(recwarn):
    assert tree("a: &x 1\nb: &x 2\nc: *x") == {"a": 1, "b": 2, "c": 2}
    assert not recwarn
