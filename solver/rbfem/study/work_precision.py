"""Error against cost: every method that applies to a scene, over a range of steps, against a converged reference."""

import itertools
import math
import multiprocessing
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rbfem.errors import RunError
from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS, Method
from rbfem.motion.state import kernel_of
from rbfem.planning.applicable import applicable_methods, is_damped
from rbfem.planning.frequencies import frequencies
from rbfem.planning.models import choose_models
from rbfem.planning.plan import Choice, Plan
from rbfem.planning.planner import plan
from rbfem.planning.system import find_islands
from rbfem.planning.timeline import total_steps
from rbfem.planning.touching import refuse_contact
from rbfem.scene.scene import Scene
from rbfem.simulation.frame import Frame
from rbfem.simulation.run import simulate

Array = NDArray[np.float64]
Show = Callable[[int, int, str], None]

COARSEST = 8.0  # times the stability limit of the scene: longer than any method of the table stands
FINER, FINER_FROM_ORDER_4 = 2.0, 2.0**0.5  # from one step to the next; at order eight already a factor of 16 in error
TOLERANCES = tuple(10.0**-digits for digits in range(2, 14))  # the knob of an adaptive method
REFERENCE_TOLERANCE = 1e-14
FIRST_STEP = 0.1  # of the limit: the first that an adaptive method tries

# A run takes no more evaluations than this, of one body and of all: some seconds for the slowest method altogether.
MOST_EVALUATIONS, MOST_BODY_EVALUATIONS = 2_000_000, 20_000_000
FEWEST_RUNS = 4  # of a method, however dear

LOST = 1.0  # a body's radius or a radian: an error from which on a run may be called unstable
ASYMPTOTIC = 0.1  # the order shows below this error and above ten times the floor
TIMED_SECONDS, TIMED_RUNS = 0.1, 3  # a run is repeated until either, and its shortest time counts


@dataclass(frozen=True)
class Point:
    """One run. step: s, the mean one; tolerance: of an adaptive method, else None; evaluations: of the loads of one
    body; seconds: of the steps, start and compilation excluded; error: largest of any body and frame, position as a
    share of the bounding radius, attitude in rad; infinite where the state blew up; is_stable: see `measured`."""

    method: str
    step: float
    tolerance: float | None
    steps: int
    evaluations: int
    seconds: float
    error: float
    is_stable: bool


@dataclass(frozen=True)
class Reference:
    """The motion that others are held against. method: in words; position (f, n, 3), quaternion (f, n, 4) of its f
    frames; energy: J, the largest energy of motion that the scene ever has."""

    method: str
    position: Array
    quaternion: Array
    energy: float


@dataclass(frozen=True)
class WorkPrecision:
    """What was measured.

    case, title, n_bodies, end_time, accuracy : of the scene
    points    : of all methods, by method, from coarse to fine
    chosen    : the run of the scene's own plan; its cost has the pilot and the check in it
    is_auto   : whether method and step of that plan were chosen, not asked for
    reference : the method of the reference, in words
    orders    : what the table of methods states for these loads
    floor     : error below which two runs cannot be told apart: how far the reference is sure
    left_out  : methods that do not apply, and why
    """

    case: str
    title: str
    n_bodies: int
    end_time: float
    accuracy: float
    points: tuple[Point, ...]
    chosen: Point
    is_auto: bool
    reference: str
    orders: dict[str, float]
    floor: float
    left_out: dict[str, str]

    @property
    def methods(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(point.method for point in self.points))

    def of(self, method: str) -> tuple[Point, ...]:
        """The points of a method, from coarse to fine."""
        return tuple(point for point in self.points if point.method == method)

    def order(self, method: str) -> float | None:
        """The order that a method shows here, see `fitted_order`; None for one that chooses its own steps."""
        return None if METHODS[method].is_adaptive else fitted_order(self.of(method), self.floor)

    def front(self, cost: str) -> tuple[Point, ...]:
        """The Pareto front in "seconds" or "evaluations"; errors below the floor count as equal."""
        return pareto_front(self.points, cost, self.floor)

    def cheapest_within(self, method: str) -> Point | None:
        """The run of a method that keeps the user's accuracy with the fewest evaluations."""
        within = [point for point in self.of(method) if point.is_stable and point.error <= self.accuracy]
        return min(within, key=lambda point: point.evaluations, default=None)


