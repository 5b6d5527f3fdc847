"""Bodies put together straight from the arrays of `rbfem.motion`, without a case file or a mesh."""

from dataclasses import dataclass, field, replace

import numpy as np

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.model import FIXED, RIGID, Bodies, Loads
from rbfem.motion.state import System, initial_state, make_islands

GRAVITY = np.array([0.0, 0.0, -9.81])
# Steel of 7750 kg/m^3, radius 0.05 m, height 0.15 m: mass 9.1302536495 kg; along the axis, across it.
CYLINDER_MASS = 7750.0 * np.pi * 0.05**2 * 0.15
CYLINDER_MOMENTS = CYLINDER_MASS * 0.05**2 / 2, CYLINDER_MASS * (0.05**2 / 4 + 0.15**2 / 12)


@dataclass(frozen=True)
class Load:
    """One row of the load table; values shorter than nine are filled up with zeros."""

    kind: int
    values: tuple
    ramp: tuple | None = None
    other: int = -1
    is_external: bool = True


@dataclass(frozen=True)
class Body:
    """A body; omega is in body axes. is_held: the reference point is a pivot, `arm` away from the centre of mass."""

    mass: float = 2.0
    moments: tuple = (1.0, 2.0, 2.5)
    position: tuple = (0.0, 0.0, 0.0)
    attitude: tuple = (1.0, 0.0, 0.0, 0.0)
    velocity: tuple = (0.0, 0.0, 0.0)
    omega: tuple = (0.0, 0.0, 0.0)
    arm: tuple = (0.0, 0.0, 0.0)
    is_held: bool = False
    model: int = RIGID
    loads: tuple = ()


@dataclass(frozen=True)
class Setting:
    """Bodies, gravity, and how long to watch them."""

    bodies: tuple
    gravity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    end: float = 1.0


def spring_between(a, at_a, b, at_b, stiffness, damping, rest_length):
    """The two rows of a spring: one on body a and one on body b."""
    law = (stiffness, damping, rest_length)
    near = Load(kinds.SPRING, (*at_a, *at_b, *law), other=b, is_external=False)
    far = Load(kinds.SPRING, (*at_b, *at_a, *law), other=a, is_external=False)
    return near, far


def build(setting, is_pushed=None):
    """System and initial state of a setting; is_pushed=True sends every body through the general stepper."""
    bodies = setting.bodies
    rows = [load for body in bodies for load in body.loads]
    ramps = [load.ramp for load in rows if load.ramp is not None]
    points = np.array([point for ramp in ramps for point in ramp], dtype=float).reshape(-1, 2)
    values = np.zeros((len(rows), 9))
    for row, load in enumerate(rows):
        values[row, : len(load.values)] = load.values
    loads = Loads(
        kind=np.array([load.kind for load in rows], dtype=np.int64),
        other=np.array([load.other for load in rows], dtype=np.int64),
        is_external=np.array([load.is_external for load in rows], dtype=np.int64),
        values=values,
        ramp=np.array([ramps.index(load.ramp) if load.ramp else -1 for load in rows], dtype=np.int64),
        ramp_first=np.cumsum([0, *map(len, ramps)], dtype=np.int64),
        ramp_time=np.ascontiguousarray(points[:, 0]),
        ramp_factor=np.ascontiguousarray(points[:, 1]),
    )
    moments = np.array([body.moments for body in bodies], dtype=float)
    mass = np.array([body.mass for body in bodies])
    moves = np.array([not body.is_held and body.model != FIXED for body in bodies])
    pushed = [bool(body.loads) or body.is_held if is_pushed is None else is_pushed for body in bodies]
    arrays = Bodies(
        model=np.array([body.model for body in bodies], dtype=np.int64),
        mass=mass,
        inverse_mass=np.where(moves, 1.0 / mass, 0.0),
        inverse_moments=1.0 / moments,
        arm=np.array([body.arm for body in bodies], dtype=float),
        first_load=np.cumsum([0, *[len(body.loads) for body in bodies]], dtype=np.int64),
        is_pushed=np.array(pushed, dtype=np.int64),
    )
    attitude = quaternion.normalize(np.array([body.attitude for body in bodies], dtype=float))
    state = initial_state(
        np.array([body.position for body in bodies], dtype=float),
        attitude,
        np.array([body.velocity for body in bodies], dtype=float),
        np.array([body.omega for body in bodies]) * moments,
    )
    islands = islands_of(bodies, loads, arrays.first_load)
    return System(arrays, loads, islands, np.asarray(setting.gravity, dtype=float)), state


