"""What contact is computed from, as arrays of the shape the loops read."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Laws of the normal and tangential force, the first column of a row of `Laws`.
NONE, LINEAR, HERTZ = -1, 0, 1
LAW_NAMES = {LINEAR: "linear", HERTZ: "hertz"}

# Columns of a row of laws, one for each pair of materials.
LAW, NORMAL, TANGENTIAL, DAMPING, FRICTION, LAW_WIDTH = 0, 1, 2, 3, 4, 5

# Columns of the memory of a contact: tangential elastic force in world axes, the approach speed that would follow if
# nothing but this contact acted, and the stiffness of the tangential spring at the step before.
SHEAR, FORETOLD, LAST_STIFFNESS, MEMORY_WIDTH = 0, 3, 4, 5

# Columns of what contacts have taken: by damping and by friction.
BY_DAMPING, BY_FRICTION, LOSS_WIDTH = 0, 1, 2


class Spheres(NamedTuple):
    """place (n, 4) m, centre and radius; rate (n, 6) m/s and rad/s in world axes, half a step before the place;
    inertia (n, 3) 1/kg and 1/(kg m^2) of mass and moment of inertia, zero for what cannot move, and kg; material (n,)
    int32.
    """

    place: NDArray[np.float64]
    rate: NDArray[np.float64]
    inertia: NDArray[np.float64]
    material: NDArray[np.int32]


class Pairs(NamedTuple):
    """Spheres that may touch, each pair once: those of sphere i, all later than i in the order, stand from first[i] on.

    first (n + 1,) int32; other (m,) int32; touches (m,) int8; memory (m, MEMORY_WIDTH)
    """

    first: NDArray[np.int32]
    other: NDArray[np.int32]
    touches: NDArray[np.int8]
    memory: NDArray[np.float64]


class WallPairs(NamedTuple):
    """Spheres and planes that may touch, and the planes.

    sphere (m,) int32; wall (m,) int32; touches (m,) int8; memory (m, MEMORY_WIDTH); plane (n_walls, 4): unit normal n
    towards the spheres, and d of n·x = d; material (n_walls,) int32
    """

    sphere: NDArray[np.int32]
    wall: NDArray[np.int32]
    touches: NDArray[np.int8]
    memory: NDArray[np.float64]
    plane: NDArray[np.float64]
    material: NDArray[np.int32]
