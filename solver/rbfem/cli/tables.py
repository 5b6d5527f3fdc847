"""Plans and reports as lines for a person."""

import shlex
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rbfem.planning.plan import Choice, Plan
from rbfem.scene.scene import Scene

LABEL, WIDTH = 12, 110


def plan_lines(scene: Scene, plan: Plan) -> Iterator[str]:
    """A plan, one choice a paragraph, below what shows a density or a length in the wrong unit."""
    bodies = f"{plan.n_bodies} bod{'y' if plan.n_bodies == 1 else 'ies'}"
    yield f"Plan of {plan.case}: {bodies}"
    yield from paragraph("scene", f"{bodies}, {scene.mass.sum():.4g} kg in all; bounding radius {_radii(scene)}")
    for choice in plan.models:
        names = ", ".join(choice.names) + (", …" if choice.count > len(choice.names) else "")
        yield from paragraph(choice.model, f"{choice.count} ({names}): {choice.reason}")
    for label in ("contact", "method", "step", "step_limit", "backend", "output"):
        yield from paragraph(label.replace("_", " "), _in_words(getattr(plan, label)))
    if plan.pilot.value:
        yield from paragraph("pilot", f"{plan.pilot.value} evaluations: {plan.pilot.reason}")
    yield from paragraph("check", plan.verify.reason)
    yield from paragraph("accuracy", f"{plan.accuracy:g} accepted; what the check finds is held against it")
    yield from paragraph("left out", "; ".join(plan.left_out))
    for warning in plan.warnings:
        yield from paragraph("warning", warning)


def report_lines(report: dict[str, Any], directory: Path) -> Iterator[str]:
    """The end of a run: error, balance, cost, expectations, warnings, and where to look."""
    error, cost = report["error"], report["cost"]
    yield from paragraph("error", _verdict(error))
    drift = ", ".join(
        f"{name.replace('_', ' ')} {one['largest_drift']:.2g} {one['unit']}"
        for name, one in report["invariants"].items()
    )
    yield from paragraph("drift", drift)
    seconds = ", ".join(f"{phase} {time:.2g} s" for phase, time in cost["wall_seconds"].items())
    yield from paragraph("cost", f"{seconds}; {cost['steps']} steps, {cost['body_steps_per_second']:.3g} body-steps/s")
    for expect in report["expect"]:
        sign = "ok" if expect["pass"] else "MISSED"
        yield from paragraph(
            sign,
            f"{expect['quantity']} at {expect['at']:g} s: off by {expect['error']:.3g}, "
            f"tolerance {expect['tolerance']:g} ({expect['source']})",
        )
    for warning in (said for said in report["warnings"] if said not in report["plan"]["warnings"]):
        yield from paragraph("warning", warning)
    series = shlex.quote(f"{directory / report['case']}.pvd")
    yield f"  {'look':<{LABEL}}paraview {series}"  # commands to copy are never wrapped
    yield f"  {'or':<{LABEL}}rbfem view {shlex.quote(str(directory))}"


def paragraph(label: str, text: str) -> Iterator[str]:
    """A label in a column of its own and the text beside it, wrapped.

    >>> list(paragraph("step", "short"))
    ['  step        short']
    """
    lines = textwrap.wrap(text, WIDTH - LABEL, break_long_words=False, break_on_hyphens=False) or [""]
    for index, line in enumerate(lines):
        yield f"  {label if index == 0 else '':<{LABEL}}{line}"


def _radii(scene: Scene) -> str:
    smallest, largest = (f"{radius:.3g}" for radius in (scene.bounding_radius.min(), scene.bounding_radius.max()))
    return f"{smallest} m" if smallest == largest else f"{smallest} to {largest} m"


def _verdict(error: dict[str, Any]) -> str:
    if error["estimated"] is None:
        return f"not known: {error['how']}"
    verdict = "within" if error["estimated"] <= error["asked"] else "ABOVE"
    unmet = f"; this is the best that was reached: {error['unmet']}" if error["unmet"] else ""
    return f"estimated {error['estimated']:.2g}, {verdict} the {error['asked']:.2g} asked for{unmet}; {error['how']}"


def _in_words(choice: Choice) -> str:
    value = f"{choice.value:.6g} s" if isinstance(choice.value, float) else str(choice.value)  # the numbers are steps
    if choice.value is None:
        value = "none"
    rest = "; ".join(part for part in (choice.error, choice.cost) if part)
    return f"{value}: {choice.reason}" + (f" [{rest}]" if rest else "")
