"""From a Case to a Scene."""

import os
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rbfem.case.reader import read_case
from rbfem.case.schema import Body, Case
from rbfem.case.wording import located
from rbfem.fem.mass_properties import point_inertia
from rbfem.fem.principal import principal_axes
from rbfem.motion import quaternion
from rbfem.scene.contacts import Contacts, build_contacts, is_plane
from rbfem.scene.loads import Fastening, load_table
from rbfem.scene.parts import build_part
from rbfem.scene.placing import Start, place
from rbfem.scene.scene import Expectation, Part, Reference, Scene
from rbfem.scene.spacing import in_walls, overlapping, spread

FRAMES_BY_DEFAULT = 100


def load(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a case file and the meshes it names, and build its scene.

    path : a case.yaml or the folder it is in    overrides : "KEY=VALUE" strings, as for `rbfem run --set`
    Raises InputError with file and line for whatever is wrong in the case or a mesh.

    >>> import tempfile, pathlib
    >>> text = '''
    ... rbfem: 1
    ... shapes: {ball: {sphere: {radius: 5 mm}}}
    ... materials: {steel: {density: 7850}}
    ... bodies: [{name: shot, shape: ball, material: steel, velocity: [1, 0, 2]}]
    ... gravity: [0, 0, -9.81]
    ... time: {end: 0.1}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder, "case.yaml")
    ...     _ = file.write_text(text)
    ...     scene = load(file)
    >>> scene.names, scene.mass.round(6)
    (('shot',), array([0.00411]))
    """
    return build_scene(read_case(path, overrides))


def build_scene(case: Case) -> Scene:
    """The scene of a checked case."""
    bodies = tuple(body for body in case.bodies if not is_plane(case, body))
    if not bodies:
        raise case.error("bodies", "there are only walls; a scene needs a body")
    pairs = list(dict.fromkeys((body.shape, body.material) for body in bodies))
    parts = tuple(build_part(case, *pair) for pair in pairs)
    part_of = np.repeat([pairs.index((body.shape, body.material)) for body in bodies], _counts(bodies))
    starts = [
        place(body, parts[pairs.index((body.shape, body.material))], case.seed, index)
        for index, body in enumerate(bodies)
    ]
    start = Start(*[np.concatenate([getattr(one, key) for one in starts]) for key in Start.__annotations__])
    contacts = build_contacts(case, bodies)
    radius = np.array([part.bounding_radius for part in parts])[part_of]
    start = replace(start, position=spread(start.position, radius, contacts, _boxes(bodies), case.seed))
    names = tuple(name for body in bodies for name in body.copy_names())
    _refuse_overlaps(case, names, start.position, radius, contacts)
    is_fixed = np.repeat([body.fixed for body in bodies], _counts(bodies))
    pivot = np.repeat([body.pivot or (np.nan,) * 3 for body in bodies], _counts(bodies), axis=0)
    reference = _reference(parts, part_of, start, pivot)
    is_free = ~is_fixed & np.isnan(pivot[:, 0])
    fastening = Fastening(parts, part_of, reference, _members(bodies, names), is_free)
    loads, first_load, load_kinds = load_table(case, fastening)
    return Scene(
        title=case.title,
        name=case.name,
        names=names,
        parts=parts,
        part_of=part_of,
        materials=tuple(case.materials),
        position=start.position,
        quaternion=start.attitude,
        velocity=start.velocity,
        angular_velocity=start.angular_velocity,
        is_fixed=is_fixed,
        pivot=pivot,
        gravity=np.array(case.gravity, dtype=float),
        reference=reference,
        loads=loads,
        first_load=first_load,
        walls=contacts.walls,
        laws=contacts.laws,
        material=contacts.material,
        can_touch=contacts.can_touch,
        load_kinds=load_kinds,
        accuracy=case.accuracy,
        step=None if case.time.step == "auto" else case.time.step,
        method=None if case.time.method == "auto" else case.time.method,
        places={key: located(case.where(key), key) for key in ("time.step", "time.method")},
        expectations=_expectations(case, names),
        end_time=case.time.end,
        output_interval=case.output.every or case.time.end / FRAMES_BY_DEFAULT,
        output_fields=case.output.fields,
    )


def _boxes(bodies: tuple[Body, ...]) -> np.ndarray:
    """(n, 2, 3) where the centre of each body is drawn; NaN where it is given."""
    nowhere = np.full((2, 3), np.nan)
    return np.repeat([body.place.in_box if body.place else nowhere for body in bodies], _counts(bodies), axis=0)


def _refuse_overlaps(
    case: Case, names: tuple[str, ...], position: np.ndarray, radius: np.ndarray, contacts: Contacts
) -> None:
    """Spheres that overlap at the start would fly apart with an energy that nobody put in."""
    pairs, walls = overlapping(position, radius, contacts), in_walls(position, radius, contacts)
    if not len(pairs) and not len(walls):
        return
    if len(pairs):
        first, second = pairs[0]
        depth = radius[first] + radius[second] - np.linalg.norm(position[first] - position[second])
        what = f"'{names[first]}' and '{names[second]}'"
    else:
        first, wall = walls[0]
        plane = contacts.walls.plane[wall]
        depth = radius[first] + plane[3] - position[first] @ plane[:3]
        what = f"'{names[first]}' and '{contacts.walls.names[wall]}'"
    more = len(pairs) + len(walls) - 1
    others = f", and {more} pairs more" if more else ""
    raise case.error(
        f"bodies.{names[first].partition('.')[0]}",
        f"{what} overlap by {depth:.3g} m at the start{others}: move them apart, or take fewer or a larger box",
    )


def _counts(bodies: tuple[Body, ...]) -> list[int]:
    return [body.count for body in bodies]


def _members(bodies: tuple[Body, ...], names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Indices by the name of a body of the case, and by the name of each copy."""
    ends = np.cumsum(_counts(bodies))
    members = {name: np.array([index]) for index, name in enumerate(names)}
    spans = zip(bodies, ends, strict=True)
    return members | {body.name: np.arange(end - body.count, end) for body, end in spans}


def _reference(parts: tuple[Part, ...], part_of: np.ndarray, start: Start, pivot: np.ndarray) -> Reference:
    moments = np.array([part.principal_moments for part in parts])[part_of]
    axes = np.array([part.principal_quaternion for part in parts])[part_of]
    offset = np.zeros((len(part_of), 3))
    for body in np.flatnonzero(~np.isnan(pivot[:, 0])):
        part = parts[part_of[body]]
        offset[body] = quaternion.rotate_back(start.attitude[body], pivot[body] - start.position[body])
        about_pivot = part.inertia + part.mass * point_inertia(offset[body])
        moments[body], columns = principal_axes(about_pivot, tolerance=10.0 * part.inertia_error)
        axes[body] = quaternion.from_matrix(columns)
    return Reference(moments, axes, offset)


def _expectations(case: Case, names: tuple[str, ...]) -> tuple[Expectation, ...]:
    index = {name: body for body, name in enumerate(names)}
    return tuple(
        Expectation(
            quantity=expect.quantity,
            body=index[expect.quantity[len("bodies.") :].rpartition(".")[0]] if "bodies." in expect.quantity else None,
            name=expect.quantity.rpartition(".")[2],
            time=case.time.end if expect.at is None else expect.at,
            value=np.asarray(expect.value, dtype=float),
            tolerance=expect.tolerance,
            source=expect.source,
        )
        for expect in case.expect
    )
