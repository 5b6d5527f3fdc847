"""The only time loop: a run is an iterator of frames that knows, when it is through, its error, cost and balance."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from rbfem.errors import InputError, RunError
from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.motion.model import TRANSLATING
from rbfem.motion.state import State, angular_velocity_world, move
from rbfem.planning.models import models_of
from rbfem.planning.plan import Plan
from rbfem.planning.system import build_system
from rbfem.planning.timeline import Stop, nearness, steps_between, stops
from rbfem.scene.scene import Scene
from rbfem.simulation.expectations import ExpectationResult, check_expectation
from rbfem.simulation.frame import Frame
from rbfem.simulation.frames import frame_of, starting_state

# Body-steps of one call of the stepper, so that the loop looks up often enough for Ctrl-C and the clock.
BODY_STEPS_A_CALL = {"python": 3e3, "serial": 3e6, "parallel": 6e6}
LEAST_STEPS_A_CALL = 10  # fewer would leave most of the time to the copies that a call begins and ends with
NORM_DRIFT = 1e-6  # |q| this far from one: the method has lost the rotation
LARGEST = 1e50  # a state beyond has blown up; below, its energies and their squares still fit a float


@dataclass
class Cost:
    """What a run has cost so far. steps: of the stepper, companion included; evaluations: of the loads of one body."""

    wall_seconds: float = 0.0
    steps: int = 0
    evaluations: int = 0
    body_steps: int = 0


@dataclass
class MotionError:
    """Largest difference from the companion run at twice the step, over bodies and frames, and what Richardson makes of
    it: the error of this run, difference / (2^order - 1). position: share of the bounding radius; attitude: rad.
    unknown_because: why there is no estimate; empty where there is one."""

    order: int
    position: float = 0.0
    attitude: float = 0.0
    unknown_because: str = "the run has not come to its first stop yet"

    @property
    def estimated(self) -> float | None:
        return None if self.unknown_because else max(self.position, self.attitude) / (2.0**self.order - 1.0)


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

    def __iter__(self) -> Iterator[Frame]:
        if self.first is not None:
            raise RunError("a run goes through its frames once; simulate(scene, plan) makes another")
        models = models_of(self.plan.models, self.scene.n_bodies)
        system = build_system(self.scene, models)
        state = starting_state(self.scene)
        companion = state if self.plan.verify.value else None
        frame = self._look(frame_of(self.scene, system, state, 0))
        self._expect(frame)
        yield frame
        index = 0
        for stop in stops(self.scene):
            n_steps = steps_between(state.time, stop.time, float(self.plan.step.value))
            dt = (stop.time - state.time) / n_steps
            began = time.perf_counter()
            state = self._move(state, dt, n_steps, stop, system)
            self._check_state(state, models)
            if companion is not None:
                companion = self._move_companion(companion, 2.0 * dt, n_steps // 2, stop, system)
            self.cost.wall_seconds += time.perf_counter() - began
            index += stop.is_output
            frame = self._look(frame_of(self.scene, system, state, index))
            if companion is not None:
                self._compare(frame, frame_of(self.scene, system, companion, index), models)
            self._watch_spin(state, system, models)
            self._expect(frame)
            if stop.is_output:
                yield frame

    def _move(self, state: State, dt: float, n_steps: int, stop: Stop, system) -> State:
        """To a stop, in calls short enough to be interrupted; the time is then the stop's own to the last digit."""
        backend = str(self.plan.backend.value)
        at_once = steps_a_call(self.scene.n_bodies, backend)
        with np.errstate(all="ignore"):  # what has blown up is told in words, by the caller
            for done in range(0, n_steps, at_once):
                state = move(state, dt, min(at_once, n_steps - done), str(self.plan.method.value), system, backend)
        self.cost.steps += n_steps
        self.cost.body_steps += n_steps * len(system.islands.member)
        self.cost.evaluations += n_steps * METHODS[str(self.plan.method.value)].evaluations
        return State(stop.time, state.position, state.quaternion, state.velocity, state.angular_momentum, state.ledger)

    def _move_companion(self, companion: State, dt: float, n_steps: int, stop: Stop, system) -> State | None:
        """The companion at a stop, or None once it has blown up and tells nothing any more."""
        companion = self._move(companion, dt, n_steps, stop, system)
        if len(_blown_up(companion)) == 0:
            return companion
        self.error.unknown_because = f"the companion run at twice the step has blown up before t = {stop.time:.6g} s"
        self._warn(f"the error is not known: {self.error.unknown_because}; a step half as long can be checked")
        return None

    def _compare(self, frame: Frame, companion: Frame, models) -> None:
        apart = np.linalg.norm(frame.position - companion.position, axis=1) / self.scene.bounding_radius
        turned = quaternion.angle_between(frame.quaternion, companion.quaternion)
        self.error.position = max(self.error.position, float(apart.max()))
        self.error.attitude = max(self.error.attitude, float(turned[models > TRANSLATING].max(initial=0.0)))
        self.error.unknown_because = ""

    def _check_state(self, state: State, models) -> None:
        wrong = _blown_up(state)
        if len(wrong):
            others = f" (and of {len(wrong) - 1} more)" if len(wrong) > 1 else ""
            method = str(self.plan.method.value)
            raise RunError(
                f"at t = {state.time:.6g} s the state of '{self.scene.names[wrong[0]]}'{others} is no longer finite: "
                f"method {method} with a step of {self.plan.step.value:.6g} s has blown up; use a shorter step"
                f"{'' if method == 'rk4' else ' or method rk4'}"
            )
        norm = np.abs(np.linalg.norm(state.quaternion[models > TRANSLATING], axis=1) - 1.0).max(initial=0.0)
        if norm > NORM_DRIFT:
            self._warn(
                f"the quaternion has left length one by more than {NORM_DRIFT:g}: {self.plan.method.value} lets it"
            )

    def _watch_spin(self, state: State, system, models) -> None:
        omega = np.linalg.norm(angular_velocity_world(state, system.bodies), axis=1)
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
            "energy": abs(now.energy - start.energy - now.work),
            "momentum": float(np.linalg.norm(now.momentum - start.momentum - now.impulse)),
            "angular_momentum": float(
                np.linalg.norm(now.angular_momentum - start.angular_momentum - now.angular_impulse)
            ),
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
    rows = np.hstack([state.position, state.quaternion, state.velocity, state.angular_momentum])
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
    error = MotionError(METHODS[str(plan.method.value)].order)
    if not plan.verify.value:
        error.unknown_because = "the plan asks for no companion run"
    return Run(scene, plan, error)
