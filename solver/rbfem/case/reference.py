"""The reference page of the case file, written from the schema."""

import json
from collections.abc import Iterator
from typing import Any

from rbfem.case.expectations import QUANTITIES_IN_TOTAL, QUANTITIES_OF_A_BODY
from rbfem.case.rules import EXCLUDES
from rbfem.case.schema import Case
from rbfem.case.units import COMMON_UNITS

Node = dict[str, Any]

INTRODUCTION = """# The case file

A case is a YAML 1.2 file, `case.yaml`. Numbers are SI. Wherever a number is expected, a string may stand that carries a
unit (`5 mm`, `7.85 g/cm^3`, `30 deg/s`) or is a fraction (`1/60`). A key that is not on this page is refused.
`--set KEY=VALUE` on the command line writes over a value; the key is dotted, and a body goes by its name:
`--set bodies.nut.velocity=[0,0,1]`. Paths of mesh files start at the folder of the case.
"""

EXAMPLE = """\
rbfem: 1
title: A nut on a spring above a wall, and twenty pebbles
seed: 7
accuracy: 1e-3

shapes:
  nut: {mesh: nut.msh, unit: mm}
  pebble: {ellipsoid: {radii: [12 mm, 9 mm, 6 mm]}}
  wall: {box: {size: [2, 2, 0.1]}}
  rod: {cylinder: {radius: 1 cm, height: 0.4}}
  ball: {sphere: {radius: 5 cm}}

materials:
  steel: {density: 7.85 g/cm^3}
  stone: {density: 2650, young: 50 GPa, poisson: 0.25}
  sponge: {density: {field: rho}}
  glass: {density: 2500, young: 70 GPa, poisson: 0.2}

contacts:                                 # without a rule bodies pass through each other
  - {between: [glass, glass], law: hertz, restitution: 0.9, friction: 0.2}
  - {between: [glass, sponge], law: linear, normal_stiffness: 1e4, restitution: 0.5, friction: 0.4}

bodies:
  - {name: wall, shape: wall, material: stone, position: [0, 0, -1], fixed: true}
  - name: nut
    shape: nut
    material: by-group
    position: [0, 0, 0.2]
    quaternion: [1, 0, 0, 0]
    velocity: [0, 0, -1]
    angular_velocity: [0, 0, 30 deg/s]
    loads:
      - {force: [0, 0, 10 N], at: [0, 0, 5 mm], frame: body, ramp: [[0, 0], [0.5, 1]]}
      - {torque: [0, 0, 1 N mm]}
      - {pressure: 2 kPa, on: top}
      - {traction: [0, 1 kPa, 0], on: top}
      - {spring: {at: [0, 0, 5 mm], to: {body: wall, at: [0, 0, 5 cm]}, stiffness: 100, damping: 1, rest_length: 1}}
      - {drag: {linear: 0.1, angular: 1e-4}}
      - {gravity_gradient: {rate: 1.1e-3, normal: [0, 0, 1], start: [1, 0, 0]}}
  - name: pebble
    shape: pebble
    material: stone
    count: 20
    place: {in_box: [[-0.5, -0.5, 1], [0.5, 0.5, 2]], orientation: random}
  - {name: rod, shape: rod, material: steel, pivot: [1, 0, 0.2], position: [1, 0, 0], angular_velocity_body: [1, 0, 0]}
  - {name: soft, shape: nut, material: sponge, position: [0.3, 0, 0]}

gravity: [0, 0, -9.81]
time: {end: 4, step: auto, method: auto}
output: {every: 1/60, fields: [velocity, density]}
expect:
  - {quantity: bodies.pebble.07.mass, at: 0, value: 7.193 g, tolerance: 1 mg, source: "4/3 pi a b c times the density"}
  - {quantity: total.work, at: 0, value: 0, tolerance: 1e-12, source: "nothing has moved yet"}
"""


def reference_page() -> str:
    """Markdown: every key with meaning, unit and default, what excludes what, quantities, units, an example."""
    schema = Case.model_json_schema()
    parts = [INTRODUCTION]
    parts += [_section(label, section) for label, section in _sections(schema)]
    parts += [_exclusions(), _quantities(), _units(), f"## Example\n\n```yaml\n{EXAMPLE}```\n"]
    return "\n".join(parts)


