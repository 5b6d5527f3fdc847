"""Pictures of a written series: a look without ParaView."""

import subprocess
import sys
from pathlib import Path
from typing import Any

from rbfem.errors import InputError, MissingLibraryError
from rbfem.results.reading import Series, find_series
from rbfem.results.whole_file import reason, whole_file

STILLS = (".png",)
FILMS = (".gif", ".mp4")

# A film shows at most so many frames, and each for so long that even a short series lasts about four seconds.
MOST_FILM_FRAMES = 120
FILM_SECONDS = 4.0
SLOWEST, FASTEST = 5.0, 25.0

STILL_SIZE = (1280, 960)
FILM_SIZE = (800, 608)  # both divisible by 16, as video codecs want it

# Drawing without OpenGL ends the process by a signal; this trial is made in a process of its own.
TRIAL = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.Render()
"""
INSTALL = (
    "apt-get install -y --no-install-recommends "
    "libglu1-mesa libgl1 libegl1 libxrender1 libxcursor1 libxft2 libxinerama1 libgomp1"
)


def draw(directory: Path, picture: Path | None = None, time: float | None = None) -> list[Path]:
    """Draw the series that `rbfem run` wrote to `directory`; returns the files written.

    picture : a .png (one frame) or a .gif or .mp4 (a film); None for DIRECTORY/NAME.png and DIRECTORY/NAME.gif
    time    : s, of the frame that a .png shows (the nearest there is); None for the last, where each path is complete

    Raises InputError for a folder without results or another kind of picture, MissingLibraryError where this computer
    cannot draw, RunError if a picture cannot be written.
    """
    series = find_series(directory)
    pictures = [picture] if picture else [directory / f"{series.name}{suffix}" for suffix in (".png", ".gif")]
    for path in pictures:
        _require_picture(path)
    require_drawing()
    import pyvista

    with pyvista.vtk_verbosity("off"):
        for path in pictures:
            _draw_picture(series, path, time)
    return pictures


def require_drawing() -> None:
    """Raise MissingLibraryError unless a window off screen can be drawn in by this computer."""
    trial = subprocess.run([sys.executable, "-c", TRIAL], capture_output=True, check=False)
    if trial.returncode != 0:
        raise MissingLibraryError(
            f"this computer cannot draw: OpenGL without a screen (libEGL) is missing or broken; install it: {INSTALL}"
        )


def film_frames(n_frames: int) -> list[int]:
    """At most MOST_FILM_FRAMES indices from the first frame to the last, evenly spread.

    >>> film_frames(3)
    [0, 1, 2]
    >>> chosen = film_frames(1000)
    >>> len(chosen), chosen[0], chosen[-1]
    (120, 0, 999)
    """
    n = min(n_frames, MOST_FILM_FRAMES)
    return [round(i * (n_frames - 1) / max(n - 1, 1)) for i in range(n)]


def _require_picture(path: Path) -> None:
    if path.suffix.lower() not in STILLS + FILMS:
        raise InputError(f"{path}: cannot draw a picture of this kind; give a name that ends in .png, .gif or .mp4")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{path.parent}: this folder cannot be made: {reason(error)}; choose another with -o"
        ) from error


def _draw_picture(series: Series, path: Path, time: float | None) -> None:
    if path.suffix.lower() in STILLS:
        _draw_still(series, path, series.nearest(time) if time is not None else len(series.times) - 1)
    else:
        _draw_film(series, path)


def _draw_still(series: Series, path: Path, index: int) -> None:
    from rbfem.results.stage import Stage

    stage = Stage(series, film_frames(len(series.times)), STILL_SIZE)
    stage.show(index)
    with whole_file(path) as temporary:
        stage.plotter.screenshot(str(temporary))
    stage.plotter.close()


def _draw_film(series: Series, path: Path) -> None:
    from rbfem.results.stage import Stage

    frames = film_frames(len(series.times))
    stage = Stage(series, frames, FILM_SIZE)
    with whole_file(path) as temporary:
        _open_film(stage.plotter, temporary, frames_per_second(len(frames)))
        for index in frames:
            stage.show(index)
            stage.plotter.write_frame()
        stage.plotter.close()


def frames_per_second(n_frames: int) -> float:
    """How quickly a film of so many frames goes.

    >>> frames_per_second(120), frames_per_second(60), frames_per_second(3)
    (25.0, 15.0, 5.0)
    """
    return min(max(n_frames / FILM_SECONDS, SLOWEST), FASTEST)


def _open_film(plotter: Any, path: Path, rate: float) -> None:
    if path.suffix.lower() == ".gif":
        plotter.open_gif(str(path), fps=round(rate), loop=0)
        return
    try:
        plotter.open_movie(str(path), framerate=round(rate), quality=8)
    except (ImportError, ValueError) as error:
        raise MissingLibraryError(
            "a film as .mp4 needs ffmpeg; install it: pip install imageio-ffmpeg, or ask for a .gif"
        ) from error
