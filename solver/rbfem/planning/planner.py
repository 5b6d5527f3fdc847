"""From a Scene to a Plan: the rules of choice."""

import difflib
import math
import os
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import clear_of_numba, is_cached
from rbfem.contact.model import LAW, LAW_NAMES, NONE
from rbfem.errors import InputError
from rbfem.motion.methods import METHODS, Method
from rbfem.motion.model import FIXED
from rbfem.planning.applicable import applicable_methods, character, is_damped, is_weakly_turned, moved_by_loads
from rbfem.planning.frequencies import Frequencies, StepLimit, frequencies, step_limit
from rbfem.planning.models import choose_models, model_choices, pushed
from rbfem.planning.pilot import Finding, Settled, Stretch, error_scale, order_of, run_pilot, sample
from rbfem.planning.plan import Choice, Plan
from rbfem.planning.system import build_system, starting_state
from rbfem.planning.timeline import longest_step, n_frames, stops, total_steps
from rbfem.planning.touching import kernel_for, quickest, restitution_error, step_for
from rbfem.scene.scene import Scene

# What the pilot tries: the methods that came out best on charts of smooth motion, by loads and error accepted.
COARSE_ACCURACY = 2e-5
CANDIDATES = {"coarse": ("aba864", "rkn4", "kdk"), "fine": ("rkn6", "dop853_fixed")}
WEAKLY_TURNED_CANDIDATES = {"coarse": ("aba864", "rkn4", "kdk"), "fine": ("rkn6", "aba864", "dop853_fixed")}
DAMPED_CANDIDATES = {"coarse": ("dop853_fixed", "rk4"), "fine": ("dop853_fixed",)}
STEP_GIVEN, DAMPED_STEP_GIVEN = "rkn4", "dop853_fixed"
CONTACT_METHOD = "kdk"
OVERDAMPED, STIFF_DECAY = 10.0, 1e4  # times the swing; and decay times the duration of the run

# Seconds of an evaluation, a free flight and a start, for choosing the backend (docs/motion.md has the measurement).
PYTHON_EVALUATION, PYTHON_STEP, PYTHON_FLIGHT = 100e-6, 10e-6, 60e-6
KERNEL_EVALUATION, KERNEL_STEP, KERNEL_FLIGHT = 200e-9, 60e-9, 400e-9
NUMBA_START, COMPILATION, PARALLEL_START = 1.0, 15.0, 1.0
BODIES_A_THREAD = 2000
MOST_FRAMES, MOST_STEPS = 1e6, 1e13
SAFE_SHARE = 0.8  # of the limit: a longer step that is given is warned of
CUT_SHARE = 0.8  # of the step: a plan says so if the outputs leave less


@dataclass(frozen=True)
class Work:
    """Steps of bodies that coast, evaluations of bodies that are pushed, and flights that need no steps."""

    coasting: float
    evaluations: float
    flights: float

    def seconds(self, backend: str) -> float:
        if backend == "python":
            return self.coasting * PYTHON_STEP + self.evaluations * PYTHON_EVALUATION + self.flights * PYTHON_FLIGHT
        kernel = self.coasting * KERNEL_STEP + self.evaluations * KERNEL_EVALUATION + self.flights * KERNEL_FLIGHT
        return kernel if backend == "serial" else kernel / (os.cpu_count() or 1) + PARALLEL_START


@dataclass(frozen=True)
class _Stepping:
    """How the motion goes on: the choices that hang together."""

    method: Choice
    step: Choice
    tolerance: Choice
    order: float
    pilot: Choice
    verify: Choice
    redo: bool


