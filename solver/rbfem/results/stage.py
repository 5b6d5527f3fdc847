"""What a picture of a series looks like: colours, light, camera, scale and paths. Needs pyvista and OpenGL."""

from typing import Any

import numpy as np
import pyvista
from numpy.typing import NDArray

from rbfem.results.reading import Series, read_vtu

# Ten colours that can be told apart, by most of the colour-blind too; where they do not suffice, speed is shown.
PALETTE = ("#4477aa", "#ee7733", "#228833", "#ccbb44", "#aa3377", "#66ccee", "#bb5566", "#7a6f9b", "#999933", "#5f6b6d")
SPEEDS = "viridis"
INK = "#303338"
PATH_INK = "#9aa3ad"
FAINT_INK = "#7d848c"
FLOOR = "#f6f7f9"
FLOOR_INK = "#d5dae0"

# An edge sharper than this stays sharp and is drawn as a line [degrees].
SHARP = 35.0

# The camera looks from above and from one side of the longer of the two horizontal extents; lens [degrees] and margin.
TOWARDS_CAMERA = np.array([0.45, -1.0, 0.5])
LENS = 24.0
MARGIN = 1.08

FLAT = {"lighting": False, "render": False}
SHADING = {
    "smooth_shading": True,
    "split_sharp_edges": True,
    "feature_angle": SHARP,
    "ambient": 0.15,
    "specular": 0.2,
    "specular_power": 15,
    "render": False,
}
SPEED_BAR = {
    "title": "speed [m/s]",
    "color": INK,
    "vertical": False,
    "width": 0.32,
    "height": 0.07,
    "position_x": 0.64,
    "position_y": 0.03,
    "title_font_size": 20,
    "label_font_size": 16,
    "fmt": "%.3g",
    "n_labels": 2,
}


class Stage:
    """A plotter whose camera and colours stay the same for all frames of a series, so that pictures can be compared.

    `chosen` are the frames that camera, speeds and paths are taken from: few, however long the series is.
    """

    def __init__(self, series: Series, chosen: list[int], size: tuple[int, int]):
        self._series = series
        self._chosen = chosen
        bodies = [pyvista.wrap(read_vtu(series.bodies[i])) for i in chosen]
        self._paths = np.array([body.points for body in bodies])
        radius = np.asarray(bodies[0].point_data["radius"])
        self._fastest = max(_fastest(body, radius) for body in bodies)
        self._colors = _colors_of_bodies(pyvista.wrap(read_vtu(series.parts[chosen[0]])))
        self.plotter = _empty_plotter(size)
        low = (self._paths - radius[:, None]).min(axis=(0, 1))
        high = (self._paths + radius[:, None]).max(axis=(0, 1))
        _add_floor(self.plotter, low, high)
        _point_camera(self.plotter, self._paths, radius, low, high)

    def show(self, index: int) -> None:
        """Put frame `index` of the series on the stage, in place of the one before (actors of the same name go)."""
        grid = pyvista.wrap(read_vtu(self._series.parts[index]))
        self._add_parts(grid.extract_surface(algorithm="dataset_surface", pass_pointid=False, pass_cellid=False))
        self._add_paths(sum(i <= index for i in self._chosen))
        title = f"{self._series.name}   t = {self._series.times[index]:.4g} s"
        self.plotter.add_text(
            title, name="title", position=(0.03, 0.94), viewport=True, color=INK, font_size=12, render=False
        )
        self.plotter.renderer.ResetCameraClippingRange()  # or bodies far from those of the last frame are cut away

    def _add_parts(self, surface: Any) -> None:
        if self._colors is None and "velocity" in surface.point_data:
            surface["speed"] = np.linalg.norm(surface["velocity"], axis=1)
            look: dict[str, Any] = {
                "scalars": "speed",
                "cmap": SPEEDS,
                "clim": (0.0, self._fastest),
                "scalar_bar_args": SPEED_BAR,
            }
        else:
            surface.cell_data["color"] = _cell_colors(surface, self._colors)
            look = {"scalars": "color", "rgb": True}
        self.plotter.add_mesh(surface, name="parts", **look, **SHADING)
        edges = surface.extract_feature_edges(
            SHARP, boundary_edges=False, non_manifold_edges=False, manifold_edges=False
        )
        if edges.n_points:
            self.plotter.add_mesh(edges, name="edges", color=INK, line_width=1.2, opacity=0.6, **FLAT)

    def _add_paths(self, until: int) -> None:
        """Lines along which the centres of mass came here, from the first chosen frame to the one before `until`."""
        n_bodies = self._paths.shape[1]
        if until < 2:
            return
        along = np.arange(until * n_bodies).reshape(until, n_bodies).T
        lines = np.column_stack([np.full(n_bodies, until), along]).ravel()
        paths = pyvista.PolyData(self._paths[:until].reshape(-1, 3), lines=lines)
        self.plotter.add_mesh(paths, name="paths", color=PATH_INK, line_width=1.5, **FLAT)


