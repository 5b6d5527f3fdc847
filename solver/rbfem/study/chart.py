"""The work-precision chart as files: numbers (.csv), pictures (.png, .svg) and a page to hover over (.html)."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rbfem.results.whole_file import whole_file, write_text
from rbfem.study.chart_page import page
from rbfem.study.summary import by_cost, order_words, stated_words
from rbfem.study.work_precision import Point, WorkPrecision

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COSTS = {"seconds": "wall time of the steps, one core", "evaluations": "evaluations of the loads, per body"}
COLUMNS = (
    *("method", "order", "measured_order", "step", "tolerance", "steps", "evaluations", "seconds", "error"),
    *("is_stable", "is_above_floor", "on_front_seconds", "on_front_evaluations", "is_chosen"),
)

# Seven hues that the colour-blind tell apart (Okabe and Ito, 2008, without its yellow), then again with another marker.
HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#3A3A3A")
MARKERS, LINES = "os^", ("-", (0, (5, 1.5)), (0, (1.5, 1.5)))
INK, PALE, GRID = "#222222", "#777777", "#E4E4E4"
STYLE: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 10,
    "axes.edgecolor": PALE,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": PALE,
    "ytick.color": PALE,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "svg.hashsalt": "rbfem",  # the same picture is the same file
}
ABOVE_FLOOR = 3.0  # times the floor: below, an error is mostly the reference's own
HIGHEST = 10.0  # errors are drawn up to here; what is worse lies on the edge
STAR: Any = {"marker": "*", "color": "#FFD21F", "markeredgecolor": INK, "markeredgewidth": 1.1}
UNSTABLE_DECADES = 2.0  # height of the strip for the unstable


def write_chart(study: WorkPrecision, directory: Path) -> list[Path]:
    """Write chart.csv, chart.png, chart.svg and chart.html, each whole or not at all; returns their paths.

    Raises RunError if one cannot be written.
    """
    paths = [directory / f"chart.{kind}" for kind in ("csv", "png", "svg", "html")]
    write_text(paths[0], as_csv(study))
    figure = draw(study)
    with whole_file(paths[1]) as temporary:
        figure.savefig(temporary, dpi=150)
    drawing = as_svg(figure)
    write_text(paths[2], drawing)
    write_text(paths[3], page(study, drawing))
    return paths


def as_csv(study: WorkPrecision) -> str:
    """One row a run, the run of the plan last; an infinite error is `inf`, a tolerance that is not there is empty."""
    lines = io.StringIO()
    table = csv.writer(lines, lineterminator="\n")
    table.writerow(COLUMNS)
    fronts = [study.front(cost) for cost in COSTS]
    for point in (*study.points, study.chosen):
        is_chosen = point is study.chosen
        measured = study.order(point.method) if point.method in study.methods else None
        on_fronts = [not is_chosen and any(point is one for one in front) for front in fronts]
        own = [point.step, point.tolerance, point.steps, point.evaluations, point.seconds, point.error]
        flags = [point.is_stable, point.error > ABOVE_FLOOR * study.floor, *on_fronts, is_chosen]
        table.writerow([point.method, study.orders[point.method], measured, *own, *flags])
    return lines.getvalue()


def as_svg(figure: Figure) -> str:
    """The drawing as SVG without date and maker, so that the same study gives the same text."""
    from matplotlib import rc_context

    text = io.StringIO()
    with rc_context(STYLE):
        figure.savefig(text, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    return text.getvalue()


def draw(study: WorkPrecision) -> Figure:
    """Two panels, error against seconds and against evaluations; every run is an artist of its own, see `run_id`."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(13.5, 6.8), facecolor="white")
        panels = figure.subplots(1, 2, sharey=True)
        figure.subplots_adjust(left=0.06, right=0.795, top=0.855, bottom=0.085, wspace=0.05)
        for axes, cost in zip(panels, COSTS, strict=True):
            _draw_panel(axes, study, cost)
        panels[0].set_ylabel("largest error: position / bounding radius, attitude in rad")
        _label_levels(panels, study)
        _title(figure, study)
        _legend(figure, study)
    return figure


def run_id(index: int, cost: str) -> str:
    """Name of the artist of a run in a panel; the page finds it by that. The run of the plan comes after all points.

    >>> run_id(12, "seconds")
    'run-12-seconds'
    """
    return f"run-{index}-{cost}"