def plan(scene: Scene, beyond_limit: bool = False) -> Plan:
    """Choose what to compute for a scene. Where loads act and no step is given, a pilot runs a short part of it.

    beyond_limit : go on where the step asked for is beyond the stability limit
    Raises InputError for a method that does not exist or does not apply, and for a step beyond the limit.
    """
    _refuse_endless("output.every", scene.end_time / scene.output_interval, MOST_FRAMES, "frames")
    models = choose_models(scene)
    system = build_system(scene, models)
    fastest = frequencies(scene, models, system.islands)
    if scene.method is not None:
        _check_method(scene)
    if scene.can_touch.any():
        stepping = _in_contact(scene, fastest, beyond_limit)
    elif scene.method == "exact" or (scene.method is None and not moved_by_loads(scene)):
        stepping = _in_one_piece(scene, fastest)
    elif scene.step is not None:
        stepping = _by_given_step(scene, fastest, beyond_limit)
    else:
        stepping = _by_accuracy(scene, models, system, fastest)
    method = str(stepping.method.value)
    limit = step_limit(fastest, METHODS[method])
    in_contact = scene.can_touch.any()
    stepping_limit = _contact_limit(scene, fastest) if in_contact else _limit_choice(fastest, limit, method)
    return Plan(
        case=scene.name,
        n_bodies=scene.n_bodies,
        models=model_choices(scene, models),
        contact=_contact(scene),
        method=stepping.method,
        step=stepping.step,
        step_limit=stepping_limit,
        tolerance=stepping.tolerance,
        order=stepping.order,
        pilot=stepping.pilot,
        verify=stepping.verify,
        redo=stepping.redo,
        backend=_backend(scene, models, _work(scene, models, stepping), method),
        output=_output(scene),
        accuracy=scene.accuracy,
        left_out=_left_out(scene, models),
        warnings=(*_mesh_warnings(scene), *_step_warnings(scene, stepping, limit)),
    )


def _in_one_piece(scene: Scene, fastest: Frequencies) -> _Stepping:
    """Bodies that nothing but a uniform field moves: no step, and no error of one."""
    reason = (
        "asked for" if scene.method else f"auto: {character(scene, fastest)}, and the motion is known in closed form"
    )
    if scene.step is not None:
        reason += "; the step that is given is not needed"
    no_step = "every output time is reached in one piece"
    return _Stepping(
        method=Choice("exact", reason, "rounding alone", "one evaluation of the closed form a body and output time"),
        step=Choice(None, no_step),
        tolerance=Choice(None, "the method has none"),
        order=0.0,
        pilot=Choice(0, "nothing had to be tried"),
        verify=Choice(0, "no step, so no error of a step: the rounding is predicted"),
        redo=False,
    )


def _in_contact(scene: Scene, fastest: Frequencies, beyond_limit: bool) -> _Stepping:
    """Spheres that touch: equal steps of `kdk`, a share of the shortest contact."""
    if scene.method not in (None, CONTACT_METHOD):
        raise InputError(f"{scene.where('time.method')}: bodies in contact move by {CONTACT_METHOD}; leave it out")
    contact, limit = quickest(scene), _contact_limit(scene, fastest)
    if scene.step is None:
        step = min(step_for(scene.accuracy, contact), 0.5 * limit.value)
        reason = f"1/{contact.duration / step:.3g} of the shortest contact, {contact.duration:.3g} s"
    else:
        step = scene.step
        if step > limit.value:
            _refuse_beyond(scene, limit, CONTACT_METHOD, beyond_limit)
        reason = f"asked for; 1/{contact.duration / step:.3g} of the shortest contact, {contact.duration:.3g} s"
    error = restitution_error(step, contact)
    return _Stepping(
        method=Choice(
            CONTACT_METHOD,
            "bodies touch: a force with a kink leaves no more than order two to any method, and this one needs one "
            "evaluation a step and keeps the energy of elastic contacts",
            "order 2",
            "one evaluation of the contacts a step",
        ),
        step=Choice(step, f"{reason}, {step / limit.value:.3g} of the limit", f"of the restitution: about {error:.2g}"),
        tolerance=Choice(None, "the method has none"),
        order=0.0,
        pilot=Choice(0, "nothing had to be tried"),
        verify=Choice(0, "where bodies touch, neighbouring motions part: a companion would tell nothing"),
        redo=False,
    )


def _contact_limit(scene: Scene, fastest: Frequencies) -> Choice:
    """The shorter of what the contacts and what the other bodies of the scene allow."""
    contact, others = quickest(scene), step_limit(fastest, METHODS[CONTACT_METHOD])
    if others.seconds < contact.limit:
        return _limit_choice(fastest, others, CONTACT_METHOD)
    return Choice(
        contact.limit,
        f"2/ω of a sphere between twelve others that move against it; contacts last {contact.duration:.3g} s at least, "
        f"at the {contact.speed:.3g} m/s that are expected at most",
    )


def _contact(scene: Scene) -> Choice:
    count = int(np.count_nonzero(scene.can_touch))
    if not count:
        return Choice("none", "no rule of `contacts` fits two materials of the scene: bodies pass through each other")
    used = sorted({int(law) for law in scene.laws[:, LAW] if law != NONE})
    laws = " and ".join(LAW_NAMES[law] for law in used)
    walls = (
        f" and {len(scene.walls.names)} plane{'s' if len(scene.walls.names) > 1 else ''}" if scene.walls.names else ""
    )
    return Choice(
        laws,
        f"{count} sphere{'s' if count > 1 else ''}{walls}; Coulomb friction; a contact does not pull, and its "
        "damping is chosen so that the restitution is the one asked for all the same",
    )


