import math
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from rbfem.case.loads import ForceLoad, PointOfBody, SpringLoad
from rbfem.case.reader import LARGEST_FILE, read_case
from rbfem.case.reference import EXAMPLE
from rbfem.case.shapes import MeshField, SphereShape
from rbfem.errors import InputError

SMALL = """\
rbfem: 1
shapes:
  ball: {sphere: {radius: 5 mm}}
  nut: {mesh: nut.msh, unit: mm}
materials:
  steel: {density: 7850}
  sponge: {density: {field: rho}}
bodies:
  - {name: a, shape: ball, material: steel}
  - name: b
    shape: nut
    material: steel
time: {end: 2}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder, so that the paths in messages are as short as a user's."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x").mkdir()
    return tmp_path


def read(text, *overrides):
    Path("x/case.yaml").write_text(text, encoding="utf-8")
    return read_case("x/case.yaml", overrides)


def refusal(text, *overrides):
    with pytest.raises(InputError) as caught:
        read(text, *overrides)
    assert caught.value.exit_code == 2
    return str(caught.value)


def with_body(text):
    """SMALL with a body `c` of one ball whose further keys are `text`."""
    return SMALL.replace("time:", f"  - {{name: c, shape: ball, material: steel, {text}}}\ntime:")


def with_load(text):
    return with_body(f"loads: [{text}]")


# ---------------------------------------------------------------------------------------------------- what is read


def test_a_small_case_gets_its_defaults(folder):
    case = read(SMALL)
    assert (case.title, case.seed, case.accuracy, case.gravity) == ("", 0, 1e-3, (0, 0, 0))
    assert (case.time.end, case.time.step, case.time.method) == (2.0, "auto", "auto")
    assert (case.output.every, case.output.fields, case.expect) == (None, ("velocity",), ())
    body = case.bodies[0]
    assert (body.count, body.place, body.position, body.quaternion) == (1, None, (0, 0, 0), (1, 0, 0, 0))
    assert (body.velocity, body.angular_velocity, body.angular_velocity_body) == ((0, 0, 0), (0, 0, 0), None)
    assert (body.fixed, body.pivot, body.loads) == (False, None, ())


def test_every_value_of_the_example_is_read_in_si(folder):
    case = read(EXAMPLE)
    nut = case.bodies[1]
    assert isinstance(case.shapes["ball"], SphereShape)
    assert case.shapes["nut"].kind == "mesh"
    assert case.shapes["pebble"].ellipsoid.radii == (0.012, 0.009, 0.006)
    assert case.materials["steel"].density == 7850.0
    assert case.materials["sponge"].density == MeshField(field="rho")
    assert nut.angular_velocity == pytest.approx((0.0, 0.0, math.radians(30)), rel=3e-16)
    assert nut.loads[0] == ForceLoad(force=(0, 0, 10), at=(0, 0, 0.005), frame="body", ramp=((0, 0), (0.5, 1)))
    assert [load.kind for load in nut.loads] == [
        "force",
        "torque",
        "pressure",
        "traction",
        "spring",
        "drag",
        "gravity_gradient",
    ]
    assert nut.loads[2].pressure == 2000.0
    assert nut.loads[4].spring.to == PointOfBody(body="wall", at=(0, 0, 0.05))
    assert case.bodies[2].place.in_box == ((-0.5, -0.5, 1.0), (0.5, 0.5, 2.0))
    assert case.output.every == 1 / 60
    assert case.expect[0].value == 7.193e-3
    assert case.expect[0].tolerance == 1e-6


def test_a_spring_may_end_at_a_world_point(folder):
    load = read(with_load("{spring: {to: [0, 0, 1 cm], stiffness: 1}}")).bodies[2].loads[0]
    assert isinstance(load, SpringLoad)
    assert load.spring.to == (0.0, 0.0, 0.01)
    assert (load.spring.at, load.spring.damping, load.spring.rest_length) == (None, 0.0, 0.0)


def test_a_case_is_frozen(folder):
    case = read(SMALL)
    with pytest.raises(ValueError, match="frozen"):
        case.seed = 3
    with pytest.raises(ValueError, match="frozen"):
        case.bodies[0].fixed = True


def test_copies_have_numbered_names(folder):
    case = read(with_body("count: 101, place: {in_box: [[0, 0, 0], [1, 1, 0]]}"))
    names = case.bodies[2].copy_names()
    assert (names[0], names[100], len(names)) == ("c.000", "c.100", 101)
    assert case.bodies[0].copy_names() == ("a",)


# --------------------------------------------------------------------------------------------- files and their names


def test_a_folder_stands_for_its_case(folder):
    read(SMALL)
    case = read_case("x")
    assert (case.name, case.folder) == ("x", Path("x"))
    assert case.where("seed") == "x/case.yaml:1"


def test_a_case_in_the_working_folder_is_named_after_it(folder, monkeypatch):
    read(SMALL)
    monkeypatch.chdir(folder / "x")
    assert read_case("case.yaml").name == "x"


def test_another_file_is_named_after_itself(folder):
    Path("bolt.yaml").write_text(SMALL)
    assert read_case(Path("bolt.yaml")).name == "bolt"


def test_a_value_knows_its_line_and_an_absent_one_the_line_around_it(folder):
    case = read(SMALL)
    assert case.where("bodies.b.material") == "x/case.yaml:12"
    assert case.where("bodies.b.velocity") == "x/case.yaml:10"
    assert case.where("bodies.a.loads.0.at") == "x/case.yaml:9"
    assert case.where("shapes.ball.sphere.radius") == "x/case.yaml:3"
    assert case.where("output.every") == "x/case.yaml:1"
    error = case.error("bodies.b.shape", "no tetrahedra")
    assert isinstance(error, InputError)
    assert str(error) == "x/case.yaml:11: bodies.b.shape: no tetrahedra"


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("nothing", "nothing: no such file; expected a case.yaml or a folder that holds one"),
        ("x", "x: the folder holds no case.yaml"),
        ("/dev/null", "/dev/null: not a file; expected a case.yaml or a folder that holds one"),
        ("a\0b", "a\0b: no such file; expected a case.yaml or a folder that holds one"),
    ],
)
def test_a_path_without_a_case_is_refused(folder, path, message):
    with pytest.raises(InputError) as caught:
        read_case(path)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "x/case.yaml:1: expected keys, the first of them `rbfem: 1`, read an empty file"),
        (b"# nothing\n", "x/case.yaml:1: expected keys, the first of them `rbfem: 1`, read an empty file"),
        (b"- a\n- b\n", "x/case.yaml:1: expected keys, the first of them `rbfem: 1`, read ['a', 'b']"),
        (b"hello", "x/case.yaml:1: expected keys, the first of them `rbfem: 1`, read 'hello'"),
        (b"rbfem: 1\ntitle: \xff\xfe", "x/case.yaml:2: not UTF-8 text; a case file is text, save it as UTF-8"),
        (b"\x00\x01\x02", "x/case.yaml:1: a character that text cannot hold: '\\x00'"),
        (b"a" * (LARGEST_FILE + 1), "x/case.yaml: larger than 1 MB; a case is a short text, is this a mesh?"),
    ],
)
def test_a_file_that_is_no_case_is_refused(folder, data, message):
    Path("x/case.yaml").write_bytes(data)
    with pytest.raises(InputError) as caught:
        read_case("x/case.yaml")
    assert str(caught.value) == message


def test_a_byte_order_mark_is_no_mistake(folder):
    Path("x/case.yaml").write_bytes(b"\xef\xbb\xbf" + SMALL.replace("\n", "\r\n").encode())
    assert read_case("x").where("time.end") == "x/case.yaml:13"


# -------------------------------------------------------------------------------------------------- what is refused


def test_all_mistakes_are_told_at_once_in_the_order_of_the_file(folder):
    text = """\
        rbfem: 1
        shapes:
          nut: {mesh: nut.msh, unit: 3 mm}
        materials:
          granite:
            density: 2650
            poison: 0.25
        bodies:
          - {name: nut, shape: nutt, material: granit}
        time: {end: -1}
        gravity: [0, 0, 7.85 g/cm^3]
        """
    assert refusal(dedent(text)).splitlines() == [
        "x/case.yaml:3: shapes.nut.unit: expected a unit of length such as mm, read '3 mm': '3 mm' is not a unit",
        "x/case.yaml:7: materials.granite.poison: unknown key 'poison'; did you mean 'poisson'?",
        "x/case.yaml:9: bodies.nut.shape: no shape 'nutt'; did you mean 'nut'?",
        "x/case.yaml:9: bodies.nut.material: no material 'granit'; did you mean 'granite'?",
        "x/case.yaml:10: time.end: expected a positive time in s, read -1",
        "x/case.yaml:11: gravity: number 3: expected an acceleration in m/s^2, read '7.85 g/cm^3', "
        "which is a density in kg/m^3",
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rbfem: 1\n", "", "1: missing key 'rbfem' (Version of this format: 1)"),
        ("rbfem: 1", "rbfem: 2", "1: rbfem: expected 1, read 2"),
        ("rbfem: 1", "rbfem: 1\ntitle: 3", "2: title: expected text (numbers go in quotes), read 3"),
        ("rbfem: 1", "rbfem: 1\nseed: -1", "2: seed: expected a whole number from 0, read -1"),
        ("rbfem: 1", "rbfem: 1\nseed: 1.5", "2: seed: expected a whole number, read 1.5"),
        ("rbfem: 1", "rbfem: 1\nseed: true", "2: seed: expected a whole number, read true"),
        ("rbfem: 1", "rbfem: 1\naccuracy: 1", "2: accuracy: expected a positive number below 1, read 1"),
        ("rbfem: 1", "rbfem: 1\naccuracy: 0", "2: accuracy: expected a positive number below 1, read 0"),
        ("rbfem: 1", "rbfem: 1\nwalls: []", "2: walls: unknown key 'walls'; "),
        ("rbfem: 1", "rbfem: 1\ngravty: [0, 0, 0]", "2: gravty: unknown key 'gravty'; did you mean 'gravity'?"),
        ("rbfem: 1", "rbfem: 1\ngravity: 9.81", "2: gravity: expected a list of 3 numbers (acceleration in m/s^2), "),
        ("rbfem: 1", "rbfem: 1\ngravity: [0, .nan, 0]", "2: gravity: number 2: expected an acceleration in m/s^2, "),
        ("rbfem: 1", "rbfem: 1\nrbfem: 1", "2: rbfem: the key is given twice, first at x/case.yaml:1"),
        ("{radius: 5 mm}", "{radius: 0}", "3: shapes.ball.sphere.radius: expected a positive length in m, read 0"),
        ("{radius: 5 mm}", "5 mm", "3: shapes.ball.sphere: expected a group of keys (key: value), read '5 mm'"),
        ("{radius: 5 mm}", "", "3: shapes.ball.sphere: expected a group of keys (key: value), read nothing"),
        ("{radius: 5 mm}", "{}", "3: shapes.ball.sphere: missing key 'radius' (Radius)"),
        ("sphere: {radius", "shpere: {radius", "did you mean 'sphere'?"),
        (
            "sphere: {radius",
            "surface: {radius",
            "3: shapes.ball: expected one of mesh, sphere, box, cylinder, ellipsoid",
        ),
        (
            "sphere: {radius",
            "mesh: a.msh, sphere: {radius",
            "3: shapes.ball.sphere: unknown key 'sphere' beside 'mesh'",
        ),
        ("mesh: nut.msh", "mesh: ''", "4: shapes.nut.mesh: expected text, read an empty one"),
        (
            "unit: mm",
            "unit: kg",
            "4: shapes.nut.unit: expected a unit of length such as mm, read 'kg', which is a mass",
        ),
        ("{mesh: nut.msh, unit: mm}", "{box: {size: [1, 0, 1]}}", "number 2: expected a positive length in m, read 0"),
        ("{mesh: nut.msh, unit: mm}", "{cylinder: {radius: 1}}", "shapes.nut.cylinder: missing key 'height'"),
        ("{mesh: nut.msh, unit: mm}", "{ellipsoid: {radii: [1, 1]}}", "expected a list of 3 numbers (length in m)"),
        ("density: 7850", "density: -1", "6: materials.steel.density: expected a positive density in kg/m^3, read -1"),
        ("density: 7850", "density: .nan", "read nan, which is not finite"),
        ("density: 7850", "density: [1]", "expected a positive density in kg/m^3, read [1]"),
        (
            "{field: rho}",
            "{field: }",
            "7: materials.sponge.density.field: expected text (numbers go in quotes), read n",
        ),
        ("{field: rho}", "{feld: rho}", "unknown key 'feld'; did you mean 'field'?"),
        ("steel: {", "by-group: {", "materials.by-group: 'by-group' has a meaning of its own: choose another name"),
        ("name: a", "name: a b", "9: bodies.a b.name: expected a name of letters, digits, '_' and '-', read 'a b'"),
        ("name: a", "name: b", "10: bodies.b.name: a body 'b' exists already: names are unique"),
        ("name: a", "name: 3", "9: bodies.0.name: expected text (numbers go in quotes), read 3"),
        ("name: a, ", "", "9: bodies.0: missing key 'name' (Its name; copies are called NAME.00, NAME.01, …)"),
        ("shape: ball", "shape: bal", "9: bodies.a.shape: no shape 'bal'; did you mean 'ball'?"),
        (
            "shape: ball, material: steel",
            "shape: ball, material: by-group",
            "shape 'ball' is no mesh and has no groups",
        ),
        (
            "shape: ball, material: steel",
            "shape: ball, material: sponge",
            "the density of 'sponge' is a field of a mesh",
        ),
        ("end: 2", "end: 0 s", "13: time.end: expected a positive time in s, read '0 s'"),
        ("end: 2", "end: 2, step: fast", "13: time.step: expected a positive time in s or auto, read 'fast'"),
        ("end: 2", "end: 2, step: 0", "13: time.step: expected a positive time in s or auto, read 0"),
        ("end: 2", "end: 2, method: ''", "13: time.method: expected text, read an empty one"),
        ("time: {end: 2}", "time:", "13: time: expected a group of keys (key: value), read nothing"),
        ("time: {end: 2}", "time: {end: 2}\noutput: {every: 0}", "output.every: expected a positive time in s, read 0"),
        (
            "time: {end: 2}",
            "time: {end: 2}\noutput: {fields: [speed, velocty]}",
            "14: output.fields.1: expected 'velocity' or 'density', read 'velocty'; did you mean 'velocity'?",
        ),
        (
            "time: {end: 2}",
            "time: {end: 2}\noutput: {fields: [density, density]}",
            "14: output.fields: expected each name once, read ['density', 'density']",
        ),
        (SMALL[SMALL.index("  - {name") : SMALL.index("time")], "  []\n", "9: bodies: expected at least one, read an"),
        (SMALL[SMALL.index("  - {name") : SMALL.index("time")], "  a: 1\n", "8: bodies: expected a list, read {a: 1}"),
        ("shapes:\n", "shapes: 3\n#", "not YAML"),
    ],
)
def test_a_mistake_is_told_with_its_line(folder, old, new, message):
    assert old in SMALL
    text = refusal(SMALL.replace(old, new))
    assert message in text
    assert text.startswith("x/case.yaml:")


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("young: 3", "13: bodies.c.young: unknown key 'young'; "),
        ("recover: stress", "unknown key 'recover'; "),
        ("positon: [0, 0, 0]", "unknown key 'positon'; did you mean 'position'?"),
        ("count: 0", "bodies.c.count: expected a whole number from 1, read 0"),
        ("count: 100000000000", "bodies.c.count: expected a whole number up to 10000000, read 100000000000"),
        ("count: 3", "bodies.c.count: 3 copies need `place`, or all would start in one spot"),
        ("fixed: yes", "bodies.c.fixed: expected true or false, read 'yes'"),
        ("fixed: 1", "bodies.c.fixed: expected true or false, read 1"),
        ("quaternion: [0, 0, 0, 0]", "expected a quaternion of length about 1 (it is scaled to 1), read [0, 0, 0, 0]"),
        ("quaternion: [1e-200, 0, 0, 0]", "expected a quaternion of length about 1"),
        ("quaternion: [1e40, 0, 0, 0]", "expected a quaternion of length about 1"),
        ("velocity: [1e200, 0, 0]", "of at most 1e+50 in size, read 1e+200"),
        ("quaternion: [.nan, 0, 0, 1]", "bodies.c.quaternion: number 1: expected a number, read nan, which is not fin"),
        ("quaternion: [1, 0, 0]", "bodies.c.quaternion: expected a list of 4 numbers, read [1, 0, 0]"),
        ("velocity: [1, 2, true]", "bodies.c.velocity: number 3: expected a velocity in m/s, read true"),
        ("angular_velocity: [0, 0, 5 Hz]", "expected an angular velocity in rad/s, read '5 Hz', which is in 1 / s"),
        (
            "angular_velocity: [0, 0, 1], angular_velocity_body: [0, 0, 1]",
            "'angular_velocity_body' does not go with 'angular_velocity': they are one velocity in two frames",
        ),
        (
            "fixed: true, pivot: [0, 0, 0]",
            "'fixed' does not go with 'pivot': a fixed body does not turn about anything",
        ),
        ("fixed: true, velocity: [0, 0, 1]", "'velocity' does not go with 'fixed': a fixed body does not move"),
        ("fixed: true, angular_velocity: [0, 0, 1]", "'angular_velocity' does not go with 'fixed': "),
        ("fixed: true, angular_velocity_body: [0, 0, 1]", "'angular_velocity_body' does not go with 'fixed': "),
        ("pivot: [0, 0, 0], velocity: [0, 0, 1]", "'velocity' does not go with 'pivot': it follows from the pivot"),
        ("pivot: [0, 0, 0], count: 2", "'pivot' does not go with 'count' above 1: write the bodies one by one"),
        ("pivot: [0, 0, 0], place: {in_box: [[0, 0, 0], [1, 1, 1]]}", "'place' does not go with 'pivot': "),
        ("position: [0, 0, 0], place: {in_box: [[0, 0, 0], [1, 1, 1]]}", "'position' does not go with 'place': "),
        (
            "quaternion: [1, 0, 0, 0], place: {in_box: [[0, 0, 0], [1, 1, 1]], orientation: random}",
            "'quaternion' does not go with a random orientation of 'place'",
        ),
        ("place: {in_box: [[0, 0, 2], [1, 1, 1]]}", "expected [[lowest x, y, z], [highest x, y, z]] in m, read [[0.0"),
        ("place: {in_box: [[0, 0, 2]]}", "place.in_box: expected a list of 2 items, read a shorter one"),
        ("place: {in_box: [[0, 0, 2], [1, 1, 3], 1]}", "place.in_box: expected a list of 2, read [[0, 0, 2], [1, 1, 3"),
        ("place: {in_box: [[0, 0, 0], [1, 1, 1]], orientation: rndom}", "did you mean 'random'?"),
        ("loads: {force: [0, 0, 1]}", "bodies.c.loads: expected a list, read {force: [0, 0, 1]}"),
    ],
)
def test_a_mistake_in_a_body_is_told(folder, keys, message):
    assert message in refusal(with_body(keys))


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ("3", "bodies.c.loads.0: expected one of force, torque, pressure, traction, spring, drag, gravity_grad"),
        ("{forse: [0, 0, 1]}", "bodies.c.loads.0: expected one of force, torque"),
        ("{forse: [0, 0, 1]}", "; did you mean 'force'?"),
        ("{}", "bodies.c.loads.0: expected one of force"),
        ("{force: [0, 0, 1], torque: [0, 0, 1]}", "loads.0.torque: unknown key 'torque' beside 'force'; known here: "),
        (
            "{force: [0, 0, 1 Pa]}",
            "loads.0.force: number 3: expected a force in N, read '1 Pa', which is a pressure in ",
        ),
        ("{force: [0, 0, 1], on: left}", "unknown key 'on' beside 'force'; known here: force, at, frame, ramp"),
        ("{force: [0, 0, 1], frame: bdy}", "frame: expected 'world' or 'body', read 'bdy'; did you mean 'body'?"),
        ("{torque: [0, 0, 1], at: [0, 0, 0]}", "unknown key 'at' beside 'torque'"),
        ("{pressure: 1}", "bodies.c.loads.0: missing key 'on' (Name of a surface group of the mesh)"),
        ("{pressure: [1], on: left}", "loads.0.pressure: expected a pressure in Pa, read [1]"),
        ("{pressure: 1, on: left, frame: body}", "unknown key 'frame' beside 'pressure'"),
        ("{traction: 1, on: left}", "loads.0.traction: expected a list of 3 numbers (pressure in Pa), read 1"),
        ("{force: [0, 0, 1], ramp: []}", "loads.0.ramp: expected at least one, read an empty list"),
        ("{force: [0, 0, 1], ramp: [[1, 1], [0, 0]]}", "loads.0.ramp: expected ascending times, read [1.0, 0.0]"),
        ("{force: [0, 0, 1], ramp: [[1, 1], [1, 0]]}", "expected ascending times, read [1.0, 1.0]"),
        ("{force: [0, 0, 1], ramp: [[1]]}", "loads.0.ramp.0: expected a list of 2 items, read a shorter one"),
        (
            "{force: [0, 0, 1], ramp: [[1 mm, 2]]}",
            "loads.0.ramp.0.0: expected a time in s, read '1 mm', which is a len",
        ),
        ("{spring: {to: [0, 0, 1]}}", "loads.0.spring: missing key 'stiffness' (Force per elongation)"),
        ("{spring: {stiffness: 1}}", "loads.0.spring: missing key 'to' (The other end"),
        ("{spring: {to: 3, stiffness: 1}}", "spring.to: expected a list of 3 numbers (length in m), read 3"),
        ("{spring: {to: [0, 0, 1], stiffness: -1}}", "expected a stiffness in N/m that is at least 0, read -1"),
        ("{spring: {to: [0, 0, 1], stiffness: 1, damping: -1}}", "expected a damping in N s/m that is at least 0"),
        ("{spring: {to: [0, 0, 1], stiffness: 1, rest_length: -1}}", "expected a length in m that is at least 0"),
        ("{spring: {to: [0, 0, 1], stiffness: 1}, ramp: [[0, 1]]}", "unknown key 'ramp' beside 'spring'"),
        ("{spring: {to: {body: bb}, stiffness: 1}}", "spring.to.body: no body 'bb'; did you mean 'b'?"),
        ("{spring: {to: {body: c}, stiffness: 1}}", "spring.to.body: a spring from 'c' to itself: name another body"),
        ("{spring: {to: {body: b, att: 1}, stiffness: 1}}", "spring.to.att: unknown key 'att'; did you mean 'at'?"),
        ("{drag: {linear: -1}}", "drag.linear: expected a damping in N s/m that is at least 0, read -1"),
        (
            "{drag: {angular: 1 N s/m}}",
            "drag.angular: expected an angular damping in N m s that is at least 0, read '1",
        ),
        (
            "{gravity_gradient: {rate: 1, start: [1, 0, 0]}}",
            "gravity_gradient: missing key 'normal' (Axis of the orbit",
        ),
        (
            "{gravity_gradient: {rate: 0, normal: [0, 0, 1], start: [1, 0, 0]}}",
            "rate: expected a positive angular velocity in rad/s, read 0",
        ),
        (
            "{gravity_gradient: {rate: 1 Hz, normal: [0, 0, 1], start: [1, 0, 0]}}",
            "rate: expected a positive angular velocity in rad/s, read '1 Hz'",
        ),
        (
            "{gravity_gradient: {rate: 1, normal: [0, 0, 0], start: [1, 0, 0]}}",
            "gravity_gradient.normal: expected a direction (it is scaled to length 1), read [0.0, 0.0, 0.0], whi",
        ),
        (
            "{gravity_gradient: {rate: 1, normal: [0, 0, 1], start: [0, 0, 0]}}",
            "gravity_gradient.start: expected a direction (it is scaled to length 1), read [0.0, 0.0, 0.0], whi",
        ),
        (
            "{gravity_gradient: {rate: 1, normal: [0, 0, 2], start: [3, 0, 3]}}",
            "gravity_gradient.start: expected a direction at right angles to `normal`, read one at 45 deg to it; ",
        ),
        (
            "{gravity_gradient: {rate: 1, normal: [0, 1, 2], start: [0, 1, -0.50000001]}}",
            "start: expected a direction at right angles to `normal`, read one at 90.0000004",
        ),
        ("{gravity_gradient: {rate: 1, normal: 3, start: [1, 0, 0]}}", "normal: expected a list of 3 numbers, read 3"),
    ],
)
def test_a_mistake_in_a_load_is_told(folder, load, message):
    assert message in refusal(with_load(load))


def test_a_gravity_gradient_takes_directions_of_any_length(folder):
    field = "{gravity_gradient: {rate: 1 deg/min, normal: [0, 3e-30, 4e-30], start: [0, -8, 6]}}"
    gradient = read(with_load(field)).bodies[2].loads[0].gravity_gradient
    assert gradient.rate == pytest.approx(math.radians(1) / 60)
    assert gradient.normal == pytest.approx((0.0, 0.6, 0.8)) and gradient.start == pytest.approx((0.0, -0.8, 0.6))


def test_a_gravity_gradient_is_refused_on_a_pivot(folder):
    field = "{gravity_gradient: {rate: 1, normal: [0, 0, 1], start: [1, 0, 0]}}"
    told = refusal(with_body(f"pivot: [0, 0, 0], loads: [{{torque: [1, 0, 0]}}, {field}]"))
    assert "bodies.c.loads.1.gravity_gradient: 'gravity_gradient' does not go with 'pivot': its torque is that" in told


GOOD_EXPECT = {"quantity": "bodies.a.mass", "value": "1", "tolerance": "1e-3", "source": "sum"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"quantity": "bodies.d.mass"}, "expect.0.quantity: no body 'd'; "),
        ({"quantity": "bodies.a.mas"}, "expect.0.quantity: no quantity 'mas'; did you mean 'mass'?"),
        ({"quantity": "bodies.a.00.mass"}, "expect.0.quantity: no body 'a.00'"),
        ({"quantity": "bodies.mass"}, "expected bodies.NAME.QUANTITY or total.QUANTITY, read 'bodies.mass'"),
        ({"quantity": "total.enrgy"}, "no quantity 'enrgy'; did you mean 'energy'?"),
        ({"quantity": "energy"}, "expected bodies.NAME.QUANTITY or total.QUANTITY, read 'energy'"),
        ({"quantity": "total.a.energy"}, "expected bodies.NAME.QUANTITY or total.QUANTITY"),
        ({"quantity": "bodies.a.position"}, "expect.0.value: expected a list of 3 numbers (length in m), read 1"),
        ({"value": "[1, 2]"}, "expect.0.value: expected a mass in kg, read [1, 2]"),
        ({"value": "1 m"}, "expected a mass in kg, read '1 m', which is a length in m"),
        ({"tolerance": "0"}, "expect.0.tolerance: expected a positive mass in kg, read 0"),
        ({"source": "''"}, "expect.0.source: expected text, read an empty one"),
        ({"source": None}, "expect.0: missing key 'source' (Where the value is known from)"),
        ({"at": "2.5"}, "expect.0.at: expected a time up to the end at 2 s, read 2.5"),
        ({"at": "-1"}, "expect.0.at: expected a time in s that is at least 0, read -1"),
    ],
)
def test_a_mistake_in_an_expectation_is_told(folder, change, message):
    keys = {key: value for key, value in (GOOD_EXPECT | change).items() if value is not None}
    line = ", ".join(f"{key}: {value}" for key, value in keys.items())
    assert message in refusal(f"{SMALL}expect: [{{{line}}}]\n")


def test_a_good_expectation_is_read(folder):
    line = ", ".join(f"{key}: {value}" for key, value in GOOD_EXPECT.items())
    assert read(f"{SMALL}expect: [{{{line}, at: 2}}]\n").expect[0].at == 2.0


@pytest.mark.parametrize(
    ("name", "refused"),
    [("c.00", False), ("c.11", False), ("c.12", True), ("c", True), ("c.0", True), ("c.000", True), ("c.x", True)],
)
def test_a_copy_is_named_with_its_number(folder, name, refused):
    text = with_body("count: 12, place: {in_box: [[0, 0, 0], [1, 1, 1]]}")
    text += f"expect: [{{quantity: bodies.{name}.mass, value: 1, tolerance: 1, source: x}}]\n"
    if refused:
        assert "expect.0.quantity: 'c' is 12 bodies: name one of c.00 … c.11" in refusal(text)
    else:
        assert read(text).expect[0].quantity == f"bodies.{name}.mass"


def test_rules_are_checked_even_where_the_schema_found_mistakes(folder):
    text = refusal(with_body("fixed: 3, shpe: 1, velocity: x, pivot: [0, 0, 0], count: 2"))
    assert "'velocity' does not go with 'pivot'" in text
    assert "unknown key 'shpe'" in text
    assert "expected true or false, read 3" in text


# -------------------------------------------------------------------------------------------------- what is imported


@pytest.mark.parametrize("text", [SMALL.replace("5 mm", "0.005").replace(", unit: mm", "")])
def test_a_case_without_units_is_read_without_numpy_and_pint(folder, text):
    Path("x/case.yaml").write_text(text)
    code = (
        "import sys; from rbfem.case.reader import read_case; read_case('x'); "
        "sys.exit(str({'numpy', 'pint'} & set(sys.modules)) if {'numpy', 'pint'} & set(sys.modules) else 0)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=_environment(), check=False)
    assert run.returncode == 0, run.stderr


def _environment():
    import os

    import rbfem

    return os.environ | {"PYTHONPATH": str(Path(next(iter(rbfem.__path__))).parent)}