def measure(scene: Scene, show: Show = lambda done, total, what: None) -> WorkPrecision:
    """Run every method that applies to a scene, spread over the cores, and compare.

    show : called with how many parts of the work are done, of how many, and what comes next or was done last
    All runs, that of the plan too, use the serial kernels, so that their seconds can be compared.
    Raises InputError for what `plan` refuses, RunError if there is no reference.
    """
    refuse_contact(scene, "chart")
    reasons = applicable_methods(scene)
    methods = [name for name, reason in reasons.items() if not reason]
    total = len(methods) + 2
    show(0, total, "reference")
    made = replace(
        plan(scene, beyond_limit=True),
        backend=Choice("serial", "all points of a chart on one backend"),
        step_limit=_limit_of_all(scene),
    )
    bare = _bare(scene)
    reference = _reference(bare, made, methods)
    show(1, total, "plan")
    _warm_up(bare, made, str(made.method.value))
    chosen = _with_pilot(measured(scene, made, reference), int(made.pilot.value))
    points: dict[str, tuple[Point, ...]] = {}
    for name, swept in _spread(bare, made, methods, reference):
        points[name] = swept
        show(1 + len(points), total, name)
    in_order = tuple(point for name in methods for point in points[name])
    show(total, total, "done")
    return WorkPrecision(
        case=scene.name,
        title=scene.title,
        n_bodies=scene.n_bodies,
        end_time=scene.end_time,
        accuracy=scene.accuracy,
        points=in_order,
        chosen=chosen,
        is_auto=scene.method is None and scene.step is None,
        reference=reference.method,
        orders={name: METHODS[name].damped_order if is_damped(scene) else METHODS[name].order for name in METHODS},
        floor=floor_of([points[name] for name in methods if name != reference.method.split()[0]]),
        left_out={name: reason for name, reason in reasons.items() if reason},
    )


def _limit_of_all(scene: Scene) -> Choice:
    """The longest step that any method stands, whichever the plan has chosen; what is swept starts beyond it."""
    models = choose_models(scene)
    limit = frequencies(scene, models, find_islands(scene, models)).step_limit
    return Choice(limit if math.isfinite(limit) else None, "of the scene")


def _bare(scene: Scene) -> Scene:
    """The scene without what a run for the chart needs not: looks in between, which cut steps, and the meshes."""
    return replace(scene, expectations=(), parts=tuple(replace(part, mesh=None) for part in scene.parts))


def _spread(
    scene: Scene, made: Plan, methods: Sequence[str], reference: Reference
) -> Iterator[tuple[str, tuple[Point, ...]]]:
    """Sweeps of the methods as they are done, each in one of as many processes as there are cores."""
    spawn = multiprocessing.get_context("spawn")  # a fork would copy numba's threads as they stand
    with ProcessPoolExecutor(mp_context=spawn) as pool:
        jobs: dict[Future, str] = {pool.submit(sweep, scene, made, name, reference): name for name in _in_turn(methods)}
        try:
            for job in as_completed(jobs):
                yield jobs[job], job.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _in_turn(methods: Sequence[str]) -> list[str]:
    """The first method of every kernel before all others: no two processes then compile the same one.

    >>> _in_turn(["kdk", "dlm", "rk4", "euler"])
    ['kdk', 'rk4', 'dlm', 'euler']
    """
    kernels = [kernel_of(name) for name in methods]
    return sorted(methods, key=lambda name: kernels.index(kernel_of(name)) != methods.index(name))


def _reference(scene: Scene, made: Plan, methods: Sequence[str]) -> Reference:
    """By the exact motion where there is one, else by the adaptive method at the edge of rounding."""
    name = "exact" if "exact" in methods else "dop853"
    words = name if name == "exact" else f"{name} at tolerance {REFERENCE_TOLERANCE:g}"
    run = simulate(scene, _with(scene, made, name, REFERENCE_TOLERANCE if name == "dop853" else None))
    position, attitude, energy = [], [], 0.0
    for frame in run:
        position.append(frame.position)
        attitude.append(frame.quaternion)
        energy = max(energy, frame.balance.kinetic + frame.balance.rotational)
    return Reference(words, np.array(position), np.array(attitude), energy)


