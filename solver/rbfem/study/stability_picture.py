"""The stability study as files: numbers (.csv) and a picture (.png, .svg)."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rbfem.motion.methods import METHODS
from rbfem.planning.frequencies import step_limit
from rbfem.results.whole_file import whole_file, write_text
from rbfem.study.amplification import stable_step
from rbfem.study.chart import INK
from rbfem.study.chart import STYLE as CHART_STYLE
from rbfem.study.stability import Limit, Stability, as_csv
from rbfem.study.stability_map import growth

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

SHOWN = ("kdk", "dlm", "spiral", "semi_implicit_euler", "rk4", "rkn4", "dop853_fixed")
SWINGS = np.arange(0.075, 6.6, 0.15)  # dt ω_max
RATIOS = np.linspace(0.0, 1.2, 21)  # ζ, and spin/ω_max
MAP_STEPS = 700  # enough for a picture
FASTEST = 1.0  # growth of the amplitude per step, ln, at which the colour ends

LEGEND = "stable where it is blue, growing the faster the darker; dashed: theory without spin"
STABLE, MEASURED, THEORY = "#DCE9F2", "#0072B2", "#D55E00"
STYLE = {**CHART_STYLE, "font.size": 9}


def write_stability(study: Stability, directory: Path) -> list[Path]:
    """Write stability.csv, stability.png and stability.svg, each whole or not at all; returns their paths.

    Raises RunError if one cannot be written.
    """
    from matplotlib import rc_context

    paths = [directory / f"stability.{kind}" for kind in ("csv", "png", "svg")]
    write_text(paths[0], as_csv(study))
    figure = draw(study, maps())
    with rc_context(STYLE):
        with whole_file(paths[1]) as temporary:
            figure.savefig(temporary, dpi=130)
        with whole_file(paths[2]) as temporary:
            nameless: dict[str, Any] = dict.fromkeys(("Date", "Creator", "Format", "Type"))
            figure.savefig(temporary, format="svg", metadata=nameless)
    return paths


def maps(swings: Array = SWINGS, ratios: Array = RATIOS) -> dict[str, tuple[Array, Array]]:
    """Growth per step of each method that is shown, (ratios, swings): without spin over ζ, undamped over the spin."""
    swing, ratio = (grid.ravel() for grid in np.meshgrid(swings, ratios))
    shape = len(ratios), len(swings)
    for method in ("kdk", "rk4"):  # compiled before the threads start
        growth(method, swings[:1], ratios[:1], ratios[:1])

    def of(method: str) -> tuple[Array, Array]:
        none = np.zeros_like(ratio)
        pair = growth(method, swing, ratio, none, MAP_STEPS), growth(method, swing, none, ratio, MAP_STEPS)
        return pair[0].reshape(shape), pair[1].reshape(shape)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip(SHOWN, pool.map(of, SHOWN), strict=True))


def draw(study: Stability, growths: dict[str, tuple[Array, Array]]) -> Figure:
    """The limits on this scene at the left, and the maps of the reference body of `growth` at the right."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(16.5, 6.0), facecolor="white")
        figure.text(0.012, 0.945, study.title or study.case, fontsize=15, fontweight="bold")
        figure.text(0.012, 0.903, "the longest stable step of each method on this case", color="#555555")
        grid = figure.add_gridspec(1, 1, left=0.105, right=0.30, top=0.86, bottom=0.10)
        _draw_limits(figure.add_subplot(grid[0]), study)
        draw_maps(figure, growths, study, left=0.355)
    return figure


