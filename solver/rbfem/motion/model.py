"""What the motion of bodies is computed from, as arrays of the shape the loops read.

Each body has a *reference point*: its centre of mass, or the pivot that holds it. Its axes are the principal axes of
inertia about that point, so the tensor is three moments. Everything a case says is brought to this form once, by scene.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Motion models, from nothing to everything. A body gets the smallest one that its scene needs.
FIXED, TRANSLATING, SPHERICAL, RIGID = 0, 1, 2, 3
MODEL_NAMES = ("fixed", "translating", "spherical", "rigid")

# Columns of a stacked state row: position and velocity of the reference point, attitude, and the rotational
# variable of the method: angular momentum in body axes, or angular velocity in world axes.
POSITION, QUATERNION, VELOCITY, SPIN, STATE_WIDTH = 0, 3, 7, 10, 13

# Columns of the flags of a Runge-Kutta method, see `rbfem.motion.methods.RungeKutta`.
IS_WORLD, IS_SYMPLECTIC_EULER, NORMALIZES, FLIES_EXACTLY = 0, 1, 2, 3

# Columns of a ledger row: work of loads without potential; impulse and angular impulse of external loads and gravity.
WORK, IMPULSE, ANGULAR_IMPULSE, LEDGER_WIDTH = 0, 1, 4, 7

# Columns of a wrench row, force and torque each: of all loads, of those that have no potential, of those from outside.
TOTAL, WITHOUT_POTENTIAL, EXTERNAL, WRENCH_WIDTH = 0, 6, 12, 18


class Bodies(NamedTuple):
    """model (n,) int64; mass (n,) kg; inverse_mass (n,) 1/kg, zero where the reference point cannot move;
    inverse_moments (n, 3) 1/(kg m^2), of the principal moments about the reference point; arm (n, 3) m, reference point
    to centre of mass in principal axes; first_load (n + 1,) rows of the load table that act on each body; is_pushed
    (n,) int64, whether anything but gravity at its centre of mass acts on it: only then has it a wrench and a ledger.
    """

    model: NDArray[np.int64]
    mass: NDArray[np.float64]
    inverse_mass: NDArray[np.float64]
    inverse_moments: NDArray[np.float64]
    arm: NDArray[np.float64]
    first_load: NDArray[np.int64]
    is_pushed: NDArray[np.int64]


class Islands(NamedTuple):
    """Bodies that a spring joins must step together. member: moving bodies, island by island; first: (k + 1,);
    is_damped: (k,) int64, whether a damper or a drag acts on any of them."""

    member: NDArray[np.int64]
    first: NDArray[np.int64]
    is_damped: NDArray[np.int64]


class Loads(NamedTuple):
    """The load table, sorted by body: see `rbfem.motion.loads` for the kinds and what `values` hold.

    kind (k,) int64; other (k,) int64, the body at a spring's far end or -1; is_external (k,) int64, whether its impulse
    counts as coming from outside; values (k, 9); ramp (k,) int64, a row of the ramps or -1; ramp_first (r + 1,);
    ramp_time, ramp_factor: breakpoints of all ramps, one after the other.
    """

    kind: NDArray[np.int64]
    other: NDArray[np.int64]
    is_external: NDArray[np.int64]
    values: NDArray[np.float64]
    ramp: NDArray[np.int64]
    ramp_first: NDArray[np.int64]
    ramp_time: NDArray[np.float64]
    ramp_factor: NDArray[np.float64]


class Scratch(NamedTuple):
    """Working memory of a step: stage and weighted sum of rates (n, 13), wrench (n, 18) and angular velocity in world
    axes (n, 3) of each body; rates of every stage (n, stages, 13), those of its ledger (n, stages, 7) and their
    weighted sum (n, 7); four vectors of six velocities of the solver of damped kicks (n, 4, 6); what the sums of
    the state have rounded off so far (n, 13), see `rbfem.motion.sums`."""

    stage: NDArray[np.float64]
    total: NDArray[np.float64]
    wrench: NDArray[np.float64]
    omega: NDArray[np.float64]
    rate: NDArray[np.float64]
    flow: NDArray[np.float64]
    flow_total: NDArray[np.float64]
    solver: NDArray[np.float64]
    rest: NDArray[np.float64]


def scratch_for(n_bodies: int, n_stages: int) -> Scratch:
    """Working memory for that many bodies and stages."""
    shapes = (STATE_WIDTH,), (STATE_WIDTH,), (WRENCH_WIDTH,), (3,), (n_stages, STATE_WIDTH), (n_stages, LEDGER_WIDTH)
    more = (LEDGER_WIDTH,), (4, 6), (STATE_WIDTH,)
    return Scratch(*[np.zeros((n_bodies, *shape)) for shape in (*shapes, *more)])