def sweep(scene: Scene, made: Plan, method: str, reference: Reference) -> tuple[Point, ...]:
    """The runs of one method from coarse to fine, until its error stops falling or they become too dear."""
    _warm_up(scene, made, method)
    points: list[Point] = []
    for knob in _knobs(scene, made, method):
        point = measured(scene, _with(scene, made, method, knob), reference)
        if points and point.evaluations == points[-1].evaluations:
            continue  # the outputs still cut the steps shorter than the tolerance asks for
        points.append(point)
        if _has_stopped_falling(points) or (len(points) >= FEWEST_RUNS and point.evaluations > most_evaluations(scene)):
            break
    return tuple(points)


def _knobs(scene: Scene, made: Plan, method: str) -> Iterable[float | None]:
    """What is turned from run to run, coarse to fine: the tolerance, the step, or nothing where the motion is exact."""
    row = METHODS[method]
    if row.needs_free_bodies:
        return (None,)
    return TOLERANCES if row.is_adaptive else _steps(scene, made, row)


def _steps(scene: Scene, made: Plan, row: Method) -> Iterator[float]:
    """Steps from beyond stability on, each of which cuts the run differently from the one before."""
    step, counts = COARSEST * float(made.step_limit.value or scene.output_interval), set[int]()
    while True:
        count = total_steps(scene, step)
        if len(counts) >= FEWEST_RUNS and row.evaluations * count > most_evaluations(scene):
            return
        if count not in counts:
            yield step
        counts.add(count)
        step /= FINER if row.order < 4 else FINER_FROM_ORDER_4