def _by_given_step(scene: Scene, fastest: Frequencies, beyond_limit: bool) -> _Stepping:
    damped = is_damped(scene)
    name = scene.method or (DAMPED_STEP_GIVEN if damped else STEP_GIVEN)
    row = METHODS[name]
    if row.is_adaptive:
        raise InputError(
            f"{scene.where('time.step')}: method {name} finds its own steps from `accuracy`; leave the step "
            "out, or take dop853_fixed"
        )
    order = row.damped_order if damped else row.order
    return _Stepping(
        method=_named(
            name,
            "asked for" if scene.method else f"auto, for the step that is given: {character(scene, fastest)}",
            order,
        ),
        step=_given_step(scene, fastest, name, beyond_limit),
        tolerance=Choice(None, "the steps are equal"),
        order=order,
        pilot=Choice(0, "the step is given: nothing was tried"),
        verify=_check(row),
        redo=False,
    )


def _by_accuracy(scene: Scene, models: NDArray[np.int64], system, fastest: Frequencies) -> _Stepping:
    """A cheap method and its step for the accuracy, by a pilot."""
    names = (scene.method,) if scene.method else _candidates(scene, fastest)
    settled = _pilot(scene, models, system, fastest, names)
    best = settled.best
    row = METHODS[best.method]
    order = best.order if math.isfinite(best.order) else order_of(best.method, system)
    found = ", ".join(_expected(finding, best) for finding in settled.findings)
    reason = "asked for" if scene.method else f"auto: {character(scene, fastest)}"
    knob = best.step if math.isfinite(best.step) else scene.accuracy
    told, held = f"auto: for an error of {scene.accuracy:g} over the whole run, by the pilot", "held against the check"
    if row.is_adaptive:
        first_step = min(0.1 * step_limit(fastest, row).seconds, scene.end_time)
        tolerance = Choice(knob, told, held)
        step = Choice(first_step, "the first that is tried; the method finds its own")
    else:
        tolerance = Choice(None, "the steps are equal")
        step = Choice(knob, told + _cut(scene, knob), held)
    return _Stepping(
        method=_named(best.method, f"{reason}; expected evaluations of the loads in the run: {found}", order),
        step=step,
        tolerance=tolerance,
        order=order,
        pilot=Choice(
            settled.evaluations,
            f"a short trial run, the first {settled.span:.3g} s by each candidate with ever shorter steps, told which "
            "method and step the whole run needs",
        ),
        verify=_check(row),
        redo=True,
    )


def _expected(finding: Finding, best: Finding) -> str:
    """A method with the evaluations of the loads that a run by it would take, as far as the pilot went into it."""
    if finding.cost < math.inf:
        return f"{finding.method} {finding.cost:.0f}"
    if finding is best or (finding.spent and math.isnan(finding.step)):
        return f"{finding.method} does not get there"
    return f"{finding.method} more than {best.cost:.0f}"


def _cut(scene: Scene, step: float) -> str:
    """What the stops of the run leave of a step, if that is clearly less."""
    taken = longest_step(scene, step)
    if taken >= CUT_SHARE * step:
        return ""
    has_others = len(stops(scene)) >= n_frames(scene)
    what = "the outputs, ramps and times of `expect`" if has_others else "the outputs"
    return f"; {what} cut it to {taken:.3g} s: fewer outputs (`output.every`) would be cheaper"


def _candidates(scene: Scene, fastest: Frequencies) -> tuple[str, ...]:
    kind = "coarse" if scene.accuracy > COARSE_ACCURACY else "fine"
    if _is_overdamped(scene, fastest):
        return ("kdk",)  # its dampers are implicit: stable at any step
    if is_damped(scene):
        return DAMPED_CANDIDATES[kind]
    return (WEAKLY_TURNED_CANDIDATES if is_weakly_turned(fastest) else CANDIDATES)[kind]


def _is_overdamped(scene: Scene, fastest: Frequencies) -> bool:
    """Whether explicit steps would have to follow a decay that is over in a moment."""
    return fastest.decay > OVERDAMPED * fastest.oscillation and fastest.decay * scene.end_time > STIFF_DECAY