def _sections(schema: Node) -> Iterator[tuple[str, Node]]:
    """(dotted label, section) of the case and of every section below it, each once, in the order of the keys."""
    seen: set[str] = set()

    def below(label: str, section: Node) -> Iterator[tuple[str, Node]]:
        yield label, section
        for key, node in section["properties"].items():
            for inner, name in _references(f"{label}.{key}".lstrip("."), node):
                if name not in seen:
                    seen.add(name)
                    yield from below(inner, schema["$defs"][name])

    return below("", schema)


def _references(label: str, node: Any) -> Iterator[tuple[str, str]]:
    """(label, name) of the sections that may stand at a property."""
    if "$ref" in node:
        yield label, node["$ref"].rpartition("/")[2]
    for choice in (*node.get("oneOf", ()), *node.get("anyOf", ())):
        yield from _references(label, choice)
    for inside, suffix in (("items", "[]"), ("additionalProperties", ".NAME")):
        if isinstance(node.get(inside), dict):
            yield from _references(label + suffix, node[inside])


def _section(label: str, section: Node) -> str:
    title = f"`{label}`" if label else "Top level"
    lead = section.get("description", "").partition("\n")[0] if label else ""
    rows = [_row(key, node, section) for key, node in section["properties"].items()]
    table = ["| key | meaning | unit | default |", "|---|---|---|---|", *rows]
    heading = f"## {title}: {next(iter(section['properties']))}" if label and _is_kind(section) else f"## {title}"
    return "\n".join([heading, "", *([lead, ""] if lead else []), *table, ""])


def _is_kind(section: Node) -> bool:
    return section["title"].endswith(("Shape", "Load"))


def _row(key: str, node: Node, section: Node) -> str:
    meaning = node["description"].replace("|", "\\|")
    if choices := _choices(node):
        meaning += " One of " + ", ".join(f"`{choice}`" for choice in choices) + "."
    return f"| `{key}` | {meaning} | {_unit(node)} | {_default(key, node, section)} |"


def _default(key: str, node: Node, section: Node) -> str:
    if key in section.get("required", ()):
        return "required"
    if node.get("default") in (None, ""):
        return ""
    return f"`{json.dumps(node['default'])}`"


def _choices(node: Node) -> list[str]:
    return node.get("enum") or node.get("items", {}).get("enum") or []


def _unit(node: Any) -> str:
    """The first unit at a property, however deep in its alternatives."""
    if not isinstance(node, dict):
        return ""
    alternatives = [*node.get("oneOf", ()), *node.get("anyOf", ()), node.get("items")]
    return node.get("x-unit") or next((unit for unit in map(_unit, alternatives) if unit), "")


def _exclusions() -> str:
    rows = [f"- `{first}` and `{second}`: {reason}." for (first, second), reason in EXCLUDES.items()]
    more = [
        "- `pivot` and `count` above 1: write such bodies one by one.",
        "- `quaternion` and a random `place.orientation`.",
        "- `count` above 1 needs `place`.",
        "- `pivot` and a `gravity_gradient` among the loads: its torque is that about the centre of mass.",
    ]
    return "\n".join(["## Keys of a body that exclude each other", "", *rows, *more, ""])


def _quantities() -> str:
    rows = [
        f"| `{owner}.{name}` | {dimension.unit} | {size} |"
        for owner, table in (("bodies.NAME", QUANTITIES_OF_A_BODY), ("total", QUANTITIES_IN_TOTAL))
        for name, (dimension, size) in table.items()
    ]
    head = ["## Quantities of `expect`", "", "| quantity | unit | numbers |", "|---|---|---|"]
    return "\n".join([*head, *rows, ""])


def _units() -> str:
    listed = ", ".join(f"`{unit}`" for unit in COMMON_UNITS)
    return (
        f"## Units\n\n{listed}.\nWith the prefixes u, m, c, k, M and G, and combined by `*` or a space, `/` and `^`: "
        "`kg/m^3`, `N m`, `mm/s^2`. An angular velocity is in rad/s, deg/s or rpm; Hz does not say an angle and is "
        "refused.\n"
    )
