"""A short part of the motion run by several methods, to see which reaches the error asked for at the least cost."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.motion.model import Bodies, Islands
from rbfem.motion.state import State, System, move, move_to_tolerance
from rbfem.planning.timeline import steps_between

Array = NDArray[np.float64]

SHARE = 1 / 8  # of a short run; of a long one, so many turns of the fastest swing or spin
TURNS = 3.0
LEVELS = 14
MARGIN = 5.0  # how much smaller than accepted the pilot wants the error: a run is judged by 2.5 times its own
TRUSTED = 0.6  # share of the order in the table that must be seen before an error is foretold by it
NOISE = 1e-12  # a difference smaller than this is rounding
MOST_ISLANDS = 50  # that are tried
MOST_SPENT = {"python": 3e4, "serial": 1e7, "parallel": 1e7}  # evaluations of a body that a pilot may take: seconds
TURNED = 2.0  # rad, of the fastest turn or swing in the coarsest step
REACH = 3.0  # how many times finer than the last level the run may be


@dataclass(frozen=True)
class Stretch:
    """What is to be run: the system from its state at time zero until `end`.

    end      : s, of the whole run
    rate     : rad/s, the fastest swing, decay or spin at the start
    swing    : rad/s, the fastest swing or decay
    accuracy : error accepted, of the whole run
    radius   : (n,) m, bounding radii: an error of a position is a share of them
    scale    : (n, 13) see `move_to_tolerance`
    times    : s, zero and every time at which a step must end
    backend  : see `rbfem.compute.loops`
    """

    system: System
    start: State
    end: float
    rate: float
    swing: float
    accuracy: float
    radius: Array
    scale: Array
    times: Array
    backend: str

    @property
    def pilot_end(self) -> float:
        return min(SHARE * self.end, max(SHARE**2 * self.end, TURNS * 2.0 * math.pi / self.rate))

    @property
    def allowed(self) -> float:
        """Error of the pilot that lets the whole run stay well below the accuracy, if errors grow like the time."""
        return self.accuracy / MARGIN * self.pilot_end / self.end

    def least_cost(self, method: str) -> float:
        """Evaluations of the whole run with no more steps than its stops ask for."""
        return METHODS[method].evaluations * self.steps(math.inf)

    @property
    def marks(self) -> Array:
        """Zero, the corners of ramps within the pilot, and its end: no step may go across a corner."""
        corners = self.system.loads.ramp_time
        inside = corners[(corners > 0.0) & (corners < self.pilot_end)]
        return np.array([0.0, *np.unique(inside), self.pilot_end])

    def shared_out(self, n_steps: int) -> NDArray[np.int64]:
        """About so many steps over the spans between the marks, one at least for each."""
        return np.ceil(n_steps * np.diff(self.marks) / self.pilot_end).astype(np.int64)

    def steps(self, step: float) -> int:
        """Of the whole run."""
        return sum(steps_between(a, b, step) for a, b in pairwise(self.times))

    def expected_evaluations(self, method: str) -> float:
        """Of a pilot of this method, before anything is known of it."""
        return 3.0 * METHODS[method].evaluations * _guess(self, order_of(method, self.system))


@dataclass
class Finding:
    """What the pilot found of a method.

    step      : s, or the tolerance of an adaptive method, that reaches the accuracy over the whole run
    order     : observed, at most that of the table
    cost      : evaluations of the whole run with that step
    spent     : evaluations of the pilot
    """

    method: str
    step: float = math.nan
    order: float = math.nan
    cost: float = math.inf
    spent: int = 0


@dataclass(frozen=True)
class Settled:
    """The findings of a pilot, the cheapest first."""

    findings: tuple[Finding, ...]
    span: float

    @property
    def best(self) -> Finding:
        return self.findings[0]

    @property
    def evaluations(self) -> int:
        return sum(finding.spent for finding in self.findings)


def run_pilot(stretch: Stretch, methods: tuple[str, ...]) -> Settled:
    """Measure methods over the first part of a run; the cheapest comes first."""
    findings: list[Finding] = []
    with np.errstate(all="ignore"):  # a step that is too long may blow up: it is then no number, and counted as such
        for method in methods:
            least = min((finding.cost for finding in findings), default=math.inf)
            measure = _measure_adaptive if METHODS[method].is_adaptive else _measure
            is_hopeless = stretch.least_cost(method) >= least
            findings.append(Finding(method) if is_hopeless else measure(stretch, method, least))
    ordered = sorted(findings, key=lambda finding: finding.cost)
    return Settled(tuple(ordered), stretch.pilot_end)


def _measure(stretch: Stretch, method: str, least_cost: float) -> Finding:
    """Halve the step, from the coarsest that is stable, until the order is that of the table and the error asked for
    within reach; give up where another method is known to cost less."""
    finding, order = Finding(method), order_of(method, stretch.system)
    least = _least_steps(stretch, method)
    steps = stretch.shared_out(least)
    coarse, apart = _run(stretch, method, steps, finding), math.inf
    for _ in range(LEVELS):
        steps = 2 * steps
        n = int(steps.sum())
        fine = _run(stretch, method, steps, finding)
        before, apart = apart, difference(coarse, fine, stretch.radius)
        coarse = fine
        if finding.spent > MOST_SPENT[stretch.backend]:
            break
        if not apart < math.inf:
            continue
        seen = _order_seen(before, apart, order)
        finding.order = min(order, max(1.0, seen))
        error = apart / (2.0**finding.order - 1.0)
        wanted = n * max(error / stretch.allowed, 1e-30) ** (1.0 / finding.order)
        finding.step = stretch.pilot_end / max(wanted, 0.5 * n if seen < order else least)
        finding.cost = METHODS[method].evaluations * stretch.steps(finding.step)
        if before < math.inf and (error <= stretch.allowed or (seen >= TRUSTED * order and wanted <= REACH * n)):
            break
        at_best = METHODS[method].evaluations * n * (error / stretch.allowed) ** (1.0 / order)
        if at_best * stretch.end / stretch.pilot_end > least_cost:
            finding.cost = math.inf
            break
    return finding


def _measure_adaptive(stretch: Stretch, method: str, least_cost: float) -> Finding:
    """The tolerance whose error, told by a run at a thousandth of it, is the one asked for."""
    finding, tolerance = Finding(method, order=order_of(method, stretch.system)), stretch.allowed
    for _ in range(LEVELS):
        coarse = _run_to_tolerance(stretch, method, tolerance, finding)
        fine = _run_to_tolerance(stretch, method, 1e-3 * tolerance, finding)
        error = difference(coarse, fine, stretch.radius)
        if error < math.inf:
            finding.step, finding.cost = tolerance, coarse.evaluations * stretch.end / stretch.pilot_end
        if stretch.allowed / 10.0 <= error <= stretch.allowed or finding.cost > least_cost:
            break
        tolerance *= min(1e3, max(1e-3, 0.3 * stretch.allowed / error)) if 0.0 < error < math.inf else 1e-2
    return finding


def _order_seen(before: float, apart: float, order: float) -> float:
    """By two differences, each of a step and its half; that of the table where they are rounding, half of it where
    there is only one."""
    if apart < NOISE:
        return order
    return math.log2(before / apart) if 0.0 < before < math.inf else 0.5 * order


def _least_steps(stretch: Stretch, method: str) -> int:
    """Steps of the pilot at the longest step that is stable, and of less than half a turn of anything: a load
    that turns with a body looks constant to steps of whole turns."""
    swings = stretch.pilot_end * stretch.swing / (METHODS[method].oscillation_limit or 2.0)
    return max(1, math.ceil(max(swings, stretch.pilot_end * stretch.rate / TURNED)))


def order_of(method: str, system: System) -> float:
    """The order that the table states for these loads."""
    row = METHODS[method]
    return row.damped_order if system.islands.is_damped.any() else row.order


def _guess(stretch: Stretch, order: float) -> int:
    """Steps of a swing of the fastest rate with an error of (h rate / 4)^order a radian."""
    turned = max(1.0, stretch.rate * stretch.pilot_end)
    return math.ceil(stretch.pilot_end * stretch.rate / 4.0 * (turned / stretch.allowed) ** (1.0 / order))


def _run(stretch: Stretch, method: str, n_steps: NDArray[np.int64], finding: Finding) -> State:
    """The state at the end of the pilot after so many equal steps in each of its spans."""
    state = stretch.start
    for (begin, end), n in zip(pairwise(stretch.marks), n_steps, strict=True):
        state = move(state, (end - begin) / n, int(n), method, stretch.system, stretch.backend)
        state = replace(state, time=end)
    finding.spent += state.evaluations
    return state


def _run_to_tolerance(stretch: Stretch, method: str, tolerance: float, finding: Finding) -> State:
    first_step, scale = 0.1 / stretch.rate, stretch.scale
    span, system, backend = stretch.pilot_end, stretch.system, stretch.backend
    state = move_to_tolerance(stretch.start, span, first_step, tolerance, scale, method, system, backend)
    finding.spent += state.evaluations
    return state


def difference(a: State, b: State, radius: Array) -> float:
    """Largest difference of two states, positions as a share of the bounding radius, attitudes in rad; infinite for
    what is no number."""
    apart = np.linalg.norm(a.position - b.position, axis=1) / radius
    turned = quaternion.angle_between(quaternion.normalize(a.quaternion), quaternion.normalize(b.quaternion))
    largest = float(np.max([apart.max(), turned.max()]))  # which is no number if either is none; max() may not be
    return largest if math.isfinite(largest) else math.inf


def sample(system: System, start: State, radius: Array) -> tuple[System, State, Array]:
    """At most MOST_ISLANDS of the islands, evenly chosen, with the bodies that their springs end on: enough to know
    what copies of a few parts need."""
    islands, loads = system.islands, system.loads
    count = len(islands.is_damped)
    if count <= MOST_ISLANDS:
        return system, start, radius
    chosen = np.unique(np.linspace(0, count - 1, MOST_ISLANDS).round().astype(np.int64))
    members = [islands.member[islands.first[i] : islands.first[i + 1]] for i in chosen]
    inside = np.concatenate(members)
    first_load = system.bodies.first_load
    rows = np.concatenate([np.arange(first_load[b], first_load[b + 1]) for b in inside])
    far = loads.other[rows]
    kept = np.concatenate([inside, np.setdiff1d(far[far >= 0], inside)])  # the far ends outside stand still
    place = np.full(len(radius) + 1, -1)
    place[kept] = np.arange(len(kept))
    counts = np.diff(first_load)[inside]
    n_loads = np.concatenate([[0], np.cumsum(counts), np.full(len(kept) - len(inside), counts.sum())])
    picked = loads._replace(
        **{
            name: np.ascontiguousarray(getattr(loads, name)[rows]) for name in ("kind", "is_external", "values", "ramp")
        },
        other=place[far],
    )
    bodies = system.bodies._replace(
        **{name: getattr(system.bodies, name)[kept] for name in Bodies._fields if name != "first_load"},
        first_load=n_loads.astype(np.int64),
    )
    first = np.cumsum([0, *map(len, members)]).astype(np.int64)
    fewer = Islands(np.arange(len(inside)), first, islands.is_damped[chosen])
    arrays = ("position", "quaternion", "velocity", "angular_momentum", "ledger")
    state = replace(start, **{name: getattr(start, name)[kept] for name in arrays})
    return System(bodies, picked, fewer, system.gravity), state, radius[kept]


def error_scale(system: System, radius: Array, rate: float) -> Array:
    """(n, 13) the size of an error of each column of a state that counts as one: a bounding radius, a radian, and
    velocities and angular momenta that make as much in 1/rate; infinite for what cannot move."""
    n = len(radius)
    length = np.where(system.bodies.inverse_mass > 0.0, radius, np.inf)[:, None]
    momentum = rate / system.bodies.inverse_moments
    return np.hstack([np.tile(length, 3), np.full((n, 4), 0.5), np.tile(rate * length, 3), momentum])