def _pilot(scene: Scene, models: NDArray[np.int64], system, fastest: Frequencies, names: tuple[str, ...]) -> Settled:
    swing = fastest.oscillation if _is_overdamped(scene, fastest) else max(fastest.oscillation, fastest.decay)
    spin = float(np.linalg.norm(scene.angular_velocity, axis=1).max(initial=0.0))
    rate = max(swing, spin, 1.0 / scene.end_time)
    system, start, radius = sample(system, starting_state(scene), scene.bounding_radius)
    stretch = Stretch(
        system=system,
        start=start,
        end=scene.end_time,
        rate=rate,
        swing=swing,
        accuracy=scene.accuracy,
        radius=radius,
        scale=error_scale(system, radius, rate),
        times=np.array([0.0, *(stop.time for stop in stops(scene))]),
        backend="python",
    )
    members = len(system.islands.member)
    work = Work(0.0, sum(stretch.expected_evaluations(name) for name in names) * members, 0.0)
    return run_pilot(replace(stretch, backend=str(_backend(scene, models, work, names[0]).value)), names)


def _n_moving(models: NDArray[np.int64]) -> int:
    return int(np.count_nonzero(models != FIXED))


def _check(row: Method) -> Choice:
    if row.is_adaptive:
        return Choice(2, "a second run, at a hundred times the tolerance, tells the error of this one")
    return Choice(2, "a second run, with steps twice as long, tells the error of this one", cost="half as much again")


def _refuse_endless(key: str, count: float, most: float, what: str) -> None:
    if not count <= most:
        raise InputError(
            f"{key}: the run would take {count:.3g} {what}, and {most:.0e} are the most; nobody would see its end"
        )


