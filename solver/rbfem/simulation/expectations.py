"""What a case knows about its answer, held against a frame."""

from dataclasses import dataclass

import numpy as np

from rbfem.motion import quaternion
from rbfem.scene.scene import Expectation, Scene
from rbfem.simulation.frame import Frame


@dataclass(frozen=True)
class ExpectationResult:
    """expectation, the value found, its error (Euclidean norm of the difference; of two quaternions, whichever sign is
    nearer), and whether it is within the tolerance."""

    expectation: Expectation
    found: np.ndarray
    error: float
    passed: bool


def check_expectation(expectation: Expectation, scene: Scene, frame: Frame) -> ExpectationResult:
    """Compare a frame at the time of an expectation with it."""
    found = np.asarray(_found(expectation, scene, frame), dtype=float)
    error = float(np.linalg.norm(found - expectation.value))
    if expectation.name == "quaternion":
        error = min(error, float(np.linalg.norm(found + expectation.value)))
    return ExpectationResult(expectation, found, error, bool(error <= expectation.tolerance))


def _found(expectation: Expectation, scene: Scene, frame: Frame):
    if expectation.body is None:
        return _total(expectation.name, scene, frame)
    body, name = expectation.body, expectation.name
    part = scene.parts[scene.part_of[body]]
    if name == "angular_velocity_body":
        return quaternion.rotate_back(frame.quaternion[body], frame.angular_velocity[body])
    if name == "center_of_mass":
        return -part.origin
    if name in ("mass", "principal_moments"):
        return getattr(part, name)
    return getattr(frame, name)[body]


def _total(name: str, scene: Scene, frame: Frame):
    if name == "center_of_mass":
        return scene.mass @ frame.position / scene.mass.sum()
    return getattr(frame.balance, name)
