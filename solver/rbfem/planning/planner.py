"""From a Scene to a Plan: the rules of choice."""

import difflib
import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import clear_of_numba, is_cached
from rbfem.errors import InputError
from rbfem.motion.advance import advance
from rbfem.motion.methods import METHODS
from rbfem.motion.model import FIXED
from rbfem.planning.frequencies import Frequencies, frequencies
from rbfem.planning.models import choose_models, model_choices, pushed
from rbfem.planning.plan import Choice, Plan
from rbfem.planning.system import find_islands
from rbfem.planning.timeline import n_frames, total_steps
from rbfem.scene.scene import Scene

# `step: auto` as a share of the limit, by the order of the method. At order four dt ω = 0.04 leaves about 2e-8 rad of
# error a radian turned; a first-order method is at dt ω / 2 a radian and no sensible share makes it accurate.
SHARE_OF_LIMIT = {4: 1 / 50, 1: 1 / 1000}
STEPS_WITHOUT_LIMIT = {4: 1, 1: 1000}

# Seconds of a step and of a start, for choosing the backend (docs/motion.md has the measurement). The rest of a step is
# the same for all bodies, so only ratios matter.
PYTHON_STEP, PYTHON_PUSHED_STEP = 10e-6, 270e-6
KERNEL_STEP, KERNEL_PUSHED_STEP = 60e-9, 450e-9
NUMBA_START, COMPILATION, PARALLEL_START = 1.0, 12.0, 1.0
BODIES_A_THREAD = 2000
MOST_FRAMES, MOST_STEPS = 1e6, 1e13


@dataclass(frozen=True)
class Work:
    """Body-steps of a run, those of bodies that coast and those of bodies that are pushed."""

    coasting: float
    pushed: float

    def seconds(self, backend: str) -> float:
        if backend == "python":
            return self.coasting * PYTHON_STEP + self.pushed * PYTHON_PUSHED_STEP
        serial = self.coasting * KERNEL_STEP + self.pushed * KERNEL_PUSHED_STEP
        return serial if backend == "serial" else serial / (os.cpu_count() or 1) + PARALLEL_START


def plan(scene: Scene, beyond_limit: bool = False) -> Plan:
    """Choose what to compute for a scene.

    beyond_limit : go on where the step asked for is beyond the stability limit
    Raises InputError for a method that does not exist and for a step beyond the limit.
    """
    _refuse_endless("output.every", scene.end_time / scene.output_interval, MOST_FRAMES, "frames")
    models = choose_models(scene)
    islands = find_islands(scene, models)
    fastest = frequencies(scene, models, islands)
    method = _method(scene)
    limit = _step_limit(fastest)
    step = _step(scene, fastest, str(method.value), beyond_limit)
    _refuse_endless("time.step", scene.end_time / float(step.value), MOST_STEPS, "steps")
    verify = Choice(True, "a companion run at twice the step tells the error of this one", cost="half as much again")
    return Plan(
        case=scene.name,
        n_bodies=scene.n_bodies,
        models=model_choices(scene, models),
        contact=Choice("none", "this version has no contact model: bodies pass through each other"),
        method=method,
        step=step,
        step_limit=limit,
        verify=verify,
        backend=_backend(scene, models, float(step.value), len(islands.first) - 1),
        output=_output(scene),
        accuracy=scene.accuracy,
        left_out=_left_out(scene, models),
        warnings=_mesh_warnings(scene),
    )


def _refuse_endless(key: str, count: float, most: float, what: str) -> None:
    if not count <= most:
        raise InputError(
            f"{key}: the run would take {count:.3g} {what}, and {most:.0e} are the most; nobody would see its end"
        )


