"""What a case must keep between its keys: names that exist, keys that exclude each other.

The rules read the tree as it was written, so that they speak even where the schema has found other mistakes; whatever
is of the wrong kind is the schema's business and passed over here.
"""

from collections.abc import Callable, Iterator
from typing import Any

from rbfem.case.document import Path
from rbfem.case.quantity import Quantity
from rbfem.case.schema import BY_GROUP, copy_width
from rbfem.case.units import TIME
from rbfem.case.wording import did_you_mean, shown

Finding = tuple[Path, str]
Group = dict[str, Any]

EXCLUDES = {
    ("pivot", "fixed"): "a fixed body does not turn about anything",
    ("pivot", "place"): "the pivot is one point, the places are many",
    ("pivot", "velocity"): "it follows from the pivot and the angular velocity",
    ("fixed", "velocity"): "a fixed body does not move",
    ("fixed", "angular_velocity"): "a fixed body does not turn",
    ("fixed", "angular_velocity_body"): "a fixed body does not turn",
    ("place", "position"): "the place gives the position",
    ("angular_velocity", "angular_velocity_body"): "they are one velocity in two frames",
}


def findings(tree: Group) -> Iterator[Finding]:
    """Every broken rule: the path and what to say."""
    names = _BodyNames(tree)
    yield from names.given_twice()
    yield from _reserved_name(tree)
    for index, rule_of_contact in _groups(tree.get("contacts")):
        yield from ((("contacts", index, *path), message) for path, message in _contact(rule_of_contact, tree))
    for index, body in _groups(tree.get("bodies")):
        for rule in BODY_RULES:
            yield from ((("bodies", index, *path), message) for path, message in rule(body, tree))
        yield from ((("bodies", index, *path), message) for path, message in _springs(body, names))
    yield from _expectations(tree, names)


def _groups(value: object) -> list[tuple[int, Group]]:
    return (
        [(index, item) for index, item in enumerate(value) if isinstance(item, dict)] if isinstance(value, list) else []
    )


def _group(value: object) -> Group:
    return value if isinstance(value, dict) else {}


def _is_given(body: Group, key: str) -> bool:
    return body.get(key) is not None and body[key] is not False


def _count(body: Group) -> int:
    count = body.get("count", 1)
    return count if isinstance(count, int) else 1


# --------------------------------------------------------------------------------------------------------- bodies


def _known_shape(body: Group, tree: Group) -> Iterator[Finding]:
    shapes, name = tree.get("shapes"), body.get("shape")
    if isinstance(shapes, dict) and isinstance(name, str) and name not in shapes:
        yield ("shape",), f"no shape {shown(name)}{did_you_mean(name, shapes)}"


def _known_material(body: Group, tree: Group) -> Iterator[Finding]:
    materials, name = tree.get("materials"), body.get("material")
    if isinstance(materials, dict) and isinstance(name, str) and name not in (*materials, BY_GROUP):
        yield ("material",), f"no material {shown(name)}{did_you_mean(name, (*materials, BY_GROUP))}"


def _material_of_a_mesh(body: Group, tree: Group) -> Iterator[Finding]:
    """Groups and fields live in mesh files only."""
    shapes, name = _group(tree.get("shapes")), body.get("shape")
    shape = _group(shapes.get(name)) if isinstance(name, str) else {}
    if not shape or "mesh" in shape:
        return
    material = body.get("material")
    known = _group(tree.get("materials"))
    density = _group(known.get(material)).get("density") if isinstance(material, str) else None
    if material == BY_GROUP:
        yield ("material",), f"shape '{name}' is no mesh and has no groups: name one material"
    elif isinstance(density, dict):
        yield ("material",), f"the density of '{material}' is a field of a mesh file, but shape '{name}' is no mesh"


def _exclusive_keys(body: Group, tree: Group) -> Iterator[Finding]:
    for (first, second), reason in EXCLUDES.items():
        if _is_given(body, first) and _is_given(body, second):
            yield (second,), f"'{second}' does not go with '{first}': {reason}"


def _copies(body: Group, tree: Group) -> Iterator[Finding]:
    if _count(body) > 1 and _is_given(body, "pivot"):
        yield ("pivot",), "'pivot' does not go with 'count' above 1: write the bodies one by one"
    elif _count(body) > 1 and not _is_given(body, "place"):
        yield ("count",), f"{_count(body)} copies need `place`, or all would start in one spot"


def _plane(body: Group, tree: Group) -> Iterator[Finding]:
    """A plane stands in the world by itself and has no mass."""
    if not _is_plane(body, tree):
        return
    if not _is_given(body, "fixed"):
        yield ("shape",), "a plane is a wall: write `fixed: true`"
    for key in ("position", "quaternion", "place", "count", "pivot", "loads"):
        if _is_given(body, key):
            yield (key,), f"'{key}' does not go with a plane: its point and normal say where it is"


