"""Pictures of a series, and what a person is told who asks for one that cannot be had."""

import ctypes.util

import numpy as np
import pytest
from click.testing import CliRunner
from toy_scene import make_frame, make_scene

from rbfem.cli.view import command
from rbfem.errors import InputError, MissingLibraryError, RunError
from rbfem.results.reading import find_series
from rbfem.results.series import SeriesWriter
from rbfem.results.stage import round_length
from rbfem.results.view import draw, require_drawing


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    directory = tmp_path_factory.mktemp("toy")
    write(make_scene(), directory, 4)
    return directory


@pytest.fixture(scope="module")
def _can_draw():
    try:
        require_drawing()
    except MissingLibraryError as error:
        pytest.skip(str(error))


def write(scene, directory, n_frames):
    with SeriesWriter(scene, directory) as series:
        for i in range(n_frames):
            series.write(make_frame(scene, i))


def pixels(path, frame=0):
    from PIL import Image

    with Image.open(path) as image:
        image.seek(frame)
        return np.asarray(image.convert("RGB")).astype(int)


def n_colored(image):
    """Pixels that are neither white nor grey."""
    return int((np.ptp(image, axis=2) > 60).sum())


@pytest.mark.usefixtures("_can_draw")
def test_the_command_draws_a_picture_and_a_film_beside_the_results(results):
    done = CliRunner().invoke(command, [str(results)], catch_exceptions=False)
    assert done.stdout.split() == [str(results / "toy.png"), str(results / "toy.gif")]
    image = pixels(results / "toy.png")
    assert n_colored(image) > 0.03 * image[:, :, 0].size
    assert tuple(image[5, 5]) == (255, 255, 255)
    first, last = pixels(results / "toy.gif", 0), pixels(results / "toy.gif", 3)
    assert n_colored(first) > 0.01 * first[:, :, 0].size
    assert (first != last).any(axis=2).mean() > 0.01


@pytest.mark.usefixtures("_can_draw")
def test_every_body_is_in_view_at_every_time(results, tmp_path):
    for time in (0.0, 0.05, 0.1):
        (path,) = draw(results, tmp_path / "at.png", time)
        image = pixels(path)
        inside = image[12:-12, 12:-12]
        assert n_colored(image) == n_colored(inside) > 0


@pytest.mark.usefixtures("_can_draw")
def test_many_bodies_are_coloured_by_speed(tmp_path):
    write(make_scene(30, 0), tmp_path, 2)
    (path,) = draw(tmp_path, tmp_path / "many.png")
    colors = np.unique(pixels(path)[-120:].reshape(-1, 3), axis=0)
    assert len(colors) > 150


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda d: None, "found no NAME.pvd"),
        (lambda d: (d / "x.pvd").write_text("<VTKFile/>"), "found no NAME.pvd"),
        (lambda d: pair(d, "x", "not a collection"), "cannot be read as a ParaView collection"),
        (lambda d: pair(d, "x", "<VTKFile/>"), "lists no frames"),
        (lambda d: (pair(d, "x", ""), pair(d, "y", "")), "found those of x, y"),
        (lambda d: pair(d, "x", listing("gone.vtu")), "gone.vtu: is missing"),
    ],
)
def test_a_folder_without_results_is_refused(tmp_path, make, message, request):
    make(tmp_path)
    if "gone" in message:
        request.getfixturevalue("_can_draw")
    with pytest.raises(InputError, match=message):
        draw(tmp_path)


def pair(directory, name, text):
    for end in ("", "_bodies"):
        (directory / f"{name}{end}.pvd").write_text(text)


def listing(file):
    return f'<VTKFile><Collection><DataSet timestep="0" file="{file}"/></Collection></VTKFile>'


def test_a_folder_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="nowhere: no such folder"):
        draw(tmp_path / "nowhere")


def test_a_kind_of_picture_that_nobody_can_draw_is_refused(results, tmp_path):
    with pytest.raises(InputError, match=r"cannot draw a picture of this kind; give a name that ends in \.png"):
        draw(results, tmp_path / "film.avi")


@pytest.mark.usefixtures("_can_draw")
def test_a_cut_off_frame_is_named(tmp_path):
    write(make_scene(), tmp_path, 2)
    path = find_series(tmp_path).parts[1]
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match=r"toy_000001.vtu: its end is missing"):
        draw(tmp_path, tmp_path / "x.png")


@pytest.mark.usefixtures("_can_draw")
def test_a_picture_that_cannot_be_written_is_named(results, tmp_path):
    (tmp_path / "taken.png").mkdir()
    with pytest.raises(RunError, match=r"taken.png: could not be written"):
        draw(results, tmp_path / "taken.png")


def test_without_opengl_the_person_is_told_what_to_install(results, tmp_path, monkeypatch):
    if ctypes.util.find_library("OSMesa"):
        pytest.skip("libOSMesa is installed, so VTK's window for it works")
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
    with pytest.raises(MissingLibraryError, match=r"apt-get install -y --no-install-recommends .*libegl1"):
        draw(results, tmp_path / "x.png")
    assert not (tmp_path / "x.png").exists()


@pytest.mark.parametrize(("length", "expected"), [(0.01, 0.01), (0.0199, 0.01), (4.99, 2.0), (5.0, 5.0), (1e3, 1e3)])
def test_floor_tiles_have_round_widths(length, expected):
    assert round_length(length) == pytest.approx(expected)