def _method(scene: Scene) -> Choice:
    if scene.method is None:
        return Choice(
            "rk4",
            "auto: the only method of the table that is of fourth order and keeps the quaternion a rotation",
            "order 4",
            "4 evaluations of the loads a step",
        )
    if scene.method not in METHODS:
        near = difflib.get_close_matches(scene.method, METHODS, n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise InputError(
            f"{scene.where('time.method')}: time.method: no method '{scene.method}'{hint} (known: {', '.join(METHODS)})"
        )
    row = METHODS[scene.method]
    grows = "" if row.oscillation_limit else "; an oscillation gains energy at every step size"
    evaluations = f"{row.evaluations} evaluation{'s' if row.evaluations > 1 else ''} of the loads a step"
    return Choice(scene.method, "asked for", f"order {row.order}{grows}", evaluations)


def _step_limit(fastest: Frequencies) -> Choice:
    limit = fastest.step_limit
    parts = [
        f"springs and weights swing at up to {fastest.oscillation:.4g} rad/s" if fastest.oscillation else "",
        f"dampers decay at up to {fastest.decay:.4g} 1/s" if fastest.decay else "",
        f"bodies spin at up to {fastest.spin:.4g} rad/s" if fastest.spin else "",
    ]
    reason = ", ".join(part for part in parts if part) or "nothing swings, is damped or spins"
    if np.isinf(limit):
        return Choice(None, reason)
    return Choice(limit, f"2/(√(ω² + β²) + β) and 2/spin: {reason}")


def _step(scene: Scene, fastest: Frequencies, method: str, beyond_limit: bool) -> Choice:
    limit, order = fastest.step_limit, METHODS[method].order
    if scene.step is not None:
        if scene.step > limit:
            _refuse_beyond(scene, limit, beyond_limit)
            return Choice(
                scene.step, f"asked for, and beyond the limit of {limit:.6g} s on purpose", "may grow without bound"
            )
        return Choice(scene.step, f"asked for; {_share(scene.step, limit)}", "see error.parts.motion in the report")
    if np.isinf(limit):
        step = scene.output_interval / STEPS_WITHOUT_LIMIT[order]
        return Choice(step, "auto: nothing limits it, so it follows the output interval", "a parabola is exact in rk4")
    step = min(SHARE_OF_LIMIT[order] * limit, scene.output_interval)
    reason = f"auto: at most 1/{round(1 / SHARE_OF_LIMIT[order])} of the limit and at most the output interval"
    return Choice(step, reason, "see error.parts.motion in the report")


def _refuse_beyond(scene: Scene, limit: float, beyond_limit: bool) -> None:
    if not beyond_limit:
        raise InputError(
            f"{scene.where('time.step')}: time.step: {scene.step:.6g} s read, but the limit of this scene is "
            f"{limit:.6g} s (2/ω_max; `rbfem plan --beyond-limit` says what swings, is damped or spins): a longer step "
            "makes an oscillation grow. Use `step: auto`, or --beyond-limit to go on regardless"
        )


def _share(step: float, limit: float) -> str:
    return "no limit applies" if np.isinf(limit) else f"{step / limit:.3g} of the limit"


def _backend(scene: Scene, models: NDArray[np.int64], step: float, n_islands: int) -> Choice:
    moving = models != FIXED
    is_pushed = pushed(scene) & moving
    steps = 1.5 * total_steps(scene, step)  # the companion run is the half
    work = Work(steps * float(np.count_nonzero(moving & ~is_pushed)), steps * float(np.count_nonzero(is_pushed)))
    seconds = {"python": work.seconds("python")}
    for kernel in ("serial", "parallel"):
        start = (NUMBA_START if clear_of_numba() else 0.0) + (0.0 if is_cached(advance, kernel) else COMPILATION)
        seconds[kernel] = start + work.seconds(kernel)
    candidates = ["python", "serial"]
    if n_islands >= 2 * BODIES_A_THREAD and (os.cpu_count() or 1) > 1:
        candidates.append("parallel")
    best = min(candidates, key=lambda name: seconds[name])
    told = ", ".join(f"{name} {seconds[name]:.2g} s" for name in candidates)
    reason = f"the quickest for {work.coasting + work.pushed:.3g} body-steps: {told}, start and compilation included"
    return Choice(best, reason, "none: one text of the physics for all", f"about {seconds[best]:.2g} s")


def _output(scene: Scene) -> Choice:
    cells = "tetrahedra" if "density" in scene.output_fields else "surface triangles"
    reason = f"{n_frames(scene)} frames every {scene.output_interval:.6g} s, {cells}, fields: " + (
        ", ".join(scene.output_fields) or "none"
    )
    return Choice(n_frames(scene), reason, "none: every output time is the end of a whole step")


def _left_out(scene: Scene, models: NDArray[np.int64]) -> tuple[str, ...]:
    left = ["contact: bodies pass through each other", "elasticity: bodies are rigid"]
    if not any("drag" in kinds for kinds in scene.load_kinds):
        left.append("the air around: no drag was asked for")
    fixed = int(np.count_nonzero(models == FIXED))
    if fixed:
        left.append(f"the motion of {fixed} fixed bod{'y' if fixed == 1 else 'ies'}")
    return tuple(left)


def _mesh_warnings(scene: Scene) -> tuple[str, ...]:
    meshes = [part.mesh for part in scene.parts if part.mesh is not None]
    return tuple(f"{mesh.source}: {said}" for mesh in meshes for said in (*mesh.repairs, *mesh.warnings))
