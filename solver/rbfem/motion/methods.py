"""The methods, as data: the coefficients that the steppers read, and the facts everyone else reads."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate

from rbfem.motion import dop853
from rbfem.motion.free_flight import CONSTANT_RATE, EXACT_ROTOR, SPLIT_ROTOR
from rbfem.motion.lie import STAGES


@dataclass(frozen=True)
class RungeKutta:
    """Explicit Runge-Kutta on the stacked state.

    tableau    : stage s is evaluated at y + dt Σ_j tableau[s][j] k_j, at the time t + dt Σ_j tableau[s][j]
    weights    : y(t + dt) = y + dt Σ weights[s] k_s
    is_world   : the rotational variable is ω in world axes, else the angular momentum in body axes
    is_symplectic_euler : the new velocities move position and attitude (one stage only)
    normalizes : the quaternion gets unit length after every step
    flies_exactly : bodies that nothing pushes take the exact rotor instead
    estimators : weights of two estimates of the error of a step, of orders five and three; with them it is adaptive
    """

    tableau: tuple[tuple[float, ...], ...]
    weights: tuple[float, ...]
    is_world: bool = False
    is_symplectic_euler: bool = False
    normalizes: bool = True
    flies_exactly: bool = False
    estimators: tuple[tuple[float, ...], ...] = ()

    @property
    def nodes(self) -> tuple[float, ...]:
        return tuple(sum(row) for row in self.tableau)

    @property
    def evaluations(self) -> int:
        return len(self.weights)


@dataclass(frozen=True)
class Splitting:
    """Free flight and kicks in turn: `parts` are their shares of a step, the first of them a kick or a flight.

    rotor : what turns a body in flight, see `rbfem.motion.free_flight`
    """

    parts: tuple[float, ...]
    begins_with_kick: bool
    rotor: int = EXACT_ROTOR

    @property
    def times(self) -> tuple[float, ...]:
        """Share of a step that has been flown when each part begins."""
        flown = [0.0 if self.is_kick(i) else part for i, part in enumerate(self.parts)]
        return (0.0, *accumulate(flown))[: len(self.parts)]

    def is_kick(self, i: int) -> bool:
        return (i % 2 == 0) == self.begins_with_kick

    @cached_property
    def evaluations(self) -> int:
        """Kicks a step, where the last of a step and the first of the next are one."""
        return sum(self.is_kick(i) for i in range(len(self.parts))) - self.begins_with_kick


@dataclass(frozen=True)
class LieRungeKutta:
    """The commutator-free method of `rbfem.motion.lie`: its coefficients stand in its formulas."""

    evaluations: int = STAGES


@dataclass(frozen=True)
class Method:
    """One row of the table.

    summary           : what it does, for the plan and the docs
    order             : of the global error on smooth loads that do not depend on the velocity
    damped_order      : of the global error where dampers or drag act
    scheme            : the coefficients
    preserves, fails  : what it keeps whatever the step, and where it is the wrong choice
    oscillation_limit : largest dt ω for which an undamped oscillation does not grow; 0 if it grows at every step
    source            : where the method is described
    """

    summary: str
    order: float
    damped_order: float
    scheme: RungeKutta | Splitting | LieRungeKutta
    preserves: str
    fails: str
    oscillation_limit: float
    source: str

    @property
    def evaluations(self) -> int:
        """Evaluations of the loads a step."""
        return self.scheme.evaluations

    @property
    def is_adaptive(self) -> bool:
        """Whether it takes a tolerance instead of a step."""
        return isinstance(self.scheme, RungeKutta) and bool(self.scheme.estimators)

    @property
    def needs_free_bodies(self) -> bool:
        """Whether it has no place for a load."""
        return self.evaluations == 0

    @property
    def turns_exactly(self) -> bool:
        """Whether bodies turn by the exact rotor between kicks, so that a spin does not limit the step."""
        return isinstance(self.scheme, Splitting) and self.scheme.rotor == EXACT_ROTOR

    @property
    def flies_exactly(self) -> bool:
        """Whether a body that nothing pushes is moved in one piece, without an error of the step."""
        return self.turns_exactly or (isinstance(self.scheme, RungeKutta) and self.scheme.flies_exactly)


def _palindrome(*half: float) -> tuple[float, ...]:
    """The half and its mirror image, its last number in the middle once.

    >>> _palindrome(1.0, 2.0, 3.0)
    (1.0, 2.0, 3.0, 2.0, 1.0)
    """
    return (*half, *half[-2::-1])


def _in_turn(first: tuple[float, ...], second: tuple[float, ...]) -> tuple[float, ...]:
    """a b a b … a

    >>> _in_turn((1.0, 3.0, 5.0), (2.0, 4.0))
    (1.0, 2.0, 3.0, 4.0, 5.0)
    """
    return tuple(value for pair in zip(first, (*second, 0.0), strict=True) for value in pair)[:-1]


def _doubled(*half: float) -> tuple[float, ...]:
    """The half and its mirror image, all of it: an even number of parts that add up to one, the last half share found.

    >>> _doubled(0.125)
    (0.125, 0.375, 0.375, 0.125)
    """
    whole = (*half, 0.5 - sum(half))
    return (*whole, *whole[::-1])


def _closed(*half: float) -> tuple[float, ...]:
    """An odd number of parts that add up to one, the middle one found.

    >>> _closed(0.25)
    (0.25, 0.5, 0.25)
    """
    return _palindrome(*half, 1.0 - 2.0 * sum(half))


_RK4 = RungeKutta(((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6))
_RK4_LIMIT = 2.0 * 2.0**0.5
_BLANES_MOAN = "Blanes, Moan, J. Computational and Applied Mathematics 142:313, 2002"
_DORMAND_PRINCE = "Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section II.5 and program DOP853"
_SYMPLECTIC = "phase volume and momenta; the energy error stays bounded over any time"
_DAMPED_SPLITTING = "dampers and drag bring it down to order two"
_BANDS = "from dt = π/ω_max on, narrow bands of slow growth between steps that are stable"

METHODS = {
    "exact": Method(
        "closed form: parabola and torque-free rotation by Jacobi's elliptic functions, in one piece",
        order=math.inf,
        damped_order=math.inf,
        scheme=Splitting((1.0,), begins_with_kick=False),
        preserves="energy, momentum and angular momentum to rounding, over any time",
        fails="has no place for a load: for bodies that nothing but a uniform field moves",
        oscillation_limit=math.inf,
        source="van Zon, Schofield, J. Computational Physics 225:145, 2007; Celledoni, Fassò, Säfström, Zanna, SIAM J. "
        "Scientific Computing 30:2084, 2008",
    ),
    "kdk": Method(
        "kick, drift, kick: half of the loads, the exact rotor, half of the loads; dampers by the implicit midpoint",
        order=2,
        damped_order=2,
        scheme=Splitting((0.5, 1.0, 0.5), begins_with_kick=True),
        preserves=f"{_SYMPLECTIC}; stable to dt = 2/ω_max with any damping",
        fails="order two: a small error of smooth motion costs many steps",
        oscillation_limit=2.0,
        source="McLachlan, Quispel, Acta Numerica 11:341, 2002; McLachlan, Zanna, Foundations of Computational "
        "Mathematics 5:87, 2005",
    ),
    "dlm": Method(
        "kick, drift, kick with five turns about body axes for the rotor",
        order=2,
        damped_order=2,
        scheme=Splitting((0.5, 1.0, 0.5), begins_with_kick=True, rotor=SPLIT_ROTOR),
        preserves=_SYMPLECTIC,
        fails="fast asymmetric spins: the rotor itself is of order two",
        oscillation_limit=2.0,
        source="Dullweber, Leimkuhler, McLachlan, J. Chemical Physics 107:5840, 1997",
    ),
    "rkn4": Method(
        "six kicks and the exact rotor, order four",
        order=4,
        damped_order=2,
        scheme=Splitting(
            _in_turn(
                _closed(0.0829844064174052, 0.396309801498368, -0.0390563049223486),
                _doubled(0.245298957184271, 0.604872665711080),
            ),
            begins_with_kick=True,
        ),
        preserves=_SYMPLECTIC,
        fails=f"{_DAMPED_SPLITTING}; kinks; {_BANDS}",
        oscillation_limit=3.164,
        source=_BLANES_MOAN,
    ),
    "rkn6": Method(
        "fourteen kicks and the exact rotor, order six",
        order=6,
        damped_order=2,
        scheme=Splitting(
            _in_turn(
                _closed(
                    0.0378593198406116,
                    0.102635633102435,
                    -0.0258678882665587,
                    0.314241403071447,
                    -0.130144459517415,
                    0.106417700369543,
                    -0.00879424312851058,
                ),
                _doubled(
                    0.09171915262446165,
                    0.183983170005006,
                    -0.05653436583288827,
                    0.004914688774712854,
                    0.143761127168358,
                    0.328567693746804,
                ),
            ),
            begins_with_kick=False,
        ),
        preserves=_SYMPLECTIC,
        fails=f"{_DAMPED_SPLITTING}; kinks; {_BANDS}",
        oscillation_limit=3.141,
        source=_BLANES_MOAN,
    ),
    "aba864": Method(
        "seven kicks and the exact rotor: order eight in weak loads, four in strong ones",
        order=4,
        damped_order=2,
        scheme=Splitting(
            _in_turn(
                _doubled(0.0711334264982231177779, 0.241153427956640098736, 0.521411761772814789212),
                _closed(0.183083687472197221961, 0.310782859898574869508, -0.0265646185119588006972),
            ),
            begins_with_kick=False,
        ),
        preserves=_SYMPLECTIC,
        fails=f"{_DAMPED_SPLITTING}; kinks; {_BANDS}",
        oscillation_limit=3.143,
        source="Blanes, Casas, Farrés, Laskar, Makazaga, Murua, Applied Numerical Mathematics 68:58, 2013",
    ),
    "dop853_fixed": Method(
        "Dormand and Prince's Runge-Kutta of order eight in attitude and body angular momentum, equal steps",
        order=8,
        damped_order=8,
        scheme=RungeKutta(dop853.TABLEAU, dop853.WEIGHTS, flies_exactly=True),
        preserves="nothing exactly; the error is small enough not to matter for some thousand turns",
        fails="kinks; very long runs, where the energy drifts",
        oscillation_limit=5.96,
        source=_DORMAND_PRINCE,
    ),
    "dop853": Method(
        "Dormand and Prince's Runge-Kutta of order eight, steps by its own estimate of their error",
        order=8,
        damped_order=8,
        scheme=RungeKutta(dop853.TABLEAU, dop853.WEIGHTS, flies_exactly=True, estimators=(dop853.FIFTH, dop853.THIRD)),
        preserves="nothing exactly; the error is small enough not to matter for some thousand turns",
        fails="very long runs, where the energy drifts",
        oscillation_limit=5.96,
        source=_DORMAND_PRINCE,
    ),
    "lie_rk4": Method(
        "commutator-free Runge-Kutta of order four on the group of rotations",
        order=4,
        damped_order=4,
        scheme=LieRungeKutta(),
        preserves="the unit quaternion",
        fails="kinks; drifts in energy like rk4",
        oscillation_limit=_RK4_LIMIT,
        source="Celledoni, Marthinsen, Owren, Future Generation Computer Systems 19:341, 2003",
    ),
    "spiral": Method(
        "kick, drift, kick with a turn at constant rate, the gyroscopic term in the kick",
        order=2,
        damped_order=1,
        scheme=Splitting((0.5, 1.0, 0.5), begins_with_kick=True, rotor=CONSTANT_RATE),
        preserves="the unit quaternion",
        fails="dampers and drag bring it down to order one; drifts in energy",
        oscillation_limit=2.0,
        source="del Valle, Angelidakis, Roy, Muñoz, Pöschel, Computer Physics Communications 297:109077, 2024",
    ),
    "rk4": Method(
        "classical Runge-Kutta on the stacked state, angular momentum in body axes",
        order=4,
        damped_order=4,
        scheme=_RK4,
        preserves="nothing exactly; the energy of an oscillation decays",
        fails="long runs: it drifts",
        oscillation_limit=_RK4_LIMIT,
        source="Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, table II.1.2",
    ),
    "rk4_world": Method(
        "classical Runge-Kutta on the stacked state, angular velocity in world axes, quaternion left as it comes out",
        order=4,
        damped_order=4,
        scheme=replace(_RK4, is_world=True, normalizes=False),
        preserves="nothing",
        fails="long runs and fast spins: the quaternion leaves the unit sphere and the tensor with it",
        oscillation_limit=_RK4_LIMIT,
        source="Rigid body game physics, part 1, 24 October 2019",
    ),
    "semi_implicit_euler": Method(
        "velocities first, then positions with the new velocities; angular velocity in world axes",
        order=1,
        damped_order=1,
        scheme=RungeKutta(((),), (1.0,), is_world=True, is_symplectic_euler=True),
        preserves="the energy of an oscillation without spin, within bounds",
        fails="spins: the world-frame tensor makes it gain energy; order one",
        oscillation_limit=2.0,
        source="FEM for Rigid Body Dynamics: Quaternion-based Rotation Handling and Inertia Tensors, 20 April 2026",
    ),
    "euler": Method(
        "explicit Euler on the stacked state, angular momentum in body axes",
        order=1,
        damped_order=1,
        scheme=RungeKutta(((),), (1.0,)),
        preserves="nothing",
        fails="every oscillation grows, at every step",
        oscillation_limit=0.0,
        source="Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section I.7",
    ),
}
