"""The longest stable step of every method on a scene, found by bisection, beside what theory says."""

import csv
import io
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rbfem.motion import loads as kinds
from rbfem.motion.methods import METHODS
from rbfem.motion.model import FIXED, TRANSLATING
from rbfem.motion.state import State, System, move
from rbfem.planning.applicable import applicable_methods
from rbfem.planning.frequencies import Frequencies, frequencies, step_limit
from rbfem.planning.models import choose_models
from rbfem.planning.system import build_system, starting_state
from rbfem.planning.touching import refuse_contact
from rbfem.scene.scene import Scene
from rbfem.simulation.frames import Setting, frame_of, setting_of
from rbfem.study.amplification import stable_step

Array = NDArray[np.float64]
Show = Callable[[int, int, str], None]

STEPS = 2000
LONGEST_BLOCK = 250  # steps from one look at the energy to the next; the first are shorter
GROWN = 100.0  # energy gained, times the largest energy of motion: a step of one kick stays below it up to 1.99/ω_max
DISTURBANCE = 1e-3  # of every body's radius and of a radian, at the fastest rate: what is not disturbed cannot grow
SHORTEST, LONGEST = 1 / 16, 8.0  # steps tried, times the limit of the scene and times 2/ω_max if that is longer
RESOLUTION = 1.01  # of the step found
WATCHED, WATCH_STEPS, WATCH_LOOKS = 0.1, 20, 200  # the motion as it is: its step in limits, steps a look, looks

COLUMNS = ("method", "step", "step_omega_max", "is_limit", "theory", "theory_omega_max", "order", "evaluations")


@dataclass(frozen=True)
class Limit:
    """What a method stands. step : s, the longest that was stable, zero if none was; is_limit : whether longer steps
    were unstable, else the search ended there; theory : s, see `stable_step`, infinite where it knows no limit."""

    method: str
    step: float
    is_limit: bool
    theory: float


@dataclass(frozen=True)
class Stability:
    """The limits of all methods on a scene.

    fastest  : what swings, decays and spins
    limits   : by method, in the order of the table; none where nothing limits the step
    left_out : methods that were not tried, and why
    """

    case: str
    title: str
    fastest: Frequencies
    limits: tuple[Limit, ...]
    left_out: dict[str, str]

    @property
    def rate(self) -> float:
        """rad/s by which steps are made dimensionless: ω_max, or the fastest decay or spin where nothing swings."""
        return self.fastest.oscillation or max(self.fastest.decay, self.fastest.spin)

    @property
    def damping_ratio(self) -> float:
        """ζ = β/ω_max; zero where nothing swings."""
        return self.fastest.decay / self.fastest.oscillation if self.fastest.oscillation else 0.0

    @property
    def spin_ratio(self) -> float:
        """spin/ω_max; zero where nothing swings."""
        return self.fastest.spin / self.fastest.oscillation if self.fastest.oscillation else 0.0


@dataclass(frozen=True)
class _Trial:
    """What a step is tried on: the disturbed start, the energy that counts as large, and the longest time, s."""

    setting: Setting
    start: State
    scale: float
    span: float


def measure(scene: Scene, show: Show = lambda done, total, what: None) -> Stability:
    """Bisect for the longest stable step of every method with equal steps that applies to a scene, on all cores.

    show : called with how many methods are done, of how many, and which was done last
    A step is stable if `is_stable` says so. Steps between `SHORTEST` and `LONGEST` are tried, by doubling until one is
    unstable and then by halving the logarithm; a narrow band of growth with stable steps on both sides can be stepped
    over.
    """
    refuse_contact(scene, "stability")
    models = choose_models(scene)
    system = build_system(scene, models)
    fastest = frequencies(scene, models, system.islands)
    reasons = applicable_methods(scene) | {
        name: "it finds its own steps" for name, row in METHODS.items() if row.is_adaptive
    }
    reasons["exact"] = reasons["exact"] or "it has no step"
    left_out = {name: reasons[name] for name in METHODS if reasons[name]}
    limits: dict[str, Limit] = {}
    if np.isfinite(fastest.step_limit):
        methods = [name for name in METHODS if not reasons[name]]
        trial = _trial(scene, system, fastest)
        for name, limit in _spread(trial, fastest, methods):
            limits[name] = limit
            show(len(limits), len(methods), name)
    in_order = tuple(limits[name] for name in METHODS if name in limits)
    return Stability(scene.name, scene.title, fastest, in_order, left_out)


