"""Spheres that touch nothing at the start: random places drawn anew until they are free."""

import numpy as np
from numpy.typing import NDArray

from rbfem.contact.model import LAW, NONE
from rbfem.scene.contacts import Contacts

Array = NDArray[np.float64]

LEAST_ROUNDS, MOST_LOOKS = 200, 2_000_000  # rounds of drawing; and spheres looked at in all of them, some seconds
ROUNDING = 1e-12  # of the reach: spheres set side by side touch without overlap


def overlapping(position: Array, radius: Array, contacts: Contacts) -> NDArray[np.int64]:
    """(k, 2) pairs of spheres whose materials meet and that overlap, the later one second."""
    from scipy.spatial import cKDTree

    members = np.flatnonzero(contacts.can_touch)
    if len(members) < 2:
        return np.zeros((0, 2), dtype=np.int64)
    pairs = members[cKDTree(position[members]).query_pairs(2.0 * radius[members].max(), output_type="ndarray")]
    distance = np.linalg.norm(position[pairs[:, 0]] - position[pairs[:, 1]], axis=1)
    count = round(len(contacts.laws) ** 0.5)
    rows = contacts.material[pairs[:, 0]] * count + contacts.material[pairs[:, 1]]
    touch = (distance < radius[pairs].sum(axis=1) * (1.0 - ROUNDING)) & (contacts.laws[rows, LAW] != NONE)
    return np.sort(pairs[touch], axis=1)


def in_walls(position: Array, radius: Array, contacts: Contacts) -> NDArray[np.int64]:
    """(k, 2) spheres and the walls that they overlap."""
    plane = contacts.walls.plane
    height = position @ plane[:, :3].T - plane[:, 3]
    count = round(len(contacts.laws) ** 0.5)
    rows = contacts.material[:, None] * count + contacts.walls.material[None, :]
    meets = contacts.can_touch[:, None] & (contacts.laws[rows, LAW] != NONE)
    return np.argwhere(meets & (height < radius[:, None] * (1.0 - ROUNDING)))


def spread(position: Array, radius: Array, contacts: Contacts, boxes: Array, seed: int) -> Array:
    """Positions in which no sphere that has a box overlaps another or a wall, as far as that can be had.

    boxes : (n, 2, 3) m, lowest and highest corner in which the centre of each may be drawn anew; NaN for one that is
            where it is
    Each round draws anew those in walls and, of two that overlap, the one that was drawn later; those that have found a
    place keep it, until all have or hope is lost.
    """
    random, position = np.random.default_rng([seed, len(position)]), position.copy()
    may_move = ~np.isnan(boxes[:, 0, 0])
    drawn = np.where(may_move, 1, 0)  # in which round, for the last time
    for turn in range(2, 2 + max(LEAST_ROUNDS, MOST_LOOKS // len(position))):
        pairs = overlapping(position, radius, contacts)
        later = np.where(drawn[pairs[:, 0]] > drawn[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
        again = np.unique(np.concatenate([later, in_walls(position, radius, contacts)[:, 0]]))
        again = again[may_move[again]]
        drawn[again] = turn
        if not len(again):
            break
        position[again] = random.uniform(boxes[again, 0], boxes[again, 1])
    return position