def _check_method(scene: Scene) -> None:
    where = scene.where("time.method")
    if scene.method not in METHODS:
        near = difflib.get_close_matches(str(scene.method), METHODS, n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise InputError(f"{where}: no method '{scene.method}'{hint} (known: {', '.join(METHODS)})")
    if METHODS[scene.method].needs_free_bodies and moved_by_loads(scene):
        raise InputError(f"{where}: '{scene.method}' does not apply: {applicable_methods(scene)[scene.method]}")


def _named(name: str, reason: str, order: float) -> Choice:
    row = METHODS[name]
    grows = "" if row.oscillation_limit else "; an oscillation gains energy at every step size"
    evaluations = f"{row.evaluations} evaluation{'s' if row.evaluations > 1 else ''} of the loads a step"
    return Choice(name, reason, f"order {order:.3g}{grows}", evaluations)


def _limit_choice(fastest: Frequencies, limit: StepLimit, method: str) -> Choice:
    parts = {
        f"springs, weights and fields swing at up to ω = {fastest.oscillation:.4g} rad/s": fastest.oscillation,
        f"dampers decay at up to β = {fastest.decay:.4g} 1/s": fastest.decay,
        f"bodies spin at up to {fastest.spin:.4g} rad/s": fastest.spin,
    }
    reason = ", ".join(words for words, rate in parts.items() if rate) or "nothing swings, is damped or spins"
    if METHODS[method].turns_exactly and fastest.spin:
        reason += f"; {method} turns bodies exactly, a spin does not limit it"
    return Choice(None, reason) if np.isinf(limit.seconds) else Choice(limit.seconds, f"{limit.rule}: {reason}")


def _given_step(scene: Scene, fastest: Frequencies, method: str, beyond_limit: bool) -> Choice:
    assert scene.step is not None
    limit = step_limit(fastest, METHODS[method])
    _refuse_endless("time.step", scene.end_time / scene.step, MOST_STEPS, "steps")
    if scene.step > limit.seconds:
        _refuse_beyond(scene, _limit_choice(fastest, limit, method), method, beyond_limit)
        told = f"asked for, and beyond the limit of {limit.seconds:.6g} s on purpose"
        return Choice(scene.step, told + _cut(scene, scene.step), "may grow without bound")
    told = f"asked for; {_share(scene.step, limit.seconds)}"
    return Choice(scene.step, told + _cut(scene, scene.step), "see error.parts.motion in the report")


def _refuse_beyond(scene: Scene, limit: Choice, method: str, beyond_limit: bool) -> None:
    if beyond_limit:
        return
    harm, advice = "makes an oscillation grow", ""
    if limit.reason.startswith("2/spin"):
        harm = "loses the turning of a body"
        advice = ", a method that turns bodies exactly and is not limited by a spin (kdk, rkn4, rkn6, aba864)"
    raise InputError(
        f"{scene.where('time.step')}: {scene.step:.6g} s read, but the limit of this scene is "
        f"{limit.value:.6g} s with {method} ({limit.reason}): a longer step {harm}. Use a shorter step or "
        f"`step: auto`{advice}, or --beyond-limit to go on regardless"
    )


def _share(step: float, limit: float) -> str:
    return "no limit applies" if np.isinf(limit) else f"{step / limit:.3g} of the limit"


def _work(scene: Scene, models: NDArray[np.int64], stepping: _Stepping) -> Work:
    """What the run and its companion will compute."""
    row, moving = METHODS[str(stepping.method.value)], models != FIXED
    if scene.can_touch.any():
        spheres = np.count_nonzero(scene.can_touch)
        return Work(0.0, float(total_steps(scene, stepping.step.value) * spheres), 0.0)
    n_pushed = int(np.count_nonzero(pushed(scene) & moving))
    n_coasting = int(np.count_nonzero(moving)) - n_pushed
    steps = float(total_steps(scene, stepping.step.value))
    ratio = int(stepping.verify.value)
    steps *= 1.0 + (1.0 / ratio if ratio else 0.0)
    if row.flies_exactly:
        return Work(0.0, steps * n_pushed * row.evaluations, float(len(stops(scene)) * n_coasting))
    return Work(steps * n_coasting * max(1.0, row.evaluations / 4.0), steps * n_pushed * row.evaluations, 0.0)


def _backend(scene: Scene, models: NDArray[np.int64], work: Work, method: str) -> Choice:
    seconds = {"python": work.seconds("python")}
    for kernel in ("serial", "parallel"):
        compiled = is_cached(kernel_for(scene, method), kernel)
        start = (NUMBA_START if clear_of_numba() else 0.0) + (0.0 if compiled else COMPILATION)
        seconds[kernel] = start + work.seconds(kernel)
    candidates = ["python", "serial"]
    if _n_moving(models) >= 2 * BODIES_A_THREAD and (os.cpu_count() or 1) > 1 and not scene.can_touch.any():
        candidates.append("parallel")
    best = min(candidates, key=lambda name: seconds[name])
    told = ", ".join(f"{name} {seconds[name]:.2g} s" for name in candidates)
    parts = {"steps of coasting bodies": work.coasting, "evaluations": work.evaluations, "free flights": work.flights}
    amount = " and ".join(f"{count:.3g} {what}" for what, count in parts.items() if count) or "no work at all"
    reason = f"the quickest for {amount}: {told}, start and compilation included"
    return Choice(best, reason, "none: one text of the physics for all", f"about {seconds[best]:.2g} s")


def _output(scene: Scene) -> Choice:
    cells = "tetrahedra" if "density" in scene.output_fields else "surface triangles"
    reason = f"{n_frames(scene)} frames every {scene.output_interval:.6g} s, {cells}, fields: " + (
        ", ".join(scene.output_fields) or "none"
    )
    return Choice(n_frames(scene), reason, "none: every output time is the end of a whole step")


def _left_out(scene: Scene, models: NDArray[np.int64]) -> tuple[str, ...]:
    left = ["elasticity: bodies are rigid"]
    if not scene.can_touch.all():
        but = ", but for spheres whose materials meet" if scene.can_touch.any() else ""
        left.insert(0, f"contact: bodies pass through each other{but}")
    if not any("drag" in kinds for kinds in scene.load_kinds):
        left.append("the air around: no drag was asked for")
    fixed = int(np.count_nonzero(models == FIXED))
    if fixed:
        left.append(f"the motion of {fixed} fixed bod{'y' if fixed == 1 else 'ies'}")
    return tuple(left)


def _mesh_warnings(scene: Scene) -> tuple[str, ...]:
    meshes = [part.mesh for part in scene.parts if part.mesh is not None]
    return tuple(f"{mesh.source}: {said}" for mesh in meshes for said in (*mesh.repairs, *mesh.warnings))


def _step_warnings(scene: Scene, stepping: _Stepping, limit: StepLimit) -> tuple[str, ...]:
    if scene.step is None or stepping.step.value is None:
        return ()
    share = longest_step(scene, scene.step) / limit.seconds
    if not SAFE_SHARE < share <= 1.0:
        return ()
    return (
        f"the step that is given is {share:.3g} of its limit, which holds for small oscillations: other motion may be "
        "unstable before; `rbfem stability CASE` finds out where",
    )
