"""The parts of a scene as one unstructured grid whose points follow the bodies from frame to frame."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rbfem.motion.quaternion import rotate
from rbfem.results.vtk_file import grid_of_cells, name_list, named_array, set_points, write_grid
from rbfem.scene.scene import Part, Scene
from rbfem.simulation.frame import Frame

# Cell types of the VTK file format, by name there: VTK_TRIANGLE, VTK_TETRA, VTK_QUADRATIC_TETRA.
TRIANGLE = 5
TET_TYPES = {4: 10, 10: 24}

# A point may be off by this share of the smallest body before single precision is given up: far below a pixel.
RESOLUTION = 1e-4


@dataclass(frozen=True)
class Shape:
    """What is drawn of a part: points from its centre of mass, cells of one type, and what each cell is made of."""

    points: NDArray[np.float64]
    cells: NDArray[np.int64]
    cell_type: int
    material: NDArray[np.int64]
    density: NDArray[np.float64]


@dataclass
class Copies:
    """All bodies of one part, and where their points lie in the grid.

    bodies : (k,) indices of bodies
    points : (p, 4) coordinates of the part's points from its centre of mass, and a one
    rows   : their k p points in the arrays of the grid, copy after copy
    """

    bodies: NDArray[np.int64]
    points: NDArray
    rows: slice


def shape_of(part: Part, has_volume: bool) -> Shape:
    """The tets of a part where its volume is asked for and it has a mesh, else its surface."""
    if has_volume and part.mesh is not None:
        tets = part.mesh.tets
        points = part.mesh.nodes + part.origin
        return Shape(points, tets, TET_TYPES[tets.shape[1]], part.tet_material, part.tet_density)
    density = np.full(len(part.triangles), part.mass / part.volume)
    return Shape(part.points, part.triangles, TRIANGLE, part.triangle_material, density)


def point_type(position: NDArray, radii: NDArray) -> DTypeLike:
    """The smallest float type that resolves RESOLUTION of the smallest body at the coordinate farthest out.

    position : (n, 3) m, centres of mass      radii : (n,) m, bounding radii of the bodies
    x + R p is a sum of four products, so up to four roundings, each half a spacing of the type, are counted.

    >>> point_type(np.array([[0.0, 0.0, 1.0]]), np.array([0.1])).__name__
    'float32'
    >>> point_type(np.array([[0.0, 0.0, 1e3]]), np.array([0.1])).__name__
    'float64'
    """
    farthest = np.abs(position).max() + radii.max()
    return np.float32 if 2 * np.spacing(np.float32(farthest)) <= RESOLUTION * radii.min() else np.float64


class SceneGrid:
    """The grid of a scene: its cells are made once, its points and velocities are renewed by `move_to`.

    Copies of a part lie next to each other, so that each part is moved by one product of arrays. Cell arrays `body` and
    `material` (indices); `density` and tets instead of surfaces if the scene asks for `density`; point array `velocity`
    if it asks for that; field arrays `TimeValue`, `body_names` and `material_names`.
    """

    def __init__(self, scene: Scene):
        has_density = "density" in scene.output_fields
        shapes = [shape_of(part, has_density) for part in scene.parts]
        self._has_velocity = "velocity" in scene.output_fields
        self._radii = scene.bounding_radius
        self._copies = _place_copies(shapes, scene.part_of)
        self._grid = _make_cells(shapes, self._copies, has_density)
        self._time = np.zeros(1)
        self._add_field_data(scene)
        self._use_type(np.float32)

    def move_to(self, frame: Frame) -> None:
        """Move every point to where its body is: x + R(q) p, with the velocity v + ω × R(q) p.

        The points of a series turn to double precision when single does not resolve them, and stay so.
        """
        if self._points.dtype == np.float32 and point_type(frame.position, self._radii) is np.float64:
            self._use_type(np.float64)
        axes = rotate(frame.quaternion[:, None, :], np.eye(3))
        _map_points(self._points, self._copies, axes, frame.position)
        if self._has_velocity:
            rates = np.cross(frame.angular_velocity[:, None, :], axes)
            _map_points(self._velocity, self._copies, rates, frame.velocity)
        self._time[0] = frame.time
        self._mark_as_new()

    def write(self, path: Path) -> None:
        """Write the grid as it is now. Raises RunError."""
        write_grid(self._grid, path)

    def _use_type(self, dtype: DTypeLike) -> None:
        n_points = self._copies[-1].rows.stop
        self._points = np.zeros((n_points, 3), dtype)
        set_points(self._grid, self._points)
        for copies in self._copies:
            copies.points = copies.points.astype(dtype)
        if self._has_velocity:
            self._velocity = np.zeros((n_points, 3), dtype)
            self._grid.GetPointData().AddArray(named_array("velocity", self._velocity))

    def _add_field_data(self, scene: Scene) -> None:
        field_data = self._grid.GetFieldData()
        field_data.AddArray(named_array("TimeValue", self._time))
        field_data.AddArray(name_list("body_names", scene.names))
        field_data.AddArray(name_list("material_names", scene.materials))

    def _mark_as_new(self) -> None:
        self._grid.GetPoints().GetData().Modified()
        if self._has_velocity:
            self._grid.GetPointData().GetArray("velocity").Modified()
        self._grid.GetFieldData().GetArray("TimeValue").Modified()


def _place_copies(shapes: list[Shape], part_of: NDArray[np.int64]) -> list[Copies]:
    placed, start = [], 0
    for i, shape in enumerate(shapes):
        bodies = np.flatnonzero(part_of == i)
        stop = start + len(bodies) * len(shape.points)
        points = np.column_stack([shape.points, np.ones(len(shape.points))])
        placed.append(Copies(bodies, points, slice(start, stop)))
        start = stop
    return placed


def _make_cells(shapes: list[Shape], copies: list[Copies], has_density: bool) -> Any:
    pairs = list(zip(shapes, copies, strict=True))
    counts = [len(shape.cells) * len(copy.bodies) for shape, copy in pairs]
    grid = grid_of_cells(
        np.concatenate([_connectivity(shape, copy) for shape, copy in pairs]),
        np.repeat([shape.cells.shape[1] for shape in shapes], counts),
        np.repeat([shape.cell_type for shape in shapes], counts),
    )
    cell_data = grid.GetCellData()
    body = np.concatenate([np.repeat(copy.bodies, len(shape.cells)) for shape, copy in pairs])
    material = np.concatenate([np.tile(shape.material, len(copy.bodies)) for shape, copy in pairs])
    cell_data.AddArray(named_array("body", body.astype(np.int32)))
    cell_data.AddArray(named_array("material", material.astype(np.int32)))
    if has_density:
        density = np.concatenate([np.tile(shape.density, len(copy.bodies)) for shape, copy in pairs])
        cell_data.AddArray(named_array("density", density.astype(np.float32)))
    return grid


def _connectivity(shape: Shape, copies: Copies) -> NDArray[np.int64]:
    first = copies.rows.start + len(shape.points) * np.arange(len(copies.bodies))
    return (first[:, None, None] + shape.cells).ravel()


def _map_points(target: NDArray, copies: list[Copies], axes: NDArray, shift: NDArray) -> None:
    """target = p_x axes_0 + p_y axes_1 + p_z axes_2 + shift for every point p of every body, written in place.

    axes (n, 3, 3) : in rows, what the axes of each body are mapped to    shift : (n, 3)
    As p and a one are kept side by side in rows, this is one product with the rows of axes and shift.
    """
    maps = np.concatenate([axes, shift[:, None, :]], axis=1).astype(target.dtype)
    for each in copies:
        shape = (len(each.bodies), len(each.points), 3)
        np.matmul(each.points, maps[each.bodies], out=target[each.rows].reshape(shape))
