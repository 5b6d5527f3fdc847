"""Which methods fit a scene, and what its loads are like."""

import math

import numpy as np

from rbfem.motion import loads as kinds
from rbfem.motion.methods import METHODS
from rbfem.motion.model import FIXED
from rbfem.planning.frequencies import Frequencies
from rbfem.planning.models import choose_models, pushed
from rbfem.scene.scene import Scene

WEAK = 0.1  # swing by spin, below which torques are weak
STIFF = 1000  # swings in the run, above which a scene is called stiff


def applicable_methods(scene: Scene) -> dict[str, str]:
    """Every method of the table: the empty string where it applies, else the reason why it does not."""
    is_free = not moved_by_loads(scene)
    return {name: _objection(name, is_free) for name in METHODS}


def moved_by_loads(scene: Scene) -> bool:
    """Whether anything but gravity at its centre of mass acts on any body that moves."""
    return bool((pushed(scene) & (choose_models(scene) != FIXED)).any())


def is_damped(scene: Scene) -> bool:
    """Whether any load depends on the velocity."""
    kind = scene.loads.kind
    return bool(((kind == kinds.DRAG) | ((kind == kinds.SPRING) & (scene.loads.values[:, 7] != 0.0))).any())


def is_weakly_turned(fastest: Frequencies) -> bool:
    """Whether bodies spin so much faster than their loads swing them that the loads are a small disturbance."""
    return 0.0 < fastest.oscillation < WEAK * fastest.spin


def character(scene: Scene, fastest: Frequencies) -> str:
    """What the loads are like, in words, for the plan."""
    if not moved_by_loads(scene):
        return "nothing but a uniform field acts"
    words = ["dissipative: dampers or drag take energy" if is_damped(scene) else "no load depends on the velocity"]
    if np.any((scene.loads.ramp >= 0) | (scene.loads.kind == kinds.GRADIENT)):
        words.append("loads change with time")
    if is_weakly_turned(fastest):
        words.append(f"weakly turned: the spin is {fastest.spin / fastest.oscillation:.2g} times the swing")
    swings = fastest.oscillation * scene.end_time / (2.0 * math.pi)
    if swings > STIFF:
        words.append(f"stiff: up to {swings:.2g} swings in the run")
    return ", ".join(words)


def _objection(name: str, is_free: bool) -> str:
    row = METHODS[name]
    if row.needs_free_bodies and not is_free:
        return "loads act, and it has no place for them"
    if is_free and row.flies_exactly and not row.needs_free_bodies:
        return "without loads it is the same as exact"
    return ""
