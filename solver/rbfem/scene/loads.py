"""From the loads of the case to the rows of the load table."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.case.schema import Case
from rbfem.errors import InputError
from rbfem.fem.surface_loads import pressure_wrench, traction_wrench
from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.model import Loads
from rbfem.scene.scene import Part, Reference

Array = NDArray[np.float64]
VALUES = 9


@dataclass(frozen=True)
class Fastening:
    """What a load needs to know of the bodies: their parts, reference points, indices by name, and who is free."""

    parts: tuple[Part, ...]
    part_of: NDArray[np.int64]
    reference: Reference
    members: dict[str, NDArray[np.int64]]
    is_free: NDArray[np.bool_]

    def lever(self, body: int, at) -> Array:
        """A point of a body in its shape's coordinates (None: centre of mass) as a lever in principal axes."""
        part = self.parts[self.part_of[body]]
        from_center = np.zeros(3) if at is None else np.asarray(at) + part.origin
        return self.to_principal(body, from_center - self.reference.offset[body])

    def to_principal(self, body: int, vector) -> Array:
        """Part axes to principal axes."""
        return quaternion.rotate_back(self.reference.quaternion[body], vector)


@dataclass(frozen=True)
class Row:
    """One load on some bodies, alike for all of them."""

    bodies: NDArray[np.int64]
    kind: int
    values: Array
    ramp: tuple[tuple[float, float], ...] | None = None
    other: int = -1
    is_external: bool = True


def load_table(case: Case, fastening: Fastening) -> tuple[Loads, NDArray[np.int64], tuple[tuple[str, ...], ...]]:
    """The table sorted by body, first_load (n + 1,), and the kinds of load on each body in words."""
    rows: list[Row] = []
    words: list[list[str]] = [[] for _ in fastening.part_of]
    for body in case.bodies:
        for index, load in enumerate(body.loads):
            members = fastening.members[body.name]
            try:
                made = _rows(load, members, fastening)
            except InputError as error:
                raise case.error(f"bodies.{body.name}.loads.{index}", str(error)) from None
            rows += made
            for row in made:
                for member in row.bodies:
                    words[member].append(load.kind)
    return *_table(rows, len(fastening.part_of)), tuple(tuple(dict.fromkeys(kind)) for kind in words)


def _rows(load, members: NDArray[np.int64], fastening: Fastening) -> list[Row]:
    body = int(members[0])
    if load.kind == "spring":
        return _spring_rows(load.spring, members, fastening)
    if load.kind == "drag":
        return [Row(members, kinds.DRAG, _values(load.drag.linear, load.drag.angular))]
    if load.kind == "gravity_gradient":
        field = load.gravity_gradient
        return [Row(members, kinds.GRADIENT, _values(field.rate, field.normal, field.start))]
    if load.kind == "torque" and load.frame == "world":
        return [Row(members, kinds.COUPLE, _values(load.torque), load.ramp)]
    if load.kind == "force" and load.frame == "world":
        return [Row(members, kinds.FORCE, _values(load.force, fastening.lever(body, load.at)), load.ramp)]
    force, torque = _following(load, body, fastening)
    return [Row(members, kinds.WRENCH, _values(force, torque), load.ramp)]


def _following(load, body: int, fastening: Fastening) -> tuple[Array, Array]:
    """Force and torque about the reference point, principal axes, of a load that turns with the body."""
    part = fastening.parts[fastening.part_of[body]]
    if load.kind == "torque":
        return np.zeros(3), fastening.to_principal(body, load.torque)
    if load.kind == "force":
        force = fastening.to_principal(body, load.force)
        return force, np.cross(fastening.lever(body, load.at), force)
    if part.mesh is None:
        raise InputError(f"a {part.kind} has no surface groups; a {load.kind} needs a mesh with one named '{load.on}'")
    about = fastening.reference.offset[body] - part.origin
    if load.kind == "pressure":
        six = pressure_wrench(part.mesh, load.on, load.pressure, about)
    else:
        six = traction_wrench(part.mesh, load.on, load.traction, about)
    return fastening.to_principal(body, six[:3]), fastening.to_principal(body, six[3:])


def _spring_rows(spring, members: NDArray[np.int64], fastening: Fastening) -> list[Row]:
    near = fastening.lever(int(members[0]), spring.at)
    law = (spring.stiffness, spring.damping, spring.rest_length)
    if isinstance(spring.to, tuple):
        return [Row(members, kinds.SPRING, _values(near, spring.to, law))]
    other = int(fastening.members[spring.to.body][0])
    far = fastening.lever(other, spring.to.at)
    free = fastening.is_free
    rows = []
    for body in members:
        is_external = not (free[body] and free[other])
        rows.append(Row(np.array([body]), kinds.SPRING, _values(near, far, law), None, other, is_external))
        rows.append(Row(np.array([other]), kinds.SPRING, _values(far, near, law), None, int(body), is_external))
    return rows


def _values(*groups) -> Array:
    values = np.zeros(VALUES)
    flat = np.concatenate([np.atleast_1d(np.asarray(group, dtype=float)) for group in groups])
    values[: len(flat)] = flat
    return values


def _table(rows: list[Row], n_bodies: int) -> tuple[Loads, NDArray[np.int64]]:
    counts = [len(row.bodies) for row in rows]
    body = np.concatenate([row.bodies for row in rows]) if rows else np.zeros(0, dtype=np.int64)
    order = np.argsort(body, kind="stable")
    ramps = list(dict.fromkeys(row.ramp for row in rows if row.ramp is not None))
    points = np.array([point for ramp in ramps for point in ramp]).reshape(-1, 2)
    ramp_of = [ramps.index(row.ramp) if row.ramp is not None else -1 for row in rows]
    values = np.array([row.values for row in rows]).reshape(-1, VALUES)

    def column(values, dtype) -> NDArray:
        return np.repeat(np.array(values, dtype=dtype), counts, axis=0)[order]

    table = Loads(
        kind=column([row.kind for row in rows], np.int64),
        other=column([row.other for row in rows], np.int64),
        is_external=column([row.is_external for row in rows], np.int64),
        values=column(values, np.float64),
        ramp=column(ramp_of, np.int64),
        ramp_first=np.cumsum([0, *map(len, ramps)], dtype=np.int64),
        ramp_time=np.ascontiguousarray(points[:, 0]),
        ramp_factor=np.ascontiguousarray(points[:, 1]),
    )
    return table, np.searchsorted(body[order], np.arange(n_bodies + 1)).astype(np.int64)
