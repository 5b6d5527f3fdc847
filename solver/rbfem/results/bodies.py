"""One vertex a body: the small series for glyphs, plots and selections."""

from pathlib import Path

import numpy as np

from rbfem.results.vtk_file import grid_of_cells, named_array, set_points, write_grid
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Frame

# Cell type of the VTK file format: VTK_VERTEX.
VERTEX = 1


class BodiesGrid:
    """Centres of mass with what is known of each body, as point arrays in double precision.

    They change: `quaternion` (w, x, y, z; part axes to world), `velocity`, `angular_velocity` (rad/s, world),
    `kinetic_energy` (J). They stay: `body` (index), `mass` (kg), `radius` (m, bounding). Field array: `TimeValue`.
    """

    def __init__(self, scene: Scene):
        n_bodies = scene.n_bodies
        ones = np.ones(n_bodies, int)
        self._grid = grid_of_cells(np.arange(n_bodies), ones, VERTEX * ones)
        self._position = np.zeros((n_bodies, 3))
        self._time = np.zeros(1)
        self._changing = {
            "quaternion": np.zeros((n_bodies, 4)),
            "velocity": np.zeros((n_bodies, 3)),
            "angular_velocity": np.zeros((n_bodies, 3)),
            "kinetic_energy": np.zeros(n_bodies),
        }
        self._add_arrays(scene)

    def move_to(self, frame: Frame) -> None:
        """Take over the state of every body."""
        self._position[:] = frame.position
        self._time[0] = frame.time
        self._grid.GetPoints().GetData().Modified()
        self._grid.GetFieldData().GetArray("TimeValue").Modified()
        for name, values in self._changing.items():
            values[:] = getattr(frame, name)
            self._grid.GetPointData().GetArray(name).Modified()

    def write(self, path: Path) -> None:
        """Write the bodies as they are now. Raises RunError."""
        write_grid(self._grid, path)

    def _add_arrays(self, scene: Scene) -> None:
        set_points(self._grid, self._position)
        self._grid.GetFieldData().AddArray(named_array("TimeValue", self._time))
        data = self._grid.GetPointData()
        for name, values in self._changing.items():
            data.AddArray(named_array(name, values, tuple("wxyz") if name == "quaternion" else ()))
        data.AddArray(named_array("body", np.arange(scene.n_bodies, dtype=np.int32)))
        data.AddArray(named_array("mass", scene.mass))
        data.AddArray(named_array("radius", scene.bounding_radius))