def most_evaluations(scene: Scene) -> int:
    """Evaluations, of each body, of the longest run of a chart."""
    return min(MOST_EVALUATIONS, MOST_BODY_EVALUATIONS // scene.n_bodies)


def _has_stopped_falling(points: Sequence[Point]) -> bool:
    """Whether the last two runs were no better than one before them; an error at which all is lost may stand still."""
    if len(points) < FEWEST_RUNS:
        return False
    best = min(point.error for point in points[:-2])
    return best < ASYMPTOTIC and min(point.error for point in points[-2:]) > 0.8 * best


def _with(scene: Scene, made: Plan, method: str, knob: float | None) -> Plan:
    """The plan with a method and its step, or its tolerance where the method chooses its own steps; run once, as is."""
    unchecked = Choice(0, "the chart compares with its own reference")
    longest = float(made.step_limit.value or scene.end_time)
    is_adaptive = METHODS[method].is_adaptive
    return replace(
        made,
        method=Choice(method, "charted"),
        step=Choice(min(FIRST_STEP * longest, scene.end_time) if is_adaptive else knob, "charted"),
        tolerance=Choice(knob if is_adaptive else None, "charted"),
        verify=unchecked,
        redo=False,
    )


def _warm_up(scene: Scene, made: Plan, method: str) -> None:
    """Move over one output interval at most, so that no time to import or compile is counted as the method's."""
    first = min(scene.output_interval, scene.end_time)
    short = replace(scene, end_time=first, output_interval=first)
    row = METHODS[method]
    knob = None if row.needs_free_bodies else TOLERANCES[0] if row.is_adaptive else first
    with suppress(RunError):  # what blows up is compiled as well
        for _frame in simulate(short, _with(scene, made, method, knob)):
            pass


def measured(scene: Scene, made: Plan, reference: Reference) -> Point:
    """A run held against the reference.

    It is called unstable if its state blew up, or if it is off by more than `LOST` and has made up or lost more energy
    than the true motion ever has as energy of motion.
    """
    run = simulate(scene, made)
    error, has_ended = _largest_error(run, scene, reference)
    method = str(made.method.value)
    return Point(
        method=method,
        step=scene.end_time / max(run.cost.steps, 1) if METHODS[method].is_adaptive else mean_step(scene, made),
        tolerance=float(made.tolerance.value) if METHODS[method].is_adaptive else None,
        steps=run.cost.steps,
        evaluations=run.cost.evaluations,
        seconds=_shortest(scene, made, run.cost.wall_seconds) if has_ended else run.cost.wall_seconds,
        error=error,
        is_stable=has_ended and (error < LOST or run.largest_drift["energy"] <= reference.energy),
    )


def _with_pilot(point: Point, evaluations: int) -> Point:
    """The run of a plan with what its pilot took, each evaluation at the price of one of the run."""
    share = evaluations / max(point.evaluations, 1)
    return replace(point, evaluations=point.evaluations + evaluations, seconds=point.seconds * (1.0 + share))


def mean_step(scene: Scene, made: Plan) -> float:
    """s; shorter than the plan's wherever a step is cut to end at an output."""
    return scene.end_time / total_steps(scene, made.step.value)


def _shortest(scene: Scene, made: Plan, seconds: float) -> float:
    """The shortest time of several runs, where the first took so little that the clock and the neighbours show."""
    spent, best = seconds, seconds
    for _ in range(1, TIMED_RUNS):
        if spent > TIMED_SECONDS:
            break
        run = simulate(scene, made)
        for _frame in run:
            pass
        spent, best = spent + run.cost.wall_seconds, min(best, run.cost.wall_seconds)
    return best


def _largest_error(frames, scene: Scene, reference: Reference) -> tuple[float, bool]:
    """Largest error of any body and frame, and whether the run came to its end."""
    error = 0.0
    try:
        for frame, position, attitude in zip(frames, reference.position, reference.quaternion, strict=True):
            error = max(error, _distance(frame, position, attitude, scene.bounding_radius))
    except RunError:
        return np.inf, False
    return error, True


def _distance(frame: Frame, position: Array, attitude: Array, radius: Array) -> float:
    apart = np.linalg.norm(frame.position - position, axis=1) / radius
    turned = quaternion.angle_between(frame.quaternion, attitude)
    return float(max(apart.max(), turned.max()))


def floor_of(sweeps: Sequence[Sequence[Point]]) -> float:
    """How far the reference is sure: the smallest error that two successive runs of another method agree with it to.

    Two, because a single one can meet the error of the reference by chance.
    """
    pairs = [max(a.error, b.error) for points in sweeps for a, b in itertools.pairwise(points)]
    return max(min(pairs, default=0.0), float(np.finfo(float).eps))


def fitted_order(points: Sequence[Point], floor: float) -> float | None:
    """Slope of log error against log step, where three or four successive points lie best on a line.

    Only points that are well above the floor and below `ASYMPTOTIC` count; None if there are fewer than three.

    >>> line = [Point("rk4", h, None, round(1 / h), round(4 / h), 0.0, h**4, True) for h in (0.2, 0.1, 0.05, 0.025)]
    >>> round(fitted_order(line, 1e-12), 6)
    4.0
    >>> fitted_order(line[:2], 1e-12)
    """
    usable = [point for point in points if point.is_stable and 10.0 * floor < point.error < ASYMPTOTIC]
    if len(usable) < 3:
        return None
    width = min(4, len(usable))
    step, error = np.log([point.step for point in usable]), np.log([point.error for point in usable])
    fits = []
    for first in range(len(usable) - width + 1):
        window = slice(first, first + width)
        line = np.polyfit(step[window], error[window], 1)
        fits.append((float(np.abs(np.polyval(line, step[window]) - error[window]).max()), float(line[0])))
    return min(fits)[1]


def pareto_front(points: Sequence[Point], cost: str, floor: float = 0.0) -> tuple[Point, ...]:
    """The stable points that no other beats in both error and cost ("seconds" or "evaluations"), from cheap to dear.

    >>> make = lambda cost, error: Point("rk4", 0.1, None, 10, cost, 0.0, error, True)
    >>> [point.error for point in pareto_front([make(3, 0.5), make(2, 0.4), make(9, 0.1)], "evaluations")]
    [0.4, 0.1]
    """
    front: list[Point] = []
    for point in sorted(
        (one for one in points if one.is_stable), key=lambda one: (getattr(one, cost), max(one.error, floor))
    ):
        if not front or max(point.error, floor) < max(front[-1].error, floor):
            front.append(point)
    return tuple(front)
