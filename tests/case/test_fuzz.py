"""Whatever the file holds: a Case or an InputError, and soon."""

import json
import tempfile
from copy import deepcopy
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from rbfem.case.reader import read_case
from rbfem.case.reference import EXAMPLE
from rbfem.case.schema import Case, json_schema
from rbfem.errors import InputError

# Reading takes milliseconds; the deadline only has to tell a slow machine from a hang.
fuzzed = settings(max_examples=60, deadline=5000, suppress_health_check=[HealthCheck.too_slow])

KEYS = sorted({key for section in [json_schema(), *json_schema()["$defs"].values()] for key in section["properties"]})
WORDS = ["nut", "wall", "steel", "by-group", "auto", "world", "random", "bodies.nut.mass", "total.energy", "<mesh>",
         "5 mm", "1/60", "30 deg/s", "7.85 g/cm^3", "[key]", "<<", ""]  # fmt: skip

scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.sampled_from(WORDS)
    | st.text(max_size=10)
    | st.sampled_from([0, 1, 2, -1, 10**30, 1e308])
)
keys = st.sampled_from(KEYS) | st.sampled_from(WORDS)
trees = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(keys, inner, max_size=5), max_leaves=12
)


def outcome(data, overrides=()):
    """None for a case, the message for a refusal; anything else is the bug that is looked for."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "case.yaml")
        file.write_bytes(data)
        try:
            case = read_case(file, overrides)
        except InputError as error:
            return str(error)
    assert isinstance(case, Case)
    return None


def written(tree):
    """JSON, which is YAML in flow style."""
    return json.dumps(tree).encode()


def paths(tree, path=()):
    yield path
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield from paths(value, (*path, key))


TREE = YAML(typ="safe", pure=True).load(EXAMPLE)


def example_tree():
    return deepcopy(TREE)


PATHS = [path for path in paths(TREE) if path]


def test_the_example_itself_is_a_case():
    assert outcome(EXAMPLE.encode()) is None


@fuzzed
@given(st.binary(max_size=200))
def test_bytes(data):
    outcome(data)


@fuzzed
@given(st.text(max_size=200))
def test_text(text):
    outcome(text.encode("utf-8", "surrogatepass"))


@fuzzed
@given(st.text(alphabet="[]{}:,-?&*!|>'\"%@` \n\t#ab1.<~", max_size=80))
def test_punctuation(text):
    outcome(text.encode())


@fuzzed
@given(st.dictionaries(keys, trees, max_size=8))
def test_trees_of_known_keys(tree):
    outcome(written({"rbfem": 1, **tree}))


@fuzzed
@given(st.sampled_from(PATHS), trees)
def test_a_valid_case_with_another_value_somewhere(path, value):
    tree = example_tree()
    holder = tree
    for part in path[:-1]:
        holder = holder[part]
    holder[path[-1]] = value
    outcome(written(tree))


@fuzzed
@given(st.sampled_from([path for path in PATHS if isinstance(path[-1], str)]), keys)
def test_a_valid_case_with_another_key_somewhere(path, key):
    tree = example_tree()
    holder = tree
    for part in path[:-1]:
        holder = holder[part]
    holder[key] = holder.pop(path[-1])
    outcome(written(tree))


@fuzzed
@given(st.integers(0, len(EXAMPLE)))
def test_a_valid_case_cut_off(length):
    outcome(EXAMPLE.encode()[:length])


@fuzzed
@given(st.integers(0, len(EXAMPLE) - 1), st.integers(0, 255))
def test_a_valid_case_with_a_byte_changed(place, byte):
    data = bytearray(EXAMPLE.encode())
    data[place] = byte
    outcome(bytes(data))


@fuzzed
@given(st.lists(st.tuples(st.lists(keys | st.text(max_size=5), max_size=4), st.text(max_size=20)), max_size=3))
def test_overrides(overrides):
    outcome(EXAMPLE.encode(), [".".join(parts) + "=" + value for parts, value in overrides])


@fuzzed
@given(st.sampled_from(PATHS), trees)
def test_an_override_of_a_key_of_the_case(path, value):
    parts = [str(part) for part in path]
    if len(path) > 1 and path[0] == "bodies":
        parts[1] = example_tree()["bodies"][path[1]]["name"]
    text = written(value).decode()
    outcome(EXAMPLE.encode(), [".".join(parts) + "=" + text])


@pytest.mark.parametrize(
    "text", ["!" * 20_000, "[" * 20_000, "- " * 20_000, "a: &a " * 5000, "? " * 20_000, "{a: " * 5000]
)
def test_long_monotonous_text(text):
    assert outcome(text.encode())
