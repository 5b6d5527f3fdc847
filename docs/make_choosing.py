"""Measure the table of docs/motion.md from which `auto` chooses: evaluations to an error, by method and kind of motion.

python docs/make_choosing.py
"""

from pathlib import Path

import rbfem
from rbfem.study.work_precision import WorkPrecision, measure

ROOT = Path(__file__).parents[1]
# Cases watched so seldom that the outputs do not cut the steps.
CASES = {
    "lagrange_top": "heavy symmetric top",
    "asymmetric_top": "heavy asymmetric top",
    "heavy_top": "fast top, weakly turned",
    "satellite": "gradient of a field",
    "bolt_on_spring": "springs with dampers",
}
ERRORS = (1e-3, 1e-6, 1e-9)


def evaluations(study: WorkPrecision, method: str, error: float) -> str:
    """Of the cheapest run of a method within an error; a dash where there is none."""
    within = [point.evaluations for point in study.of(method) if point.error <= error]
    return f"{min(within):.0f}" if within else "–"


def main() -> None:
    studies = {}
    for name in CASES:
        scene = rbfem.load(ROOT / "cases" / name)
        studies[name] = measure(rbfem.load(ROOT / "cases" / name, [f"output.every={scene.end_time / 4}"]))
    methods = [name for name in next(iter(studies.values())).methods]
    print("| method | " + " | ".join(CASES.values()) + " |")
    print("|---" * (len(CASES) + 1) + "|")
    for method in methods:
        cells = [" / ".join(evaluations(study, method, error) for error in ERRORS) for study in studies.values()]
        print(f"| `{method}` | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
