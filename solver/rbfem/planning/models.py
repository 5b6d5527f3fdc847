"""How much of a body's motion a scene needs: the smallest motion model that carries it."""

import numpy as np
from numpy.typing import NDArray

from rbfem.contact.model import FRICTION, LAW, NONE
from rbfem.motion import loads as kinds
from rbfem.motion.model import FIXED, MODEL_NAMES, RIGID, SPHERICAL, TRANSLATING
from rbfem.planning.plan import ModelChoice
from rbfem.scene.scene import Scene

REASONS = {
    FIXED: "fixed in the case: nothing is computed",
    TRANSLATING: "no torque can act and it does not spin at the start: it never turns; three equations instead of six",
    SPHERICAL: "its three principal moments are equal: the tensor is a number and the gyroscopic term is zero",
    RIGID: "it spins or is turned, and its principal moments differ: the full tensor with the gyroscopic term",
}
HELD = "; held at its pivot, it keeps three degrees of freedom and the moments are about the pivot"
HELD_AT_REST = (
    "held at its pivot, it does not spin at the start and no torque about the pivot can act: it stays at rest"
)
NAMES_SHOWN = 5


def choose_models(scene: Scene) -> NDArray[np.int64]:
    """(n,) motion model of each body."""
    spins = np.linalg.norm(scene.angular_velocity, axis=1) > 0.0
    turns = spins | _can_be_turned(scene) | can_be_rubbed(scene)
    model = np.where(turns, np.where(_is_spherical(scene), SPHERICAL, RIGID), TRANSLATING)
    return np.where(scene.is_fixed, FIXED, model).astype(np.int64)


def _is_spherical(scene: Scene) -> NDArray[np.bool_]:
    """(n,) whether the moments are equal to within the error of the tensor."""
    moments = scene.reference.moments
    tolerance = 10.0 * scene.of_parts([part.inertia_error for part in scene.parts])
    return moments[:, 2] - moments[:, 0] <= tolerance * moments[:, 2]


def model_choices(scene: Scene, models: NDArray[np.int64]) -> tuple[ModelChoice, ...]:
    """The models in words, bodies of like model and reason together."""
    choices = []
    for model in (FIXED, TRANSLATING, SPHERICAL, RIGID):
        for held in (False, True):
            members = np.flatnonzero((models == model) & (scene.is_held == held))
            if len(members):
                names = tuple(scene.names[body] for body in members[:NAMES_SHOWN])
                reason = _reason(model, held)
                choices.append(ModelChoice(MODEL_NAMES[model], _ranges(members), len(members), names, reason))
    return tuple(choices)


def _reason(model: int, held: bool) -> str:
    if not held or model == FIXED:
        return REASONS[model]
    return HELD_AT_REST if model == TRANSLATING else REASONS[model] + HELD


def models_of(choices: tuple[ModelChoice, ...], n_bodies: int) -> NDArray[np.int64]:
    """(n,) motion model of each body, back from the choices of a plan."""
    models = np.full(n_bodies, RIGID)
    for choice in choices:
        for first, last in choice.bodies:
            models[first : last + 1] = MODEL_NAMES.index(choice.model)
    return models


def pushed(scene: Scene) -> NDArray[np.bool_]:
    """(n,) bodies on which something acts besides gravity at their centre of mass."""
    return (scene.first_load[1:] > scene.first_load[:-1]) | scene.is_held


def can_be_rubbed(scene: Scene) -> NDArray[np.bool_]:
    """(n,) bodies that touch with friction."""
    count = round(len(scene.laws) ** 0.5)
    rubs = ((scene.laws[:, LAW] != NONE) & (scene.laws[:, FRICTION] > 0.0)).reshape(count, count).any(axis=1)
    return scene.can_touch & rubs[scene.material]


def _can_be_turned(scene: Scene) -> NDArray[np.bool_]:
    """(n,) whether any load or the weight at a pivot's arm can have a torque about the reference point."""
    kind, values = scene.loads.kind, scene.loads.values
    has_lever = np.abs(values[:, 0:3]).max(axis=1, initial=0.0) > 0.0
    has_second = np.abs(values[:, 3:6]).max(axis=1, initial=0.0) > 0.0
    turning = (kind == kinds.COUPLE) & has_lever
    turning |= ((kind == kinds.FORCE) | (kind == kinds.WRENCH)) & has_second
    turning |= (kind == kinds.SPRING) & has_lever
    owners = _owners(scene)
    turning |= (kind == kinds.GRADIENT) & ~_is_spherical(scene)[owners]
    result = np.zeros(scene.n_bodies, dtype=bool)
    np.logical_or.at(result, owners, turning)
    has_weight = np.linalg.norm(scene.reference.arm, axis=1) * np.linalg.norm(scene.gravity) > 0.0
    return result | (scene.is_held & has_weight)


def _owners(scene: Scene) -> NDArray[np.int64]:
    return np.repeat(np.arange(scene.n_bodies), np.diff(scene.first_load))


def _ranges(members: NDArray[np.int64]) -> tuple[tuple[int, int], ...]:
    """Ascending indices as ranges, both ends included."""
    breaks = np.flatnonzero(np.diff(members) > 1)
    first, last = members[np.r_[0, breaks + 1]], members[np.r_[breaks, len(members) - 1]]
    return tuple((int(a), int(b)) for a, b in zip(first, last, strict=True))
