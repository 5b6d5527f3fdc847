"""The noun that leaves this room: a state at an output time, in the axes and units its reader expects."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ContactBalance:
    """What contacts hold and have taken since the start, and what walls have brought in.

    elastic           : J, in the springs of all contacts
    damping, friction : J, taken since the start
    impulse           : (3,) N s, of the walls on the bodies
    angular_impulse   : (3,) N m s, of the walls and of the weight of the bodies that touch, about the world's origin
    """

    elastic: float
    damping: float
    friction: float
    impulse: NDArray[np.float64]
    angular_impulse: NDArray[np.float64]


@dataclass(frozen=True)
class Balance:
    """Energy and momentum of the whole scene at one time, and what its loads brought in since the start.

    kinetic, rotational : J, translation of the centres of mass and rotation about them
    gravity, elastic    : J, potential of the uniform field, and of the springs and contacts
    damping, friction   : J, taken by contacts since the start
    work                : J, done since the start by every load that has no potential (forces, dampers, drag)
    momentum            : (3,) kg m/s, of the bodies that are free
    angular_momentum    : (3,) kg m^2/s, free bodies about the world's origin, held bodies about their pivot
    impulse             : (3,) N s, of external loads and gravity on the free bodies since the start
    angular_impulse     : (3,) N m s, likewise, and of walls
    """

    kinetic: float
    rotational: float
    gravity: float
    elastic: float
    damping: float
    friction: float
    work: float
    momentum: NDArray[np.float64]
    angular_momentum: NDArray[np.float64]
    impulse: NDArray[np.float64]
    angular_impulse: NDArray[np.float64]

    @property
    def energy(self) -> float:
        return self.kinetic + self.rotational + self.gravity + self.elastic


@dataclass(frozen=True)
class Frame:
    """Where everything is at an output time.

    index            : 0, 1, 2, … of the frame in the series
    time             : s
    position         : (n, 3) m, centres of mass
    quaternion       : (n, 4) part axes -> world, scalar first, unit
    velocity         : (n, 3) m/s of the centres of mass
    angular_velocity : (n, 3) rad/s, world frame
    kinetic_energy   : (n,) J, translation and rotation of each body
    balance          : of the whole scene
    """

    index: int
    time: float
    position: NDArray[np.float64]
    quaternion: NDArray[np.float64]
    velocity: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    kinetic_energy: NDArray[np.float64]
    balance: Balance