def islands_of(bodies, loads, first_load):
    """Moving bodies one by one, or all in one island where springs join them."""
    moving = np.array([i for i, body in enumerate(bodies) if body.model != FIXED], dtype=np.int64)
    if any(load.other >= 0 for body in bodies for load in body.loads):
        return make_islands(moving, np.array([0, len(moving)], dtype=np.int64), loads, first_load)
    return make_islands(moving, np.arange(len(moving) + 1), loads, first_load)


def heavy_top():
    """Géradin and Cardona's top, held at its tip: the moments are those about the tip."""
    body = Body(
        mass=15.0,
        moments=(15.234375, 0.46875, 15.234375),
        omega=(0.0, 150.0, -4.61538),
        arm=(0.0, 1.0, 0.0),
        is_held=True,
    )
    return Setting((body,), GRAVITY, end=0.1)


def sprung_box():
    """A box that hangs by a corner on a damped spring and swings under gravity."""
    spring = Load(kinds.SPRING, (0.3, 0.2, 0.1, 0.2, -0.1, 1.5, 60.0, 1.5, 0.8))
    body = Body(omega=(0.5, -1.0, 2.0), velocity=(0.3, 0.0, -0.2), attitude=(0.9, 0.1, -0.2, 0.3), loads=(spring,))
    return Setting((body,), GRAVITY, end=0.8)


def swinging_box():
    """The same without the damper."""
    setting = sprung_box()
    (spring,) = setting.bodies[0].loads
    undamped = replace(spring, values=(*spring.values[:7], 0.0, spring.values[8]))
    return replace(setting, bodies=(replace(setting.bodies[0], loads=(undamped,)),))


def box_in_drag():
    """A tumbling box in a viscous fluid, pushed by a thrust that turns with it and by a ramped force at a corner."""
    loads = (
        Load(kinds.DRAG, (1.5, 0.7)),
        Load(kinds.WRENCH, (2.0, 0.5, -1.0, 0.3, -0.4, 0.8)),
        Load(kinds.FORCE, (1.0, -2.0, 3.0, 0.2, 0.1, -0.3), ramp=((0.0, 0.2), (4.0, 2.0))),
        Load(kinds.COUPLE, (0.4, 0.3, -0.2)),
    )
    return Setting((Body(omega=(3.0, -2.0, 1.0), velocity=(1.0, 2.0, -0.5), loads=loads),), GRAVITY, end=1.0)


def two_sprung_boxes():
    """Two boxes joined at their corners by a damped spring; the second is held at a pivot and hangs."""
    near, far = spring_between(0, (0.2, 0.1, 0.0), 1, (0.0, 0.1, 0.2), 40.0, 0.8, 0.5)
    free = Body(position=(0.0, 0.0, 1.0), omega=(1.0, 2.0, 0.5), loads=(near,))
    held = Body(3.0, (2.0, 1.5, 2.2), (0.9, 0.0, 0.8), omega=(0.0, 1.0, 0.0), arm=(0.1, 0.0, -0.3), loads=(far,))
    return Setting((free, replace(held, is_held=True)), GRAVITY, end=0.8)


def satellite():
    """A body that tumbles in the gradient of a central field, on an orbit that is inclined to all axes."""
    field = Load(kinds.GRADIENT, (2.0, 0.6, 0.0, 0.8, 0.48, 0.8, -0.36))
    return Setting((Body(omega=(0.5, -1.0, 2.0), attitude=(0.9, 0.1, -0.2, 0.3), loads=(field,)),), end=1.0)


def forced_cylinder():
    """A cylinder under a constant torque along its own axis: body axis 1."""
    axial, across = CYLINDER_MOMENTS
    torque = Load(kinds.WRENCH, (0.0, 0.0, 0.0, 0.025, 0.0, 0.0))
    body = Body(CYLINDER_MASS, (axial, across, across), omega=(0.3, -0.9, 0.6), loads=(torque,))
    return Setting((body,), end=0.7)