def _draw_panel(axes: Axes, study: WorkPrecision, cost: str) -> None:
    lowest, highest = _limits(study)
    top = highest * 10.0**UNSTABLE_DECADES
    axes.set(xscale="log", yscale="log", xlabel=_cost_words(study, cost), ylim=(lowest, top))
    axes.grid(color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, which="both")
    axes.spines[["top", "right"]].set_visible(False)
    axes.axhspan(lowest, study.floor, color="#EDEDED", linewidth=0, zorder=0)
    axes.axhspan(highest, top, color="#FBEDEA", linewidth=0, zorder=1.5)
    axes.axhline(study.accuracy, color=INK, linewidth=1.0, linestyle=(0, (6, 3)), zorder=2)
    front = study.front(cost)
    heights = [_height(study, point) for point in front]
    axes.plot([_cost(p, cost) for p in front], heights, color="#F3D55B", linewidth=9, alpha=0.5, zorder=1.8)[0].set(
        solid_capstyle="round", solid_joinstyle="round"
    )
    for method in study.methods:
        stable = [point for point in study.of(method) if point.is_stable]
        x, y = [_cost(p, cost) for p in stable], [_height(study, p) for p in stable]
        axes.plot(x, y, color=_hue(study, method), linestyle=_line(study, method), linewidth=1.3, zorder=3)
    for index, point in enumerate(study.points):
        _draw_run(axes, study, index, point, cost)
    _draw_chosen(axes, study, cost)
    _tick(axes, study, cost)


def _tick(axes: Axes, study: WorkPrecision, cost: str) -> None:
    """Errors by decades, none in the strip of the unstable; costs in words, closer together on a short axis."""
    from matplotlib.ticker import FixedLocator, LogLocator, NullLocator

    lowest, highest = _limits(study)
    decades = range(round(math.log10(lowest)), round(math.log10(highest)) + 1)
    axes.yaxis.set_major_locator(FixedLocator([10.0**digits for digits in decades if digits % 2 == 0]))
    left, right = axes.get_xlim()
    is_short = math.log10(right / left) < 2.5
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if is_short else (1.0,)))
    axes.xaxis.set_major_formatter(
        lambda value, position: _seconds_words(value) if cost == "seconds" else f"{value:,.0f}"
    )
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_locator(NullLocator())


def _seconds_words(seconds: float) -> str:
    """A time as it stands at an axis.

    >>> _seconds_words(0.02), _seconds_words(5e-5), _seconds_words(10.0)
    ('20 ms', '50 µs', '10 s')
    """
    for size, unit in ((1.0, "s"), (1e-3, "ms")):
        if seconds >= 0.999 * size:
            return f"{seconds / size:g} {unit}"
    return f"{seconds / 1e-6:g} µs"


def _draw_run(axes: Axes, study: WorkPrecision, index: int, point: Point, cost: str) -> None:
    hue, is_sure = _hue(study, point.method), point.error > ABOVE_FLOOR * study.floor
    look: dict[str, Any] = {"marker": _marker(study, point.method), "markersize": 5}
    if not point.is_stable:
        look = {"marker": "x", "markersize": 6, "markeredgewidth": 1.6}
    axes.plot(
        [_cost(point, cost)],
        [_height(study, point)],
        color=hue,
        markerfacecolor=hue if is_sure else "white",
        linestyle="none",
        zorder=4,
        gid=run_id(index, cost),
        **look,
    )


def _draw_chosen(axes: Axes, study: WorkPrecision, cost: str) -> None:
    point = study.chosen
    x, y = _cost(point, cost), _height(study, point)
    axes.plot(
        [x],
        [y],
        markersize=19,
        linestyle="none",
        zorder=6,
        gid=run_id(len(study.points), cost),
        **STAR,
    )
    is_far_right = axes.transAxes.inverted().transform(axes.transData.transform((x, y)))[0] > 0.7
    axes.annotate(
        f"{'auto' if study.is_auto else 'as asked'}: {point.method}",
        (x, y),
        xytext=(-11 if is_far_right else 11, 8),
        textcoords="offset points",
        ha="right" if is_far_right else "left",
        fontweight="bold",
        zorder=7,
        path_effects=_halo(),
    )


def _label_levels(panels: Sequence[Axes], study: WorkPrecision) -> None:
    """Words beside the floor and the strip of the unstable, at the left, and beside the accuracy, at the right."""
    lowest, highest = _limits(study)

    def say(axes: Axes, x: float, y: float, words: str, color: str, **where: Any) -> None:
        place: dict[str, Any] = {"transform": axes.get_yaxis_transform(), "path_effects": _halo()} | where
        axes.text(x, y, words, fontsize=9, color=color, zorder=5, **place)

    say(panels[1], 0.99, study.accuracy, f"accepted: {study.accuracy:g}", INK, ha="right", va="bottom")
    middle = math.sqrt(lowest * study.floor)
    say(panels[0], 0.99, middle, f"methods agree to {study.floor:.1g}", PALE, ha="right", va="center")
    has_unstable = any(not point.is_stable for point in study.points)
    words = "unstable" if has_unstable else "unstable: none; the outputs cut every step short enough"
    top = highest * 10.0 ** (UNSTABLE_DECADES - 0.15)
    say(panels[0], 0.012, top, words, "#A33B20", va="top", path_effects=[])


