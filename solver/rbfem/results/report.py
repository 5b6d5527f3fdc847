"""report.json: what was modelled, at what error and cost, and what came out."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from rbfem import __version__
from rbfem.planning.touching import quickest, restitution_error
from rbfem.results.whole_file import write_text
from rbfem.scene.scene import Scene
from rbfem.simulation.expectations import ExpectationResult
from rbfem.simulation.frame import Balance, Frame
from rbfem.simulation.run import Run

UNITS = {"energy": "J", "momentum": "kg m/s", "angular_momentum": "kg m^2/s"}


class Clock:
    """Wall seconds by phase."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Add the time of the block to a phase."""
        began = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - began


def make_report(run: Run, clock: Clock) -> dict[str, Any]:
    """The report of a run that has at least its first frame."""
    assert run.first is not None and run.last is not None
    scene = run.scene
    return {
        "rbfem": __version__,
        "case": scene.name,
        "title": scene.title,
        "scene": _scene(scene),
        "plan": run.plan.to_dict(),
        "error": _error(run),
        "cost": _cost(run, clock),
        "invariants": _invariants(run, run.first.balance, run.last.balance),
        "final": _final(run, run.last),
        "expect": [_expectation(result) for result in run.expectations],
        "warnings": [*run.warnings, *run.plan.warnings],
    }


def write_report(report: dict[str, Any], directory: Path) -> None:
    """report.json, whole or not at all. Raises RunError."""
    write_text(directory / "report.json", json.dumps(report, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def _scene(scene: Scene) -> dict[str, Any]:
    """Masses and sizes, in which a wrong unit is seen."""
    keys = ("name", "mass", "volume", "bounding_radius")
    parts = [{key: getattr(part, key) for key in keys} for part in scene.parts]
    return {"bodies": scene.n_bodies, "mass": float(scene.mass.sum()), "parts": parts}


def _error(run: Run) -> dict[str, Any]:
    motion = run.error
    parts: dict[str, dict[str, Any]] = {
        "motion": {
            "estimated": motion.estimated,
            "position_difference": motion.position,
            "attitude_difference": motion.attitude,
            "rounding": motion.rounding,
            "redone": motion.redone,
            "how": f"{motion.how}; position as a share of the bounding radius, attitude in rad",
        },
        "mesh": {
            "estimated": None,
            "rounding": {part.name: part.inertia_error for part in run.scene.parts},
            "how": "rounding of the inertia tensor is predicted; the distance from mesh to part is not known from one "
            "mesh: `rbfem inertia --second` measures it",
        },
        "contact": _contact_part(run),
    }
    in_contact = run.scene.can_touch.any()
    return {
        "asked": run.scene.accuracy,
        "estimated": parts["contact"]["estimated"] if in_contact else motion.estimated,
        "unmet": run.unmet,
        "how": parts["contact"]["how"] if in_contact else motion.how,
        "parts": parts,
    }


def _contact_part(run: Run) -> dict[str, Any]:
    """What is promised where bodies touch: the restitution, and that the sum of energies closes."""
    if not run.scene.can_touch.any():
        return {"estimated": None, "how": "not modelled"}
    assert run.last is not None
    restitution = restitution_error(float(run.plan.step.value), quickest(run.scene))
    exchanged = run.last.balance.damping + run.last.balance.friction + run.last.balance.kinetic
    energy = run.largest_drift["energy"] / exchanged if exchanged > 0.0 else 0.0
    return {
        "estimated": max(restitution, energy),
        "restitution": restitution,
        "energy": energy,
        "how": "the larger of the error of the restitution at this step, from measurements, and of how far the sum of "
        "energies is from closing, as a share of what contacts took and what still moves",
    }


def _cost(run: Run, clock: Clock) -> dict[str, Any]:
    rate = run.cost.body_steps / run.cost.wall_seconds if run.cost.wall_seconds else 0.0
    return {
        "wall_seconds": dict(clock.seconds),
        "steps": run.cost.steps,
        "force_evaluations": run.cost.evaluations + int(run.plan.pilot.value),
        "body_steps_per_second": rate,
    }


def _invariants(run: Run, first: Balance, last: Balance) -> dict[str, Any]:
    brought = {"energy": last.work, "momentum": last.impulse, "angular_momentum": last.angular_impulse}
    return {
        name: {
            "initial": _plain(getattr(first, name)),
            "final": _plain(getattr(last, name)),
            "work_done" if name == "energy" else "impulse": _plain(brought[name]),
            "largest_drift": run.largest_drift[name],
            "unit": unit,
        }
        for name, unit in UNITS.items()
    }


def _final(run: Run, frame: Frame) -> dict[str, Any]:
    keys = ("position", "quaternion", "velocity", "angular_velocity")
    bodies = {
        name: {key: getattr(frame, key)[body].tolist() for key in keys} for body, name in enumerate(run.scene.names)
    }
    return {"time": frame.time, "bodies": bodies}


def _expectation(result: ExpectationResult) -> dict[str, Any]:
    expectation = result.expectation
    return {
        "quantity": expectation.quantity,
        "at": expectation.time,
        "value": _plain(result.found),
        "expected": _plain(expectation.value),
        "error": result.error,
        "tolerance": expectation.tolerance,
        "pass": result.passed,
        "source": expectation.source,
    }


def _plain(value: Any) -> Any:
    return np.asarray(value).tolist()
