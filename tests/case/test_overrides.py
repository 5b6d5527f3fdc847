from pathlib import Path

import pytest

from rbfem.case.reader import read_case
from rbfem.errors import InputError

CASE = """\
rbfem: 1
shapes: {ball: {sphere: {radius: 1}}}
materials: {steel: {density: 7850}}
bodies:
  - {name: nut, shape: ball, material: steel, loads: [{force: [0, 0, 1]}, {force: [0, 0, 2]}]}
  - {name: bolt, shape: ball, material: steel}
time: {end: 2}
"""


@pytest.fixture
def read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("case.yaml").write_text(CASE)
    return lambda *overrides: read_case("case.yaml", overrides)


def refusal(read, *overrides):
    with pytest.raises(InputError) as caught:
        read(*overrides)
    return str(caught.value)


def test_a_value_of_the_file_is_written_over(read):
    assert read("time.end=5").time.end == 5.0
    assert read("shapes.ball.sphere.radius=5 mm").shapes["ball"].sphere.radius == 0.005
    assert read("time={end: 3, step: 2e-3}").time.step == 2e-3


def test_a_body_goes_by_its_name_and_other_lists_by_index(read):
    case = read(
        "bodies.bolt.angular_velocity=[0,0,1]", "bodies.nut.loads.1.force=[1,0,0]", "bodies.nut.loads.0.force.2=7"
    )
    assert case.bodies[1].angular_velocity == (0.0, 0.0, 1.0)
    assert [load.force for load in case.bodies[0].loads] == [(0.0, 0.0, 7.0), (1.0, 0.0, 0.0)]


def test_keys_and_groups_that_the_file_lacks_are_made(read):
    case = read("title=a = b", "output.every=1/4", "bodies.bolt.place.in_box=[[0,0,0],[1,1,1]]", "bodies.bolt.count=3")
    assert case.title == "a = b"
    assert case.output.every == 0.25
    assert case.bodies[1].copy_names() == ("bolt.00", "bolt.01", "bolt.02")


def test_a_group_that_is_empty_in_the_file_can_be_filled(read):
    Path("case.yaml").write_text(CASE + "output:\n")
    assert read("output.every=1/4").output.every == 0.25


def test_an_override_is_where_its_value_was_written(read):
    case = read("time.end=5", "bodies.nut.name=screw")
    assert case.where("time.end") == "--set time.end=5"
    assert case.where("bodies.screw.shape") == "case.yaml:5"
    assert case.where("bodies.screw.name") == "--set bodies.nut.name=screw"


def test_what_is_within_an_overridden_value_comes_from_the_override(read):
    case = read("time={end: 5}")
    assert case.where("time.end") == "--set time={end: 5}"


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("time.end=-1", "expected a positive time in s, read -1"),
        ("time.ende=1", "unknown key 'ende'; did you mean 'end'?"),
        ("tim.end=1", "tim: unknown key 'tim'; did you mean 'time'?"),
        ("bodies.nutt.fixed=true", "no body 'nutt'; did you mean 'nut'?"),
        ("bodies.nut.shape=bal", "no shape 'bal'; did you mean 'ball'?"),
        ("bodies.nut.loads.2.force=[0,0,1]", "bodies.nut.loads has 2 items, counted from 0, and no item '2'"),
        ("bodies.nut.loads.x=[0,0,1]", "bodies.nut.loads has 2 items, counted from 0, and no item 'x'"),
        ("time.end.x=1", "time.end is 2, which holds no 'x'; set time.end as a whole"),
        ("time.end", "expected KEY=VALUE such as time.end=2, read 'time.end'"),
        ("=3", "expected KEY=VALUE such as time.end=2, read '=3'"),
        ("time..end=3", "expected KEY=VALUE such as time.end=2, read 'time..end=3'"),
        ("gravity=[0", "not YAML: while parsing a flow sequence"),
        ("time={end: 1, end: 2}", "time.end: the key is given twice, first at --set time={end: 1, end: 2}"),
        ("bodies=3", "expected a list, read 3"),
        ("bodies=", "expected a list, read nothing"),
    ],
)
def test_a_mistake_is_told_with_the_override_instead_of_a_line_and_names_the_key_once(read, override, message):
    assert refusal(read, override).startswith(f"--set {override}: {message}")


def test_mistakes_of_overrides_come_after_those_of_the_file(read):
    Path("case.yaml").write_text(CASE.replace("end: 2", "end: 0"))
    told = refusal(read, "seed=x", "title=3").splitlines()
    assert [line.partition(": ")[0] for line in told] == ["case.yaml:7", "--set seed=x", "--set title=3"]


def test_a_mistake_that_an_override_removes_is_still_told_if_it_is_in_the_text(read):
    Path("case.yaml").write_text(CASE.replace("{name: bolt,", "{name: bolt, name: bolt,"))
    assert "case.yaml:6: bodies.1.name: the key is given twice" in refusal(read, "bodies=[]")