def _title(figure: Figure, study: WorkPrecision) -> None:
    bodies = f"{study.n_bodies} bod{'y' if study.n_bodies == 1 else 'ies'}"
    figure.text(0.06, 0.945, study.title or study.case, fontsize=16, fontweight="bold")
    facts = f"{bodies}, {study.end_time:g} s; error against cost of every method, held against {study.reference}"
    figure.text(0.06, 0.905, facts, color="#555555")


def _legend(figure: Figure, study: WorkPrecision) -> None:
    """Methods, the cheapest within the accuracy first, with the order measured here and the one of the table."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=_hue(study, name), marker=_marker(study, name), linestyle=_line(study, name), markersize=5)
        for name in by_cost(study)
    ]
    labels = [
        f"{name}   {order_words(study.order(name))} ({stated_words(study.orders[name])})" for name in by_cost(study)
    ]
    look: dict[str, Any] = {"frameon": False, "borderaxespad": 0.0, "fontsize": 9.5, "alignment": "left"}
    upper: dict[str, Any] = {
        "loc": "upper left",
        "bbox_to_anchor": (0.808, 0.855),
        "handlelength": 2.8,
        "title": "method, order here (in the table)",
    }
    figure.legend(handles, labels, **look, **upper)
    signs: dict[str, dict[str, Any]] = {
        "stable": {"marker": "o"},
        f"below {ABOVE_FLOOR:g} times the grey floor": {"marker": "o", "markerfacecolor": "white"},
        "unstable": {"marker": "x"},
        "best there is at its cost": {"marker": "", "linewidth": 7, "color": "#F3D55B", "alpha": 0.6, "linestyle": "-"},
        _chosen_words(study): STAR | {"markersize": 14},
    }
    usual: dict[str, Any] = {"color": PALE, "linestyle": "none", "markersize": 6}
    samples = [Line2D([], [], **(usual | sign)) for sign in signs.values()]
    figure.legend(samples, list(signs), loc="lower left", bbox_to_anchor=(0.808, 0.085), handlelength=1.6, **look)


def _chosen_words(study: WorkPrecision) -> str:
    """What the star stands for: its cost has parts in it that no other point has."""
    if study.is_auto:
        return "auto, with trial run and check\n(the curves are without)"
    return "as asked, with check\n(the curves are without)"


def _limits(study: WorkPrecision) -> tuple[float, float]:
    """Lowest and highest error of the panels, without the strip of the unstable."""
    lowest = 10.0 ** math.floor(math.log10(study.floor) - 0.5)
    worst = max((point.error for point in study.points if point.is_stable), default=1.0)
    return lowest, min(HIGHEST, 10.0 ** math.ceil(math.log10(max(worst, study.accuracy, 10.0 * study.floor))))


def _height(study: WorkPrecision, point: Point) -> float:
    """Where a run is drawn: at its error, or on the edge; an unstable one in the strip, a row for each method."""
    lowest, highest = _limits(study)
    if point.is_stable:
        return min(max(point.error, 2.0 * lowest), highest)
    methods = (*study.methods, study.chosen.method)
    share = (methods.index(point.method) + 0.5) / len(study.methods)
    return highest * 10.0 ** (UNSTABLE_DECADES * (0.05 + 0.65 * min(share, 1.0)))


def _cost_words(study: WorkPrecision, cost: str) -> str:
    """Below an axis, with a word on what stands there although a logarithm has no place for it."""
    is_free = cost == "evaluations" and any(point.evaluations == 0 for point in (*study.points, study.chosen))
    return COSTS[cost] + (" (none: drawn at 1)" if is_free else "")


def _cost(point: Point, cost: str) -> float:
    """Seconds or evaluations; a logarithmic axis has no place for none at all."""
    return max(float(getattr(point, cost)), 1.0 if cost == "evaluations" else 1e-7)


def _hue(study: WorkPrecision, method: str) -> str:
    return HUES[study.methods.index(method) % len(HUES)]


def _marker(study: WorkPrecision, method: str) -> str:
    return MARKERS[study.methods.index(method) // len(HUES) % len(MARKERS)]


def _line(study: WorkPrecision, method: str) -> Any:
    return LINES[study.methods.index(method) // len(HUES) % len(LINES)]


def _halo() -> list:
    """A white rim that keeps words readable over lines."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=3, foreground="white")]