def _spread(trial: _Trial, fastest: Frequencies, methods: list[str]) -> Iterator[tuple[str, Limit]]:
    """Limits as they are found. The kernels let go of Python's lock; they are compiled beforehand, one by one."""
    for name in methods:
        move(trial.start, 1e-3 * fastest.step_limit, 1, name, trial.setting.system, "serial")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = {pool.submit(_limit_of, trial, fastest, name): name for name in methods}
        try:
            for job in as_completed(jobs):
                yield jobs[job], job.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _limit_of(trial: _Trial, fastest: Frequencies, method: str) -> Limit:
    theory = stable_step(method, fastest.oscillation, fastest.decay)
    longest = LONGEST * max(fastest.step_limit, 2.0 / fastest.oscillation if fastest.oscillation else 0.0)
    step = longest_stable(lambda step: is_stable(trial, method, step), SHORTEST * fastest.step_limit, longest)
    return Limit(method, step, step < longest, theory)


def longest_stable(is_good: Callable[[float], bool], shortest: float, longest: float) -> float:
    """The largest good number, to `RESOLUTION`: doubling from `shortest` until one is bad, then bisection in the
    logarithm. Zero if `shortest` is bad, `longest` if none is.

    >>> round(longest_stable(lambda step: step < 3.0, 0.01, 100.0), 1)
    3.0
    >>> longest_stable(lambda step: True, 0.01, 100.0), longest_stable(lambda step: False, 0.01, 100.0)
    (100.0, 0.0)
    """
    good, bad = 0.0, shortest
    while is_good(bad):
        if bad >= longest:
            return longest
        good, bad = bad, min(2.0 * bad, longest)
    while good > 0.0 and bad > RESOLUTION * good:
        middle = float(np.sqrt(good * bad))
        good, bad = (middle, bad) if is_good(middle) else (good, middle)
    return good


def is_stable(trial: _Trial, method: str, step: float) -> bool:
    """Whether a disturbance of the scene does not grow in `STEPS` steps.

    Unstable is a run whose energy (kinetic, elastic, of the weight) comes to exceed that at the start by more than what
    the given loads brought in plus `GROWN` times the largest energy of motion that the scene has when it is computed
    finely, or that is no longer finite. Energy that is lost is not counted: a method that damps is stable. A scene with
    given forces or torques is not watched beyond its own end.
    """
    state, done = trial.start, 0
    n_steps = int(min(STEPS, np.ceil(trial.span / step)))
    before, _ = _energies(trial, state)
    with np.errstate(all="ignore"):  # what grows may pass all numbers
        while done < n_steps:
            block = min(max(done, 1), LONGEST_BLOCK, n_steps - done)
            state = move(state, step, block, method, trial.setting.system, "serial")
            done += block
            energy, work = _energies(trial, state)
            if not energy - before <= max(0.0, work) + GROWN * trial.scale:
                return False
    return True


def _trial(scene: Scene, system: System, fastest: Frequencies) -> _Trial:
    start = _disturbed(scene, system, 2.0 / fastest.step_limit)
    span = scene.end_time if _is_driven(scene) else np.inf
    quiet = _Trial(setting_of(scene, system), start, 0.0, span)
    return replace(quiet, scale=_largest_energy_of_motion(quiet, WATCHED * fastest.step_limit))


def _is_driven(scene: Scene) -> bool:
    return bool(np.isin(scene.loads.kind, (kinds.FORCE, kinds.COUPLE, kinds.WRENCH)).any())


