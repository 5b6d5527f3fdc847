"""The noun of this room: what is physically there, as frozen arrays. Made once; never changes during a run."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.mesh.tet_mesh import TetMesh
from rbfem.motion import quaternion
from rbfem.motion.model import Loads


@dataclass(frozen=True)
class Part:
    """A shape filled with a material: what all copies of a body share.

    Vectors are in the part's own axes (those of its mesh) and points are relative to its centre of mass.

    name               : the shape's name in the case file
    kind               : "mesh", "sphere", "box", "cylinder" or "ellipsoid"
    mesh               : the tetrahedra, or None for a primitive
    points             : (p, 3) m, nodes of the surface that is drawn
    triangles          : (t, 3) indices into `points`, normals outward
    triangle_material  : (t,) indices into `Scene.materials`
    tet_material       : (n_tets,) indices into `Scene.materials`; empty for a primitive
    tet_density        : (n_tets,) kg/m^3, mean density of each tet; empty for a primitive
    origin             : (3,) m, the shape's own origin (a mesh's zero) seen from the centre of mass
    mass, volume       : kg, m^3
    inertia            : (3, 3) kg m^2 about the centre of mass
    principal_moments  : (3,) kg m^2, ascending
    principal_quaternion : (4,) principal axes -> part axes
    bounding_radius    : m, largest distance of a surface point from the centre of mass
    inertia_error      : estimated relative error of the tensor
    """

    name: str
    kind: str
    mesh: TetMesh | None
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    triangle_material: NDArray[np.int64]
    tet_material: NDArray[np.int64]
    tet_density: NDArray[np.float64]
    origin: NDArray[np.float64]
    mass: float
    volume: float
    inertia: NDArray[np.float64]
    principal_moments: NDArray[np.float64]
    principal_quaternion: NDArray[np.float64]
    bounding_radius: float
    inertia_error: float


@dataclass(frozen=True)
class Reference:
    """The point about which a body moves, its centre of mass or its pivot, and the principal axes there.

    moments    : (n, 3) kg m^2, principal, about the reference point
    quaternion : (n, 4) principal axes -> part axes
    offset     : (n, 3) m, centre of mass to reference point, part axes
    """

    moments: NDArray[np.float64]
    quaternion: NDArray[np.float64]
    offset: NDArray[np.float64]

    @property
    def arm(self) -> NDArray[np.float64]:
        """(n, 3) m, reference point to centre of mass, principal axes."""
        return quaternion.rotate_back(self.quaternion, -self.offset)


@dataclass(frozen=True)
class Walls:
    """Plane walls. plane (w, 4): unit normal n into the free side, and d of n·x = d; material (w,) index."""

    names: tuple[str, ...]
    plane: NDArray[np.float64]
    material: NDArray[np.int32]


@dataclass(frozen=True)
class Expectation:
    """A number known beforehand. body: index, or None for a total of the scene; name: of the quantity alone."""

    quantity: str
    body: int | None
    name: str
    time: float
    value: NDArray[np.float64]
    tolerance: float
    source: str


@dataclass(frozen=True)
class Scene:
    """Bodies, loads and times of a case, in SI.

    names            : n body names; copies are called NAME.00, NAME.01, …
    parts, part_of   : the distinct parts, and (n,) which of them each body is
    materials        : names of the materials
    position         : (n, 3) m, centre of mass at the start
    quaternion       : (n, 4) part axes -> world at the start, scalar first
    velocity         : (n, 3) m/s of the centre of mass
    angular_velocity : (n, 3) rad/s, world frame
    is_fixed         : (n,) never moves
    pivot            : (n, 3) m, the world point a ball joint holds; NaN for a body that is not held
    gravity          : (3,) m/s^2
    reference        : about which point and in which axes each body moves, see `Reference`
    loads            : everything else that pushes, see `rbfem.motion.loads`
    walls            : planes that spheres can touch
    laws             : (m², LAW_WIDTH) contact law of each pair of materials, see `rbfem.contact.model`
    material         : (n,) index of each body's material; -1 if it has several
    can_touch        : (n,) bodies whose material meets any material in the scene
    load_kinds       : n_bodies tuples of the kinds of load in words, for the plan
    accuracy         : the error the user accepts
    step, method     : what the user asked for, or None for "auto"
    places           : where `time.step` and `time.method` stand in the case file, for messages
    expectations     : what is known about the answer
    end_time         : s
    output_interval  : s
    output_fields    : what is written at each point or cell besides the positions
    """

    title: str
    name: str
    names: tuple[str, ...]
    parts: tuple[Part, ...]
    part_of: NDArray[np.int64]
    materials: tuple[str, ...]
    position: NDArray[np.float64]
    quaternion: NDArray[np.float64]
    velocity: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    is_fixed: NDArray[np.bool_]
    pivot: NDArray[np.float64]
    gravity: NDArray[np.float64]
    reference: Reference
    loads: Loads
    first_load: NDArray[np.int64]
    walls: Walls
    laws: NDArray[np.float64]
    material: NDArray[np.int64]
    can_touch: NDArray[np.bool_]
    load_kinds: tuple[tuple[str, ...], ...]
    accuracy: float
    step: float | None
    method: str | None
    places: Mapping[str, str]
    expectations: tuple[Expectation, ...]
    end_time: float
    output_interval: float
    output_fields: tuple[str, ...]

    @property
    def n_bodies(self) -> int:
        return len(self.names)

    def where(self, key: str) -> str:
        """`cases/x/case.yaml:12: time.step` of a key in `places`; the scene's name if it was not read from a file."""
        return self.places.get(key, f"{self.name}: {key}")

    @property
    def is_held(self) -> NDArray[np.bool_]:
        """(n,) bodies that a pivot holds."""
        return ~np.isnan(self.pivot[:, 0])

    @property
    def mass(self) -> NDArray[np.float64]:
        """(n,) kg."""
        return self.of_parts([part.mass for part in self.parts])

    @property
    def bounding_radius(self) -> NDArray[np.float64]:
        """(n,) m."""
        return self.of_parts([part.bounding_radius for part in self.parts])

    def of_parts(self, values) -> NDArray:
        """A value of each part, spread over the bodies."""
        return np.asarray(values)[self.part_of]
