"""Spheres that touch: their arrays in the order of their cells, made anew as they move, and steps taken with them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import loop
from rbfem.contact.model import BY_DAMPING, BY_FRICTION, MEMORY_WIDTH, Pairs, Spheres, WallPairs
from rbfem.contact.neighbours import (
    carry_memory,
    carry_wall_memory,
    count_in_cells,
    list_pairs,
    list_walls,
    sort_into_cells,
)
from rbfem.contact.stored_energy import find_stored_energy
from rbfem.errors import RunError
from rbfem.motion import quaternion
from rbfem.motion.state import State
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import ContactBalance
from rbfem.simulation.sphere_motion import (
    BEFORE,
    DONE,
    JOURNAL_WIDTH,
    MOMENT,
    REACH,
    STRIDE,
    find_forces,
    kick,
    step_spheres,
)

Array = NDArray[np.float64]

SKIN, WIDE_SKIN, FEW = 0.1, 1.0, 100  # of the smallest radius; the wide one up to so few spheres: lists cost more
PAIRS_A_SPHERE = 6  # room in the first list; a list that is too short is made again, longer
WIDER = 1.2
CELLS_A_SPHERE = 4  # no more cells than this: an empty cell costs as much as a sphere


class Touching:
    """The spheres of a run with their contacts.

    members : bodies of the scene that can touch     order : which of them stands where in the arrays
    skin    : m, how much farther than they reach spheres are listed
    """

    def __init__(self, scene: Scene, state: State, backend: str):
        members = np.flatnonzero(scene.can_touch)
        n, free = len(members), ~scene.is_fixed[members]
        radius, mass, self.moment = scene.bounding_radius[members], scene.mass[members], scene.reference.moments[:, 0]
        spin = scene.angular_velocity[members]
        self.spheres = Spheres(
            place=np.column_stack([state.position[members], radius]),
            rate=np.hstack([state.velocity[members], spin]),
            inertia=np.column_stack([free / mass, free / self.moment[members], mass]),
            material=scene.material[members].astype(np.int32),
        )
        self.members, self.attitude = members, state.quaternion[members]
        self.laws, self.gravity, self.backend = scene.laws, scene.gravity, backend
        self.skin = (WIDE_SKIN if n <= FEW else SKIN) * float(radius.min())
        self.order = np.arange(n)
        self.wrench, self.moved = np.zeros((n, 6)), np.zeros((n, 3))
        self.on_wall, self.impulse = np.zeros((2, len(scene.walls.plane), 6))
        self.journal = np.zeros(JOURNAL_WIDTH)
        none = np.zeros(0, np.int32)
        self.pairs = Pairs(np.zeros(n + 1, np.int32), none, *_memory(0))
        self.walls = WallPairs(none, none, *_memory(0), scene.walls.plane, scene.walls.material)
        self.room = PAIRS_A_SPHERE * n
        self.rebuilds = 0
        self._make_lists()
        loop(find_forces, backend)(0.0, *self._scene, self.wrench, self.on_wall, self.journal)

    @property
    def _n_materials(self) -> int:
        return round(len(self.laws) ** 0.5)

    @property
    def _scene(self):
        return self.spheres, self.pairs, self.walls, self.laws, self._n_materials

    def advance(self, begin: float, dt: float, n_steps: int) -> None:
        """Take n_steps of dt from time `begin`. Raises RunError for a sphere so fast that contacts could be missed."""
        step, done, allowed = loop(step_spheres, self.backend), 0, 0.5 * self.skin
        while done < n_steps:
            step(
                n_steps - done, dt, done == 0, allowed, *self._scene, self.attitude, self.moved, self.gravity,
                self.wrench, self.on_wall, self.impulse, self.journal,
            )  # fmt: skip
            done += int(self.journal[DONE])
            if self.journal[STRIDE] > allowed:
                raise RunError(
                    f"at t = {begin + done * dt:.6g} s a sphere moves by {self.journal[STRIDE]:.3g} m in a step, more "
                    f"than {allowed:.3g} m, half the skin of its list of neighbours: contacts could be missed; use a "
                    "shorter step"
                )
            if self.journal[REACH] > allowed:
                self._make_lists()
        self._catch_up(dt)

    @property
    def balance(self) -> ContactBalance:
        """What contacts hold and have taken, and what walls have brought in, until now."""
        stored = np.zeros(1)
        loop(find_stored_energy, self.backend)(*self._scene, stored)
        # What a dashpot takes at an instant belongs to the step around it, of which the half is over.
        lost, before = self.journal[BY_DAMPING], self.journal[BEFORE + BY_DAMPING]
        walls, moment = -self.impulse.sum(axis=0), self.journal[MOMENT : MOMENT + 3]
        return ContactBalance(
            elastic=float(stored[0]),
            damping=float(0.5 * (lost + before)),
            friction=float(self.journal[BY_FRICTION]),
            impulse=walls[:3],
            angular_impulse=walls[3:] + np.cross(moment, self.gravity),
        )

    def _catch_up(self, dt: float) -> None:
        """Bring the rates from half a step behind to the places; the wrenches stay for the next step."""
        self.impulse += 0.5 * dt * self.on_wall
        wrench = self.wrench.copy()
        loop(kick, self.backend)(0.5 * dt, self.spheres, self.gravity, wrench, self.journal)

    def placed_in(self, state: State) -> State:
        """A state with the spheres where they are now."""
        rows = self.members[self.order]
        place, attitude, velocity, spin = (
            array.copy() for array in (state.position, state.quaternion, state.velocity, state.angular_momentum)
        )
        place[rows], attitude[rows] = self.spheres.place[:, :3], quaternion.normalize(self.attitude)
        velocity[rows] = self.spheres.rate[:, :3]
        spin[rows] = self.moment[rows, None] * quaternion.rotate_back(attitude[rows], self.spheres.rate[:, 3:])
        return replace(state, position=place, quaternion=attitude, velocity=velocity, angular_momentum=spin)

    def _make_lists(self) -> None:
        """Sort the spheres into cells, list who may touch, and hand on the memory of who does."""
        now_at, start, n_cells = self._sort()
        pairs = self._listed_pairs(start, n_cells)
        walls, first = self._listed_walls()
        loop(carry_memory, self.backend)(self.pairs, now_at, pairs)
        loop(carry_wall_memory, self.backend)(self.walls, now_at, first, walls)
        self.pairs, self.walls = pairs, walls
        self.moved[:] = 0.0
        self.rebuilds += 1

    def _sort(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        place, n = self.spheres.place, len(self.order)
        low, high = place[:, :3].min(axis=0), place[:, :3].max(axis=0)
        extent = np.maximum(high - low, self.skin)
        width = max(2.0 * place[:, 3].max() + self.skin, (extent.prod() / (CELLS_A_SPHERE * n)) ** (1 / 3))
        while np.maximum(1.0, extent / width).prod() > CELLS_A_SPHERE * n + 1.0:  # flat and long domains
            width *= WIDER
        n_cells = np.maximum(1, np.floor(extent / width)).astype(np.int64)
        cell, order, start = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n_cells.prod() + 1, np.int64)
        loop(count_in_cells, self.backend)(place, low, n_cells / extent, n_cells, cell, start)
        loop(sort_into_cells, self.backend)(cell, start, order)
        self.spheres = Spheres(*[array[order] for array in self.spheres])  # type: ignore[arg-type]
        self.attitude, self.order = self.attitude[order], self.order[order]
        self.wrench = self.wrench[order]
        now_at = np.empty(n, np.int64)
        now_at[order] = np.arange(n)
        return now_at, start, n_cells

    def _listed_pairs(self, start: NDArray[np.int64], n_cells: NDArray[np.int64]) -> Pairs:
        first = np.zeros(len(self.order) + 1, np.int32)
        while True:
            other = np.empty(self.room, np.int32)
            count = loop(list_pairs, self.backend)(self.spheres.place, self.skin, n_cells, start, first, other)
            if count <= self.room:
                return Pairs(first, other[:count], *_memory(count))
            self.room = int(1.2 * count)

    def _listed_walls(self) -> tuple[WallPairs, NDArray[np.int64]]:
        plane, material = self.walls.plane, self.walls.material
        room = 0
        while True:
            sphere, wall = np.empty((2, room), np.int32)
            count = loop(list_walls, self.backend)(self.spheres.place, plane, self.skin, sphere, wall)
            if count <= room:
                break
            room = count
        sphere, wall = sphere[:count], wall[:count]
        first = np.searchsorted(sphere, np.arange(len(self.order) + 1)).astype(np.int64)
        return WallPairs(sphere, wall, *_memory(count), plane, material), first


def _memory(count: int) -> tuple[NDArray[np.int8], Array]:
    """Of so many contacts that have none yet."""
    return np.zeros(count, np.int8), np.zeros((count, MEMORY_WIDTH))
