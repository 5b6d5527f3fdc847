"""Draw the pictures of the README and the gallery: every case is run and looked at.

python docs/make_pictures.py
"""

import tempfile
from pathlib import Path

from PIL import Image

import rbfem
from rbfem.results.record import record
from rbfem.results.report import Clock
from rbfem.results.view import draw
from rbfem.study.chart import write_chart
from rbfem.study.work_precision import measure

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
WIDTH, CHART_WIDTH, COLOURS = 720, 1400, 96
# The strip of the README: the T-handle before, while and after it turns over.
STRIP_TIMES = (0.0, 0.9, 1.1, 1.3, 1.6, 2.0)


def run(case: Path, folder: Path) -> None:
    scene = rbfem.load(case)
    record(scene, rbfem.plan(scene), folder, Clock(), lambda frame: None)


def small(path: Path, width: int) -> Image.Image:
    picture = Image.open(path).convert("RGB")
    return picture.resize((width, round(width * picture.height / picture.width)), Image.Resampling.LANCZOS)


def save(picture: Image.Image, name: str) -> None:
    picture.quantize(COLOURS).save(PICTURES / name, optimize=True)


def strip(folder: Path) -> Image.Image:
    """Several times side by side."""
    frames = [small(draw(folder, folder / f"{time}.png", time)[0], WIDTH // 2) for time in STRIP_TIMES]
    width, height = frames[0].size
    sheet = Image.new("RGB", (3 * width, 2 * height), "white")
    for index, frame in enumerate(frames):
        sheet.paste(frame, (index % 3 * width, index // 3 * height))
    return sheet


def chart(folder: Path) -> Image.Image:
    """The chart of the README: a heavy asymmetric top, watched so seldom that the outputs do not cut the steps."""
    scene = rbfem.load(ROOT / "cases" / "asymmetric_top", ["output.every=0.5"])
    write_chart(measure(scene), folder)
    return small(folder / "chart.png", CHART_WIDTH)


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    for case in sorted((ROOT / "cases").glob("*/case.yaml")):
        name = case.parent.name
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            run(case, folder)
            picture = strip(folder) if name == "t_handle" else small(draw(folder, folder / "last.png")[0], WIDTH)
            save(picture, f"{name}.png")
    with tempfile.TemporaryDirectory() as place:
        save(chart(Path(place)), "chart.png")
