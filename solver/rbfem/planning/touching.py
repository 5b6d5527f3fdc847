"""How long contacts last, and the step that follows from it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.contact.damping import restitution_of
from rbfem.contact.laws import normal_stiffness
from rbfem.contact.model import DAMPING, HERTZ, LAW, NONE, NORMAL, TANGENTIAL
from rbfem.contact.neighbours import list_pairs
from rbfem.errors import InputError
from rbfem.motion.state import kernel_of
from rbfem.scene.scene import Scene

HERTZ_DURATION = 2.943  # δ_max/v of an elastic impact by Hertz's law; K. L. Johnson, Contact Mechanics, 1985, eq. 11.24

# Error of the restitution e at so many steps a contact, 2e-3 down to e = 0.5 and as (0.5/e)^1.4 below: measured,
# docs/contact.md. It falls with the square of the step; with Hertz's law only down to 3e-4, and then with the step.
STEPS, ERROR, HALF, STEEPER = 20.0, 2e-3, 0.5, 1.4
STEEP = 0.1  # cosine between a wall's normal and the vertical: onto steeper ones nothing falls
FEWEST_STEPS, MOST_STEPS = 12.0, 200.0


@dataclass(frozen=True)
class Quickest:
    """duration: s, of the shortest contact; limit: s, longest stable step in a packing; speed: m/s, expected at most;
    error: of the restitution at STEPS a contact."""

    duration: float
    limit: float
    speed: float
    error: float


def quickest(scene: Scene) -> Quickest:
    """Over all pairs of materials that meet, the lightest and smallest spheres of each.

    Linear law: π √(m*/k). Hertz: 2.943 δ/v with the overlap δ = (15 m* v²/(16 E* √R*))^(2/5) of the highest speed
    expected. A sphere between twelve others that move against it swings with
    ω² = 2 (4 k_n + 8 k_t)/m or, turning, 16 k_t R²/I, whichever is larger: the limit is 2/ω.
    """
    speed = highest_speed(scene)
    radius, mass, moment = scene.bounding_radius, scene.mass, scene.reference.moments[:, 0]
    moves = scene.can_touch & ~scene.is_fixed
    count = round(len(scene.laws) ** 0.5)
    smallest = {m: np.flatnonzero(moves & (scene.material == m)) for m in range(count)}
    fixed = {*scene.material[scene.can_touch & scene.is_fixed].tolist(), *scene.walls.material.tolist()}
    duration, limit = np.inf, np.inf
    for a, members in smallest.items():
        if not len(members):
            continue
        i = members[np.argmin(mass[members])]
        for b in range(count):
            law = scene.laws[a * count + b]
            if law[LAW] == NONE:
                continue
            others = smallest[b][smallest[b] != i]
            partners = [(mass[j], radius[j]) for j in others[np.argsort(mass[others])[:1]]]
            partners += [(np.inf, np.inf)] if b in fixed else []
            for other_mass, other_radius in partners:
                m, r = 1.0 / (1.0 / mass[i] + 1.0 / other_mass), 1.0 / (1.0 / radius[i] + 1.0 / other_radius)
                stiffness, shear, lasts = _stiffness_and_duration(law, m, r, speed)
                swing = max(2.0 * (4.0 * stiffness + 8.0 * shear) / mass[i], 16.0 * shear * radius[i] ** 2 / moment[i])
                duration, limit = min(duration, lasts), min(limit, 2.0 / swing**0.5)
    ratio = float(scene.laws[scene.laws[:, LAW] != NONE, DAMPING].max())
    error = ERROR * max(1.0, (HALF / restitution_of(ratio)) ** STEEPER)
    return Quickest(float(duration), float(limit), speed, error)


def _stiffness_and_duration(law: NDArray[np.float64], mass: float, radius: float, speed: float):
    if law[LAW] != HERTZ:
        return law[NORMAL], law[TANGENTIAL], np.pi * np.sqrt(mass / law[NORMAL])
    overlap = (15.0 * mass * speed**2 / (16.0 * law[NORMAL] * np.sqrt(radius))) ** 0.4
    contact_radius = np.sqrt(radius * overlap)
    tangent = 1.5 * normal_stiffness(HERTZ, law[NORMAL], overlap, radius)  # dF/dδ
    return tangent, 8.0 * law[TANGENTIAL] * contact_radius, HERTZ_DURATION * overlap / speed


def highest_speed(scene: Scene) -> float:
    """What spheres have at the start and gain by falling through the height of the scene, m/s; not less than by falling
    through a radius, or than one radius in the run where there is no gravity."""
    touching = scene.can_touch
    speed = np.linalg.norm(scene.velocity[touching], axis=1).max(initial=0.0)
    spin = (np.linalg.norm(scene.angular_velocity[touching], axis=1) * scene.bounding_radius[touching]).max(initial=0.0)
    gravity = float(np.linalg.norm(scene.gravity))
    radius = float(scene.bounding_radius[touching].max(initial=0.0))
    height = _height(scene) + radius
    return float(max(speed + spin, radius / scene.end_time) + np.sqrt(2.0 * gravity * height))


def _height(scene: Scene) -> float:
    """How deep a sphere can fall: to the lowest sphere, or onto a wall that faces gravity."""
    gravity = float(np.linalg.norm(scene.gravity))
    if gravity == 0.0:
        return 0.0
    down, position = scene.gravity / gravity, scene.position[scene.can_touch]
    deepest = float(np.ptp(position @ down))
    for plane in scene.walls.plane:
        facing = float(-plane[:3] @ down)
        if facing > STEEP:
            deepest = max(deepest, float((position @ plane[:3] - plane[3]).max()) / facing)
    return deepest


def refuse_contact(scene: Scene, what: str) -> None:
    """Raises InputError for a scene whose bodies touch: what is asked for knows smooth motion only."""
    if scene.can_touch.any():
        raise InputError(
            f"{scene.name}: bodies touch, and rbfem {what} knows smooth motion only in this version; leave `contacts` "
            "out to see the motion between the contacts"
        )


def kernel_for(scene: Scene, method: str) -> Callable:
    """A loop that is compiled when a run of this scene is."""
    return list_pairs if scene.can_touch.any() else kernel_of(method)


def step_for(accuracy: float, fastest: Quickest) -> float:
    """The step whose error of the restitution is the accuracy, within what is stable and useful."""
    steps = STEPS * (fastest.error / accuracy) ** 0.5
    return min(fastest.duration / min(MOST_STEPS, max(FEWEST_STEPS, steps)), 0.5 * fastest.limit)


def restitution_error(step: float, fastest: Quickest) -> float:
    """Expected error of the restitution, as a share of it."""
    return fastest.error * (STEPS * step / fastest.duration) ** 2