def draw_maps(figure: Figure, growths: dict, study: Stability | None, left: float) -> None:
    """Two rows of panels, over ζ and over the spin; the case, if there is one, as a line at its own ratio."""
    grid = figure.add_gridspec(2, len(growths), left=left, right=0.988, top=0.82, bottom=0.10, wspace=0.10, hspace=0.2)
    apart, case = ("", "") if study is None else (", not this case", "; dotted: ζ and spin of this case")
    figure.text(left, 0.945, f"A reference body{apart}: sprung, damped, spinning", fontsize=12, fontweight="bold")
    figure.text(left, 0.903, f"{LEGEND}{case}", color="#555555")
    labels = "damping ratio ζ, no spin", "spin / ω_max, undamped"
    for column, (method, pair) in enumerate(growths.items()):
        for row in range(2):
            axes = figure.add_subplot(grid[row, column])
            _draw_map(axes, pair[row])
            limits = [stable_step(method, 1.0, ratio if row == 0 else 0.0) for ratio in RATIOS]
            axes.plot(limits, RATIOS, color=THEORY, linewidth=1.5, linestyle=(0, (4, 2)))
            axes.set(xlim=(0.0, SWINGS[-1]), ylim=(0.0, RATIOS[-1]), xticks=range(0, 7, 2), yticks=(0.0, 0.5, 1.0))
            if study is not None and study.fastest.oscillation:
                ratio = (study.damping_ratio, study.spin_ratio)[row]
                axes.axhline(min(ratio, RATIOS[-1]), color=INK, linewidth=0.9, linestyle=":")
            axes.tick_params(length=0, labelleft=column == 0, labelbottom=row == 1)
            if row == 0:
                axes.set_title(method, fontsize=9, fontweight="bold")
            else:
                axes.set_xlabel("dt ω_max")
            if column == 0:
                axes.set_ylabel(labels[row])


def _draw_map(axes: Axes, grown: Array) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    colours = LinearSegmentedColormap.from_list("growth", ["#FBE3D0", "#E08A5B", "#7A2B14"])
    values = np.ma.masked_equal(np.minimum(grown, FASTEST), 0.0)
    axes.pcolormesh(SWINGS, RATIOS, values, cmap=colours, vmin=0.0, vmax=FASTEST, shading="nearest", rasterized=True)
    axes.set_facecolor(STABLE)


def _draw_limits(axes: Axes, study: Stability) -> None:
    """A bar for each method as long as its step and with its number, the theory and the limit of a plan as ticks."""
    names = [limit.method for limit in study.limits]
    unit, shortest = study.rate, study.fastest.step_limit / 20.0
    for place, limit in enumerate(study.limits):
        alpha = 0.85 if limit.is_limit else 0.4
        axes.barh(place, limit.step * unit, height=0.55, color=MEASURED, alpha=alpha)
        if 0.0 < limit.theory < np.inf:
            axes.plot([limit.theory * unit] * 2, [place - 0.4, place + 0.4], color=THEORY, linewidth=2.5)
        kept = step_limit(study.fastest, METHODS[limit.method]).seconds
        if kept < np.inf:
            axes.plot([kept * unit] * 2, [place - 0.5, place + 0.5], color=INK, linewidth=0.9, linestyle=":")
        _label_bar(axes, place, limit, shortest * unit, unit)
    longest = max(max(limit.step, limit.theory if limit.theory < np.inf else 0.0) for limit in study.limits)
    axes.set(xscale="log", xlim=(shortest * unit, 4.0 * longest * unit), yticks=range(len(names)), yticklabels=names)
    rate = "ω_max" if study.fastest.oscillation else "fastest decay or spin"
    axes.set_xlabel(f"dt times {rate}; orange: theory without spin; dotted: limit of a plan", fontsize=8)
    axes.xaxis.set_major_formatter(lambda value, place: f"{value:g}")
    axes.invert_yaxis()
    axes.tick_params(length=0, which="both")
    axes.spines[["top", "right"]].set_visible(False)


def _label_bar(axes: Axes, place: int, limit: Limit, left: float, unit: float) -> None:
    """The measured number at the end of its own bar: behind it, or inside where the tick of theory stands behind it."""
    words = f"{limit.step * unit:.2f}" if limit.step else "stable at no step"
    words = words if limit.is_limit else f"≥ {words}"
    end, theory = max(limit.step * unit, left), limit.theory * unit
    is_close = end <= theory < 3.0 * end
    if is_close and end > 6.0 * left:
        axes.text(end / 1.06, place, words, va="center", ha="right", fontsize=8, color="white")
    else:
        axes.text(1.08 * (theory if is_close else end), place, words, va="center", fontsize=8)
