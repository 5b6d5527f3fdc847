"""The only time loop: a run is an iterator of frames that knows, when it is through, its error, cost and balance."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbfem.compute.loops import is_cached
from rbfem.errors import InputError, RunError
from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.motion.model import TRANSLATING
from rbfem.motion.rotor import PANEL
from rbfem.motion.state import State, System, kernel_of, move, move_to_tolerance
from rbfem.planning.models import models_of
from rbfem.planning.pilot import error_scale
from rbfem.planning.plan import Plan
from rbfem.planning.system import build_system, starting_state
from rbfem.planning.timeline import Stop, nearness, steps_between, stops, total_steps, with_looks
from rbfem.scene.scene import Scene
from rbfem.simulation.expectations import ExpectationResult, check_expectation
from rbfem.simulation.frame import Frame
from rbfem.simulation.frames import Setting, frame_of, setting_of
from rbfem.simulation.motion_error import COMPANION_TOLERANCE, MotionError
from rbfem.simulation.touching import Touching

# Body-steps of one call of the stepper, so that the loop looks up often enough for Ctrl-C and the clock.
BODY_STEPS_A_CALL = {"python": 3e3, "serial": 3e6, "parallel": 6e6}
LEAST_STEPS_A_CALL = 10  # fewer would leave most of the time to the copies that a call begins and ends with
NORM_DRIFT = 1e-6  # |q| this far from one: the method has lost the rotation
LARGEST = 1e50  # a state beyond has blown up; below, its energies and their squares still fit a float

# How a run is done again: how often at most; from how many times the accuracy on an error foretold is an alarm, by what
# power of time at most it is taken to grow, and after what share of the run that power is looked for; how much finer it
# gets at once; and the share of the accuracy that may be rounding.
MOST_REDOS, ALARM, LARGEST_GROWTH, LOOK_AHEAD = 8, 3.0, 6.0, 1 / 8
LEAST_REFINEMENT, LARGEST_REFINEMENT, BLOWN_UP_REFINEMENT = 1.2, 8.0, 2.0
ROUNDING_SHARE = 0.3
# No attempt follows once so many times the evaluations planned are spent, or times that number if fewer were planned:
# where that has not helped, errors grow faster than steps can follow.
MOST_TIMES, LEAST_PLANNED = 50.0, 2e4
PATIENCE = 1.0  # s of interpreted steps, as long as it takes to start the compiler's library
EPS = 2.3e-16
FINEST_TOLERANCE = 1e-15  # of an adaptive method: below, it only chases roundings
LEAST_STOPS, STEPS_BETWEEN = 8, 16  # so often at least the error is looked at, if that many steps lie between

Array = NDArray[np.float64]
Models = NDArray[np.int64]


@dataclass(frozen=True)
class _Knob:
    """What an attempt is run with: the longest step, and the tolerance of an adaptive method."""

    step: Any
    tolerance: float | None

    def finer(self, factor: float, order: float) -> _Knob:
        """The steps divided by a factor, or the tolerance by what the error then falls."""
        if self.tolerance is not None:
            return replace(self, tolerance=max(FINEST_TOLERANCE, self.tolerance / factor**order))
        return replace(self, step=self.step / factor)


@dataclass
class _Course:
    """What the attempts of a run share.

    shown  : stops whose frames are given
    errors : of the attempt that is under way, at every stop so far
    """

    stops: list[Stop]
    errors: Array
    shown: int = 0


@dataclass
class Cost:
    """What a run has cost so far. steps: of the stepper, companion included; evaluations: of the loads of one body."""

    wall_seconds: float = 0.0
    steps: int = 0
    evaluations: int = 0
    body_steps: int = 0


@dataclass
class Run:
    """Iterate over it for its frames; `error`, `cost`, `largest_drift`, `expectations`, `warnings` fill meanwhile."""

    scene: Scene
    plan: Plan
    error: MotionError
    cost: Cost = field(default_factory=Cost)
    warnings: list[str] = field(default_factory=list)
    expectations: list[ExpectationResult] = field(default_factory=list)
    first: Frame | None = None
    last: Frame | None = None
    largest_drift: dict[str, float] = field(default_factory=dict)
    tell: Callable[[str], None] = lambda words: None
    is_finest: bool = False
    planned: float = math.inf
    ended_early: str = ""

    def __iter__(self) -> Iterator[Frame]:
        if self.first is not None:
            raise RunError("a run goes through its frames once; simulate(scene, plan) makes another")
        models = models_of(self.plan.models, self.scene.n_bodies)
        system = build_system(self.scene, models)
        setting, start = setting_of(self.scene, system), starting_state(self.scene)
        if self.scene.can_touch.any():
            yield from self._in_contact(setting, start)
            return
        frame = self._look(frame_of(setting, start, 0))
        self._expect(frame)
        yield frame
        knob = _Knob(self.plan.step.value, self.plan.tolerance.value)
        ends = stops(self.scene)
        if self._may_redo:
            ends = with_looks(ends, knob.step, LEAST_STOPS, STEPS_BETWEEN)
        course = _Course(ends, np.zeros(len(ends)))
        while True:
            finer = yield from self._attempt(setting, models, start, knob, course)
            if finer == 1.0:
                return
            knob = knob.finer(finer, self.error.order)
            self.is_finest = knob.tolerance == FINEST_TOLERANCE
            self.tell(
                f"begun again, {finer:.3g} times finer: the error would come to more than {self.scene.accuracy:g}"
            )
            self.error = MotionError(self.error.order, before=self.error.before, redone=self.error.redone + 1)

    def _in_contact(self, setting: Setting, start: State) -> Iterator[Frame]:
        """The frames of a scene whose spheres touch; the other bodies move by themselves."""
        step, backend = float(self.plan.step.value), str(self.plan.backend.value)
        touching = Touching(self.scene, start, backend)
        state, index = start, 0
        frame = frame_of(setting, state, index, touching.balance)
        for stop in [None, *stops(self.scene)]:
            if stop is not None:
                began = time.perf_counter()
                n_steps = steps_between(state.time, stop.time, step)
                dt = (stop.time - state.time) / n_steps
                touching.advance(state.time, dt, n_steps)
                state = touching.placed_in(self._move(state, dt, n_steps, stop, setting.system))
                self._check_state(state)
                self.cost.body_steps += n_steps * len(touching.members)
                self.cost.wall_seconds += time.perf_counter() - began
                index += stop.is_output
                frame = frame_of(setting, state, index, touching.balance)
            self._look(frame)
            self._expect(frame)
            if stop is None or stop.is_output:
                yield frame

    @property
    def unmet(self) -> str:
        """Why the accuracy was not reached although the step was left to the program; empty where it was."""
        if self.ended_early:
            return self.ended_early
        if not self.plan.redo or not self.plan.verify.value:
            return ""
        if self.error.estimated is None:
            return self.error.unknown_because
        if self.error.estimated <= self.scene.accuracy:
            return ""
        if self.error.rounding > ROUNDING_SHARE * self.scene.accuracy:
            return "rounding alone comes to that, and shorter steps would only add to it"
        return (
            f"{self.error.redone} finer runs have not brought it down far enough: errors grow too fast in this motion"
        )

    def _attempt(
        self, setting: Setting, models: Models, start: State, knob: _Knob, course: _Course
    ) -> Generator[Frame, None, float]:
        """Run from the start; give the frames that no attempt has given yet while the error is the one accepted.

        returns : how much finer to begin again, 1 at the end of the run
        """
        state, companion = start, start if self.plan.verify.value else None
        index = 0
        for k, stop in enumerate(course.stops):
            began = time.perf_counter()
            state, companion = self._to_stop(state, companion, stop, knob, setting.system)
            has_lost_it = bool(self.plan.verify.value) and companion is None
            if self._may_redo and (has_lost_it or len(_blown_up(state))):
                return BLOWN_UP_REFINEMENT
            self._check_state(state)
            self.cost.wall_seconds += time.perf_counter() - began
            index += stop.is_output
            frame = frame_of(setting, state, index)
            self._estimate(frame, state, companion, setting, models)
            finer = self._refinement(stop, k, course)
            if finer > 1.0:
                return finer
            if k < course.shown:
                continue
            self.error.before = self.error.estimated or 0.0
            course.shown = k + 1
            self._look(frame)
            self._watch_spin(frame, models)
            self._expect(frame)
            if stop.is_output:
                yield frame
        return 1.0

    def _to_stop(self, state: State, companion: State | None, stop: Stop, knob: _Knob, system: System):
        """The run and its companion at a stop; the companion is None once it has blown up and tells nothing more."""
        if knob.tolerance is not None:
            state = self._move_adaptively(state, stop, knob.step, knob.tolerance, system)
            if companion is not None:
                self.error.ratio = 0.0
                tolerance = COMPANION_TOLERANCE * knob.tolerance
                companion = self._checked(self._move_adaptively(companion, stop, knob.step, tolerance, system))
            return state, companion
        n_steps = steps_between(state.time, stop.time, knob.step)
        begin = state.time
        state = self._move(state, (stop.time - begin) / n_steps, n_steps, stop, system)
        if companion is not None:
            fewer = -(-n_steps // int(self.plan.verify.value))
            self.error.ratio = min(self.error.ratio, n_steps / fewer)
            companion = self._checked(self._move(companion, (stop.time - begin) / fewer, fewer, stop, system))
        return state, companion

    def _move(self, state: State, dt: float, n_steps: int, stop: Stop, system: System) -> State:
        """To a stop, in calls short enough to be interrupted; the time is then the stop's own to the last digit."""
        method, backend = str(self.plan.method.value), self._backend()
        at_once, before = steps_a_call(self.scene.n_bodies, backend), state.evaluations
        with np.errstate(all="ignore"):  # what has blown up is told in words, by the caller
            for done in range(0, n_steps, at_once):
                state = move(state, dt, min(at_once, n_steps - done), method, system, backend)
        self._count(n_steps, state.evaluations - before, system)
        return replace(state, time=stop.time)

    def _move_adaptively(self, state: State, stop: Stop, step: float, tolerance: float, system: System) -> State:
        method, backend, before = str(self.plan.method.value), self._backend(), state.evaluations
        scale = error_scale(system, self.scene.bounding_radius, 0.1 / step)
        with np.errstate(all="ignore"):
            state = move_to_tolerance(state, stop.time - state.time, step, tolerance, scale, method, system, backend)
        evaluations = state.evaluations - before
        self._count(evaluations // METHODS[method].evaluations, evaluations, system)
        return replace(state, time=stop.time)

    def _backend(self) -> str:
        """That of the plan; a run that was begun again and has become long changes to kernels that lie ready."""
        planned, kernel = str(self.plan.backend.value), kernel_of(str(self.plan.method.value))
        if planned != "python" or not self.error.redone or self.cost.wall_seconds < PATIENCE:
            return planned
        return "serial" if is_cached(kernel, "serial") else planned

    def _count(self, n_steps: int, evaluations: int, system: System) -> None:
        self.cost.steps += n_steps
        self.cost.body_steps += n_steps * len(system.islands.member)
        self.cost.evaluations += evaluations

    def _checked(self, companion: State) -> State | None:
        """The companion, or None if it has blown up."""
        if len(_blown_up(companion)) == 0:
            return companion
        if self._may_redo:
            return None
        self.error.unknown_because = (
            f"the companion run with longer steps has blown up before t = {companion.time:.6g} s"
        )
        self._warn(f"the error is not known: {self.error.unknown_because}; a step half as long can be checked")
        return None

    def _estimate(self, frame: Frame, state: State, companion: State | None, setting: Setting, models: Models) -> None:
        """Take the difference from the companion and the rounding so far into the error."""
        radius = self.scene.bounding_radius
        fastest = float(np.linalg.norm(frame.angular_velocity, axis=1).max(initial=0.0))
        farthest = float((np.abs(frame.position) / radius[:, None]).max())
        gone = fastest * frame.time + farthest
        walk = math.sqrt(self._plain_sums(fastest, state.evaluations, frame.index))
        rounding = EPS * (8.0 + 2.0 * gone + (4.0 + 0.6 * gone) * walk + farthest * math.sqrt(state.evaluations))
        self.error.rounding = max(self.error.rounding, rounding * self.error.magnified(frame.time))
        if companion is not None:
            other = frame_of(setting, companion, frame.index)
            apart = np.linalg.norm(frame.position - other.position, axis=1) / radius
            angle = quaternion.angle_between(frame.quaternion, other.quaternion)
            self.error.note(frame.time, float(apart.max()), float(angle[models > TRANSLATING].max(initial=0.0)))
        if companion is not None or not self.error.order:
            self.error.unknown_because = ""

    def _plain_sums(self, fastest: float, evaluations: int, index: int) -> int:
        """Sums that have not carried what they rounded off: each may turn a momentum by half a last digit.

        Those of a body that nothing pushes, at every output, and all of a rotor whose turns are not short.
        """
        row, step = METHODS[str(self.plan.method.value)], self.plan.step.value
        is_carried = row.flies_exactly and not (row.turns_exactly and step and fastest * float(step) > PANEL)
        return index if is_carried else index + evaluations

    @property
    def _may_redo(self) -> bool:
        return (
            self.plan.redo
            and self.error.redone < MOST_REDOS
            and not self.is_finest
            and self.cost.evaluations < MOST_TIMES * self.planned
        )

    def _refinement(self, stop: Stop, k: int, course: _Course) -> float:
        """How many times finer the run must begin again, by its error so far; 1 where it may go on."""
        accuracy, estimated = self.scene.accuracy, self.error.of_this_attempt
        if not self._may_redo or estimated is None:
            return 1.0
        if self.error.rounding > ROUNDING_SHARE * max(accuracy, estimated):  # finer steps would only add to it
            return 1.0
        course.errors[k] = estimated
        expected = self._foretold(k, course)
        if estimated <= accuracy and expected <= ALARM * accuracy:
            return 1.0
        wanted = (2.0 * expected / accuracy) ** (1.0 / self.error.order)
        return min(LARGEST_REFINEMENT, max(LEAST_REFINEMENT, wanted))

    def _foretold(self, k: int, course: _Course) -> float:
        """Error at the end of the run, if it goes on growing by the power of time that it has grown by so far."""
        here, errors, stops = course.errors[k], course.errors, course.stops
        middle, growth = k // 2, 1.0
        if k > 0 and errors[middle] > 0.0 and stops[k].time >= LOOK_AHEAD * self.scene.end_time:
            growth = math.log(here / errors[middle]) / math.log(stops[k].time / stops[middle].time)
        return here * (self.scene.end_time / stops[k].time) ** min(LARGEST_GROWTH, max(1.0, growth))

    def _check_state(self, state: State) -> None:
        wrong = _blown_up(state)
        if len(wrong):
            others = f" (and of {len(wrong) - 1} more)" if len(wrong) > 1 else ""
            raise RunError(
                f"at t = {state.time:.6g} s the state of '{self.scene.names[wrong[0]]}'{others} is no longer finite: "
                f"method {self.plan.method.value} with {self._step_in_words()} has blown up; use a shorter step, or "
                "`step: auto`"
            )
        if np.abs(np.linalg.norm(state.quaternion, axis=1) - 1.0).max() > NORM_DRIFT:
            self._warn(
                f"the quaternion has left length one by more than {NORM_DRIFT:g}: {self.plan.method.value} lets it"
            )

    def _step_in_words(self) -> str:
        if self.plan.tolerance.value is not None:
            return f"a tolerance of {self.plan.tolerance.value:.3g}"
        return f"a step of {self.plan.step.value:.6g} s" if self.plan.step.value else "no step"

    def _watch_spin(self, frame: Frame, models: Models) -> None:
        row = METHODS[str(self.plan.method.value)]
        if row.flies_exactly or row.is_adaptive:
            return
        omega = np.linalg.norm(frame.angular_velocity, axis=1)
        fastest = float(omega[models > TRANSLATING].max(initial=0.0))
        if fastest * float(self.plan.step.value) > 2.0:
            self._warn("a body has come to spin faster than 2/step: the attitude cannot be trusted; use a shorter step")

    def _warn(self, message: str) -> None:
        if message not in self.warnings:
            self.warnings.append(message)

    def _look(self, frame: Frame) -> Frame:
        """Keep the first and the latest frame and the largest drift of each invariant."""
        if self.first is None:
            self.first = frame
        self.last = frame
        now, start = frame.balance, self.first.balance
        drifts = {
            "energy": abs(now.energy - start.energy - now.work + now.damping + now.friction),
            "momentum": math.hypot(*(now.momentum - start.momentum - now.impulse)),
            "angular_momentum": math.hypot(*(now.angular_momentum - start.angular_momentum - now.angular_impulse)),
        }
        for name, drift in drifts.items():
            self.largest_drift[name] = max(self.largest_drift.get(name, 0.0), drift)
        return frame

    def _expect(self, frame: Frame) -> None:
        for expectation in self.scene.expectations:
            if abs(expectation.time - frame.time) <= nearness(self.scene):
                self.expectations.append(check_expectation(expectation, self.scene, frame))


def _blown_up(state: State) -> np.ndarray:
    """Indices of the bodies whose state is no number, infinite or on its way there."""
    rows = np.concatenate([state.position, state.quaternion, state.velocity, state.angular_momentum], axis=1)
    if np.vdot(rows, rows) < LARGEST**2:  # one look at all of them
        return np.zeros(0, dtype=np.int64)
    return np.flatnonzero(~(np.abs(rows) < LARGEST).all(axis=1))


def steps_a_call(n_bodies: int, backend: str) -> int:
    """Steps that a run takes in one call of the stepper.

    >>> steps_a_call(10, "python"), steps_a_call(1_000_000, "serial")
    (300, 10)
    """
    return max(LEAST_STEPS_A_CALL, int(BODY_STEPS_A_CALL[backend] / n_bodies))


def simulate(scene: Scene, plan: Plan) -> Run:
    """A run of a scene by a plan: an iterator of Frames, the first at time zero, the last at the end.

    Raises InputError for the plan of another scene, RunError, while it runs, when a state is no longer finite.
    """
    if plan.n_bodies != scene.n_bodies:
        raise InputError(
            f"the plan is for {plan.n_bodies} bodies and the scene has {scene.n_bodies}: make one with plan(scene)"
        )
    error = MotionError(plan.order)
    if scene.can_touch.any():
        error.unknown_because = "bodies touch, and neighbouring motions part: no code can promise a trajectory"
    elif plan.order and not plan.verify.value:
        error.unknown_because = "the plan asks for no companion run"
    planned = METHODS[str(plan.method.value)].evaluations * total_steps(scene, plan.step.value)
    most = math.inf if plan.tolerance.value else max(LEAST_PLANNED, float(planned))
    return Run(scene, plan, error, planned=most)