def _is_plane(body: Group, tree: Group) -> bool:
    shapes, name = _group(tree.get("shapes")), body.get("shape")
    return isinstance(name, str) and "plane" in _group(shapes.get(name))


def _one_attitude(body: Group, tree: Group) -> Iterator[Finding]:
    if _group(body.get("place")).get("orientation") == "random" and _is_given(body, "quaternion"):
        yield ("quaternion",), "'quaternion' does not go with a random orientation of 'place'"


def _field_on_a_pivot(body: Group, tree: Group) -> Iterator[Finding]:
    for index, load in _groups(body.get("loads")):
        if "gravity_gradient" in load and _is_given(body, "pivot"):
            reason = "its torque is that about the centre of mass of a free body"
            yield ("loads", index, "gravity_gradient"), f"'gravity_gradient' does not go with 'pivot': {reason}"


BODY_RULES: tuple[Callable[[Group, Group], Iterator[Finding]], ...] = (
    _known_shape,
    _known_material,
    _material_of_a_mesh,
    _exclusive_keys,
    _copies,
    _plane,
    _one_attitude,
    _field_on_a_pivot,
)


def _contact(rule: Group, tree: Group) -> Iterator[Finding]:
    materials = _group(tree.get("materials"))
    between = rule.get("between")
    for place, name in enumerate(between if isinstance(between, list) else []):
        if isinstance(name, str) and name not in materials:
            yield ("between", place), f"no material {shown(name)}{did_you_mean(name, materials)}"
    is_linear = rule.get("law") == "linear"
    if is_linear and rule.get("normal_stiffness") is None:
        yield ("law",), "the linear law needs 'normal_stiffness'"
    for key in ("normal_stiffness", "tangential_stiffness"):
        if not is_linear and rule.get(key) is not None:
            yield (key,), f"'{key}' goes with `law: linear`; hertz takes it from young and poisson of the materials"


def _reserved_name(tree: Group) -> Iterator[Finding]:
    if BY_GROUP in _group(tree.get("materials")):
        yield ("materials", BY_GROUP), f"'{BY_GROUP}' has a meaning of its own: choose another name"


# ---------------------------------------------------------------------------------------------------- names of bodies


class _BodyNames:
    """The names that bodies and their copies will have."""

    def __init__(self, tree: Group) -> None:
        named = [(index, body) for index, body in _groups(tree.get("bodies")) if isinstance(body.get("name"), str)]
        self.counts = {body["name"]: _count(body) for _, body in reversed(named) if not _is_plane(body, tree)}
        self._named = named

    def given_twice(self) -> Iterator[Finding]:
        seen: dict[str, int] = {}
        for index, body in self._named:
            first = seen.setdefault(body["name"], index)
            if first != index:
                yield ("bodies", index, "name"), f"a body {shown(body['name'])} exists already: names are unique"

    def refusal(self, name: str) -> str | None:
        """Why there is no single body of this name, or None."""
        owner, dot, number = name.partition(".")
        count = self.counts.get(owner)
        if count is None or (count == 1 and dot):
            return f"no body {shown(name)}{did_you_mean(name, self.counts)}"
        if count == 1:
            return None
        width = copy_width(count)
        if number.isdecimal() and len(number) == width and int(number) < count:
            return None
        return f"'{owner}' is {count} bodies: name one of {owner}.{0:0{width}} … {owner}.{count - 1:0{width}}"


def _springs(body: Group, names: _BodyNames) -> Iterator[Finding]:
    for index, load in _groups(body.get("loads")):
        other = _group(_group(load.get("spring")).get("to")).get("body")
        if not isinstance(other, str):
            continue
        path = ("loads", index, "spring", "to", "body")
        if refusal := names.refusal(other):
            yield path, refusal
        elif other.partition(".")[0] == body.get("name"):
            yield path, f"a spring from {shown(other)} to itself: name another body"


# ---------------------------------------------------------------------------------------------------- expectations


def _expectations(tree: Group, names: _BodyNames) -> Iterator[Finding]:
    end = _seconds(_group(tree.get("time")).get("end"))
    for index, expect in _groups(tree.get("expect")):
        quantity, at = expect.get("quantity"), _seconds(expect.get("at"))
        if isinstance(quantity, str) and quantity.startswith("bodies.") and quantity.count(".") > 1:
            refusal = names.refusal(quantity.removeprefix("bodies.").rpartition(".")[0])
            if refusal:
                yield ("expect", index, "quantity"), refusal
        if at is not None and end and at > end:
            yield ("expect", index, "at"), f"expected a time up to the end at {end:g} s, read {shown(expect['at'])}"


def _seconds(value: object) -> float | None:
    try:
        return float(Quantity(TIME, at_least=0.0).read(value))
    except ValueError:
        return None
