"""Whether `auto` keeps its promise: random scenes, the error asked for, the true and the printed one, and the cost."""

import dataclasses
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from measuring import Effort, Row
from random_scenes import random_scene

import rbfem
from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.planning.plan import Choice
from rbfem.planning.timeline import total_steps
from rbfem.simulation.frame import Frame

N_SCENES = 200
FIXED_METHODS = ("kdk", "rk4", "lie_rk4", "rkn4", "aba864", "rkn6", "dop853_fixed")
COARSEST, FINEST = 2.0**3, 2.0**-14  # steps of the fixed choices, as shares of an output interval
REFERENCE_TOLERANCES = (1e-13, 1e-14)


@dataclass(frozen=True)
class Outcome:
    """A scene: what was asked, what came out, and the evaluations of `auto` and of the best fixed choice.

    unknown : how far two references are apart; where that is a tenth of what is asked nothing can be judged
    """

    title: str
    asked: float
    true: float
    estimated: float
    unknown: float
    cost: float
    best: float
    method: str

    @property
    def can_be_judged(self) -> bool:
        return self.unknown < 0.1 * self.asked


def accuracy(effort: Effort) -> list[Row]:
    """All rows of this file."""
    outcomes = [one for one in study(max(5, round(N_SCENES * effort.share))) if one.can_be_judged]
    true, asked = np.array([one.true for one in outcomes]), np.array([one.asked for one in outcomes])
    estimated = np.array([one.estimated for one in outcomes])
    cost = np.array([one.cost / one.best for one in outcomes])
    of = f"of {len(outcomes)} random scenes"
    return [
        _share(f"true error above the one asked for, {of}", true > asked, 0.03),
        _share(f"true error above the one printed, {of}", true > estimated, 0.03),
        _share(f"printed more than ten times the true one, {of}", estimated > 10.0 * true, 0.2),
        Row(
            f"evaluations, pilot and check included, median {of}",
            f"{np.median([one.cost for one in outcomes]):.0f}",
            "the cheapest fixed method and step that reaches the accuracy, without a check",
            float(np.median(cost)),
            1.5,
        ),
    ]


def _share(name: str, happens: np.ndarray, allowed: float) -> Row:
    share = float(happens.mean())
    return Row(name, f"{100 * share:.1f} %", f"{100 * allowed:.0f} % allowed", share / allowed, 1.0)


def study(count: int) -> list[Outcome]:
    """The outcomes of the first `count` random scenes, on all cores: evaluations are counted, not timed."""
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        return list(pool.map(outcome, range(count)))


def outcome(seed: int) -> Outcome:
    """Run a scene as `auto` has it, hold it against the reference, and look for the cheapest fixed choice."""
    with tempfile.TemporaryDirectory() as name:
        scene = random_scene(seed, Path(name))
    plan = dataclasses.replace(rbfem.plan(scene), backend=Choice("serial", "counted, not timed"))
    run = rbfem.simulate(scene, plan)
    frames = list(run)
    rough, reference = (frames_of(scene, plan, "dop853", tolerance) for tolerance in REFERENCE_TOLERANCES)
    return Outcome(
        title=scene.title,
        asked=scene.accuracy,
        true=largest_difference(scene, frames, reference),
        estimated=run.error.estimated or np.inf,
        unknown=largest_difference(scene, rough, reference),
        cost=run.cost.evaluations + plan.pilot.value,
        best=cheapest_fixed(scene, plan, reference),
        method=str(plan.method.value),
    )


def frames_of(scene: rbfem.Scene, plan: rbfem.Plan, method: str, knob: float) -> list[Frame]:
    """A plain run by a method with a step, or with a tolerance if it is adaptive."""
    is_adaptive = METHODS[method].is_adaptive
    fixed = dataclasses.replace(
        plan,
        method=Choice(method, "measured"),
        step=Choice(1e-3 if is_adaptive else knob, "measured"),
        tolerance=Choice(knob if is_adaptive else None, "measured"),
        verify=Choice(0, "the reference tells"),
        redo=False,
    )
    return list(rbfem.simulate(scene, fixed))


def cheapest_fixed(scene: rbfem.Scene, plan: rbfem.Plan, reference: list[Frame]) -> float:
    """Evaluations of the cheapest method and step, a factor √2 apart, whose error is the one asked for."""
    best = np.inf
    for method in FIXED_METHODS:
        step = COARSEST * scene.output_interval
        while step > FINEST * scene.output_interval:
            step /= 2.0**0.5
            cost = METHODS[method].evaluations * total_steps(scene, step)
            if cost >= best:
                break
            try:
                frames = frames_of(scene, plan, method, step)
            except rbfem.RunError:
                continue
            if largest_difference(scene, frames, reference) <= scene.accuracy:
                best = cost
    return best


def largest_difference(scene: rbfem.Scene, frames: list[Frame], others: list[Frame]) -> float:
    """Over frames and bodies: positions as a share of the bounding radius, attitudes in rad."""
    largest = 0.0
    for one, other in zip(frames, others, strict=True):
        apart = np.linalg.norm(one.position - other.position, axis=1) / scene.bounding_radius
        turned = quaternion.angle_between(one.quaternion, other.quaternion)
        largest = max(largest, float(apart.max()), float(turned.max()))
    return largest
