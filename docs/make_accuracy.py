"""Measure and draw what `auto` keeps of its promise over random scenes: picture and numbers of docs/motion.md.

python docs/make_accuracy.py [SCENES]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests" / "benchmarks"))

from accuracy_benchmark import N_SCENES, Outcome, study  # noqa: E402

PICTURE = ROOT / "docs" / "pictures" / "accuracy.png"
BLUE, GREY = "#0072b2", "#888888"


def histogram(axes, ratios: np.ndarray, limit: float, title: str, label: str) -> None:
    """Logarithms of ratios, and the line that they should stay on one side of."""
    axes.hist(np.log10(ratios), bins=np.arange(-8.0, 4.01, 0.25), color=BLUE)
    axes.axvline(np.log10(limit), color=GREY, linestyle="--")
    axes.set(title=title, xlabel=label)
    axes.set_xlim(np.log10(ratios.min()) - 0.5, max(np.log10(ratios.max()), np.log10(limit)) + 0.5)
    axes.spines[["top", "right"]].set_visible(False)


def draw(outcomes: list[Outcome]) -> None:
    """Three histograms side by side."""
    asked, true, estimated, cost, best = (
        np.array([getattr(one, name) for one in outcomes]) for name in ("asked", "true", "estimated", "cost", "best")
    )
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(10, 3), layout="constrained")
    histogram(left, true / asked, 1.0, "true error", "log10 of true / asked")
    histogram(middle, estimated / true, 1.0, "printed error", "log10 of printed / true")
    histogram(right, cost / best, 1.5, "cost", "log10 of auto / best fixed choice")
    left.set_ylabel("scenes")
    figure.savefig(PICTURE, dpi=110)


def say(outcomes: list[Outcome], n_scenes: int) -> None:
    """The numbers of the page."""
    asked, true, estimated, cost, best = (
        np.array([getattr(one, name) for one in outcomes]) for name in ("asked", "true", "estimated", "cost", "best")
    )
    print(f"{len(outcomes)} of {n_scenes} scenes can be judged")
    print(f"true <= asked: {100 * (true <= asked).mean():.1f} %")
    print(f"printed >= true: {100 * (estimated >= true).mean():.1f} %")
    print(f"printed <= 10 true: {100 * (estimated <= 10 * true).mean():.1f} %")
    print(f"cost / best fixed: median {np.median(cost / best):.2f}, 90 % below {np.quantile(cost / best, 0.9):.2f}")
    for name in sorted({one.method for one in outcomes}):
        print(f"chosen: {name} {sum(one.method == name for one in outcomes)} times")


if __name__ == "__main__":
    n_scenes = int(sys.argv[1]) if len(sys.argv) > 1 else N_SCENES
    judged = [one for one in study(n_scenes) if one.can_be_judged]
    draw(judged)
    say(judged, n_scenes)