def _disturbed(scene: Scene, system: System, rate: float) -> State:
    """The start of a scene with a small velocity and spin added to every body that can have them."""
    state, bodies = starting_state(scene), system.bodies
    directions = np.random.default_rng(0).normal(size=(2, scene.n_bodies, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    speed = DISTURBANCE * rate * scene.bounding_radius * (bodies.inverse_mass > 0.0)
    spin = DISTURBANCE * rate * (bodies.model > TRANSLATING)
    momentum = spin[:, None] * directions[1] / bodies.inverse_moments
    return replace(
        state,
        velocity=state.velocity + speed[:, None] * directions[0] * (bodies.model != FIXED)[:, None],
        angular_momentum=state.angular_momentum + momentum,
    )


def _largest_energy_of_motion(trial: _Trial, step: float) -> float:
    """Kinetic energy at its largest, J, by the most exact method with equal steps."""
    state, largest = trial.start, 0.0
    for _ in range(WATCH_LOOKS):
        balance = frame_of(trial.setting, state, 0).balance
        largest = max(largest, balance.kinetic + balance.rotational)
        state = move(state, step, WATCH_STEPS, "dop853_fixed", trial.setting.system, "serial")
        if state.time > trial.span:
            break
    return largest


def _energies(trial: _Trial, state: State) -> tuple[float, float]:
    """Energy of a state, and the work done on it since the start, J."""
    balance = frame_of(trial.setting, state, 0).balance
    return balance.kinetic + balance.rotational + balance.gravity + balance.elastic, balance.work


def as_csv(study: Stability) -> str:
    """One row a method; `theory` is that of the swing and its damping alone, `inf` where it knows no limit."""
    lines = io.StringIO()
    table = csv.writer(lines, lineterminator="\n")
    table.writerow(COLUMNS)
    for limit in study.limits:
        row = METHODS[limit.method]
        steps = [limit.step, limit.step * study.rate, limit.is_limit, limit.theory, limit.theory * study.rate]
        table.writerow([limit.method, *steps, row.order, row.evaluations])
    return lines.getvalue()


def notes(study: Stability) -> Iterator[str]:
    """What to know when reading the table."""
    fastest = study.fastest
    parts = {
        f"swings at up to ω_max = {fastest.oscillation:.4g} rad/s": fastest.oscillation,
        f"is damped at up to β = {fastest.decay:.4g} 1/s (ζ = {study.damping_ratio:.3g})": fastest.decay,
        f"spins at up to {fastest.spin:.4g} rad/s": fastest.spin,
    }
    found = ", ".join(words for words, rate in parts.items() if rate)
    exact, others = (step_limit(fastest, METHODS[name]) for name in ("kdk", "rk4"))
    yield (
        f"the scene {found}; a plan keeps below {others.seconds:.4g} s ({others.rule}), and with methods that turn "
        f"bodies exactly below {_words(exact.seconds, 1.0, '')[0]} ({exact.rule})"
    )
    yield (
        f"stable means that a disturbance does not grow in {STEPS} steps; whether the motion is right is for the chart "
        "to say. The theory is that of the swing and its damping alone, without spin"
    )
    nowhere = [limit.method for limit in study.limits if not limit.step]
    if nowhere:
        yield f"stable at no step that was tried, down to {SHORTEST * fastest.step_limit:.3g} s: {', '.join(nowhere)}"
    for method, reason in study.left_out.items():
        yield f"{method} was not tried: {reason}"


def table(study: Stability) -> Iterator[str]:
    """A line for each method: its longest stable step and that of theory, in s and times `Stability.rate`."""
    rate = "ω_max" if study.fastest.oscillation else "rate"
    yield f"  {'method':<20}{'longest stable step':>21}{'times ' + rate:>13}{'theory':>14}{'times ' + rate:>13}"
    for limit in study.limits:
        measured = _words(limit.step, study.rate, "" if limit.is_limit else "≥ ")
        theory = _words(limit.theory, study.rate, "")
        yield f"  {limit.method:<20}{measured[0]:>21}{measured[1]:>13}{theory[0]:>14}{theory[1]:>13}"


def _words(step: float, rate: float, sign: str) -> tuple[str, str]:
    """A step in seconds and times a rate.

    >>> _words(0.25, 8.0, "≥ "), _words(0.0, 8.0, ""), _words(np.inf, 8.0, "")
    (('≥ 0.25 s', '≥ 2.00'), ('none', ''), ('no limit', ''))
    """
    if not 0.0 < step < np.inf:
        return ("none" if step == 0.0 else "no limit"), ""
    return f"{sign}{step:.4g} s", f"{sign}{step * rate:.2f}"