def round_length(length: float) -> float:
    """The largest of …, 0.1, 0.2, 0.5, 1, 2, 5, … that is not longer.

    >>> round_length(0.037), round_length(7.1)
    (0.02, 5.0)
    """
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(step for step in (1, 2, 5) if step * power <= length * (1 + 1e-12)) * power)


def _empty_plotter(size: tuple[int, int]) -> Any:
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="three lights")
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    plotter.add_axes(line_width=3, color=INK, viewport=(0.0, 0.0, 0.14, 0.14 * size[0] / size[1]))
    return plotter


def _add_floor(plotter: Any, low: NDArray, high: NDArray) -> None:
    """A square grid of a round width under the motion: it shows where is down, and how large things are."""
    tile = round_length(float((high - low).max()) / 5)
    start, stop = np.floor(low / tile) * tile, np.ceil(high / tile) * tile
    tiles = np.round((stop - start) / tile).astype(int)
    floor = pyvista.Plane(
        center=(*(0.5 * (start + stop))[:2], low[2]),
        i_size=stop[0] - start[0],
        j_size=stop[1] - start[1],
        i_resolution=tiles[0],
        j_resolution=tiles[1],
    )
    plotter.add_mesh(floor, color=FLOOR, show_edges=True, edge_color=FLOOR_INK, **FLAT)
    plotter.add_text(f"floor tiles: {tile:g} m", position=(0.03, 0.9), viewport=True, color=FAINT_INK, font_size=9)


def _point_camera(plotter: Any, paths: NDArray, radius: NDArray, low: NDArray, high: NDArray) -> None:
    """Put the camera as close as it can come with every body in view at every frame, z upwards.

    A sphere of radius r at c (from the point looked at) is in view from the distance d along the unit vector e towards
    the camera if |u·c| + r / cos(lens / 2) ≤ (d - e·c) tan(lens / 2) for the axis u that points up in the picture,
    and likewise to its side.
    """
    middle, extent = 0.5 * (low + high), high - low
    towards = TOWARDS_CAMERA if extent[0] >= extent[1] else TOWARDS_CAMERA[[1, 0, 2]] * [-1, 1, 1]
    towards = towards / np.linalg.norm(towards)
    side = np.cross([0, 0, 1], towards)
    side /= np.linalg.norm(side)
    centers = paths - middle
    width, height = plotter.window_size
    distance = 0.0
    for axis, slope in ((np.cross(towards, side), 1.0), (side, width / height)):
        angle = np.arctan(slope * np.tan(np.radians(LENS / 2)))
        needed = (np.abs(centers @ axis) + radius / np.cos(angle)) / np.tan(angle) + centers @ towards
        distance = max(distance, float(needed.max()))
    plotter.camera.view_angle = LENS
    plotter.camera_position = [middle + MARGIN * distance * towards, middle, (0, 0, 1)]


def _fastest(bodies: Any, radius: NDArray) -> float:
    """No point of a body is faster than |v| + |ω| radius, m/s."""
    spin = np.linalg.norm(bodies["angular_velocity"], axis=1)
    return float((np.linalg.norm(bodies["velocity"], axis=1) + spin * radius).max())


def _colors_of_bodies(grid: Any) -> dict[tuple[int, int], str] | None:
    """A colour for each material of each body, or None if there are more of these than colours."""
    pairs = np.unique(np.column_stack([grid["body"], grid["material"]]), axis=0)
    if len(pairs) > len(PALETTE):
        return None
    return {(int(body), int(material)): PALETTE[i] for i, (body, material) in enumerate(pairs)}


def _cell_colors(surface: Any, colors: dict[tuple[int, int], str] | None) -> NDArray[np.uint8]:
    """(n_cells, 3) colours; all bodies get the first colour if there are too many of them and no speeds to show."""
    pairs, which = np.unique(np.column_stack([surface["body"], surface["material"]]), axis=0, return_inverse=True)
    names = [colors[int(b), int(m)] if colors else PALETTE[0] for b, m in pairs]
    return np.array([pyvista.Color(name).int_rgb for name in names], np.uint8)[which.ravel()]
