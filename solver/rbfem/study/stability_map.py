"""Where methods fail on a body that is sprung, damped and spins: how fast a small disturbance of it grows."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.model import RIGID, Bodies, Islands, Loads
from rbfem.motion.state import State, System, initial_state, make_islands, move

Array = NDArray[np.float64]

STEPS = 2000
LONGEST_BLOCK = 125  # steps from one look at the energies to the next; the first are shorter
GROWN = 100.0  # energy gained, times that of the disturbance: a step of one kick stays below it up to 1.99/ω_max
DISTURBANCE = 1e-3  # speed of the lever's tip, as a share of ω_max times the lever: small enough to be linear

# The body: a plate, which wobbles as fast as it spins; any would do that spins about the axis of its largest moment.
MASS, MOMENTS, LEVER = 1.0, np.array([1.0, 2.0, 3.0]) / 3.0, 1.0
FAR = 1e3  # length of the spring in levers: its direction stays the same


def growth(method: str, swing: Array, damping_ratio: Array, spin_ratio: Array, n_steps: int = STEPS) -> Array:
    """Growth per step of the disturbance of spinning bodies on damped springs, many of them at once.

    The body turns about its axis of largest inertia. A spring with a dashpot in line with it, parallel to that axis
    and very long, holds the tip of a lever across; undisturbed the body spins for ever and the spring rests. Then the
    motion is disturbed along the swing of the spring and watched for `STEPS` steps.

    It has grown when a body has gained more than `GROWN` times the energy of the disturbance, kinetic and elastic, or
    is no longer finite: nothing here can bring energy in, and a dashpot only takes it. Not seen is what grows less
    than that in so many steps.

    swing         : (n,) dt ω_max, ω_max² = k (1/m + (r×n)·I⁻¹(r×n))
    damping_ratio : (n,) ζ, share of the critical damping of that swing
    spin_ratio    : (n,) spin/ω_max
    returns       : (n,) ln of the factor by which the amplitude grows in a step; zero where it does not
    """
    system, quiet = spinning_bodies(swing, damping_ratio, spin_ratio)
    state = _disturbed(quiet, swing)
    start = _energy(system, state)
    allowed = GROWN * (start - _energy(system, quiet))
    found = np.zeros(len(swing))
    with np.errstate(all="ignore"):  # what grows may pass all numbers
        done = 0
        while done < n_steps and len(system.islands.member):
            block = min(max(done, 1), LONGEST_BLOCK, n_steps - done)
            state = move(state, 1.0, block, method, system, "serial")
            done += block
            gained = _energy(system, state) - start
            grown = ~(gained <= allowed) & (found == 0.0)
            ratio = np.where(np.isfinite(gained), gained, np.inf) / (allowed / GROWN)
            found[grown] = 0.5 * np.log(np.minimum(ratio[grown], 1e300)) / done
            system = replace(system, islands=_islands(system, np.flatnonzero(found == 0.0)))
    return found


def spinning_bodies(swing: Array, damping_ratio: Array, spin_ratio: Array) -> tuple[System, State]:
    """The bodies of `growth`, undisturbed, in units in which the step is 1 s."""
    n = len(swing)
    mobility = 1.0 / MASS + LEVER**2 / MOMENTS[1]  # of the tip, along the spring
    values = np.zeros((n, 9))
    values[:, 0], values[:, 5] = LEVER, FAR
    values[:, 6], values[:, 7] = swing**2 / mobility, 2.0 * damping_ratio * swing / mobility
    values[:, 8] = np.hypot(FAR, LEVER)
    each = np.arange(n + 1)
    none = np.zeros(0)
    loads = Loads(
        kind=np.full(n, kinds.SPRING),
        other=np.full(n, -1),
        is_external=np.ones(n, dtype=np.int64),
        values=values,
        ramp=np.full(n, -1),
        ramp_first=np.zeros(1, dtype=np.int64),
        ramp_time=none,
        ramp_factor=none,
    )
    bodies = Bodies(
        model=np.full(n, RIGID),
        mass=np.full(n, MASS),
        inverse_mass=np.full(n, 1.0 / MASS),
        inverse_moments=np.tile(1.0 / MOMENTS, (n, 1)),
        arm=np.zeros((n, 3)),
        first_load=each,
        is_pushed=np.ones(n, dtype=np.int64),
    )
    attitude = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    spin = np.outer(spin_ratio * swing, [0.0, 0.0, MOMENTS[2]])
    state = initial_state(np.zeros((n, 3)), attitude, np.zeros((n, 3)), spin)
    islands = make_islands(each[:-1], each, loads, each)
    return System(bodies, loads, islands, np.zeros(3)), state


def _islands(system: System, members: NDArray[np.int64]) -> Islands:
    """These bodies, each by itself: those that have grown are left alone."""
    return make_islands(members, np.arange(len(members) + 1), system.loads, system.bodies.first_load)


def _disturbed(state: State, swing: Array) -> State:
    """An impulse along the spring at the tip of the lever."""
    impulse = DISTURBANCE * LEVER * swing / (1.0 / MASS + LEVER**2 / MOMENTS[1])
    velocity = np.outer(impulse / MASS, [0.0, 0.0, 1.0])
    turn = np.outer(impulse, [0.0, -LEVER, 0.0])
    return replace(state, velocity=velocity, angular_momentum=state.angular_momentum + turn)


def _energy(system: System, state: State) -> Array:
    """(n,) kinetic and elastic energy."""
    bodies, values = system.bodies, system.loads.values
    kinetic = 0.5 * bodies.mass * (state.velocity**2).sum(axis=1)
    rotation = 0.5 * (state.angular_momentum**2 * bodies.inverse_moments).sum(axis=1)
    tip = state.position + quaternion.rotate(quaternion.normalize(state.quaternion), values[:, 0:3])
    stretch = np.linalg.norm(values[:, 3:6] - tip, axis=1) - values[:, 8]
    return kinetic + rotation + 0.5 * values[:, 6] * stretch**2
