"""The noun of this room: what will be computed and why. Data: it can be read, edited, stored and run again."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class ModelChoice:
    """A motion model for some bodies.

    model  : one of `rbfem.motion.model.MODEL_NAMES`
    bodies : ranges (first, last) of body indices, last included
    count  : how many bodies
    names  : the first few of their names
    reason : why no less and no more
    """

    model: str
    bodies: tuple[tuple[int, int], ...]
    count: int
    names: tuple[str, ...]
    reason: str


@dataclass(frozen=True)
class Choice:
    """A value, why it was chosen, what error it is expected to bring and what it costs, in words."""

    value: Any
    reason: str
    error: str = ""
    cost: str = ""


@dataclass(frozen=True)
class Plan:
    """Every choice for one scene.

    models     : the motion model of every body
    contact    : which pairs can meet: none in this version
    method     : a row of `rbfem.motion.methods.METHODS`
    step       : s, the longest step; spans between stops are cut into equal steps no longer than this; None where the
                 method needs none
    step_limit : s, the longest step that the method is let take on this scene, or None where nothing limits it
    tolerance  : local error of an adaptive method, or None
    order      : by which the error falls with the step, as the pilot found it or the table states it; 0 without a step
    pilot      : evaluations that the choice has cost, and what it found; 0 where nothing had to be tried
    verify     : how many times longer the steps of the companion run are that estimates the error; 0 without one
    redo       : whether the run may be done again, finer, where the estimate is above the error accepted
    backend    : "python", "serial" or "parallel", see `rbfem.compute.loops`
    output     : what is written
    accuracy   : the error the user accepts
    left_out   : what the scene's owner might have expected and will not find
    warnings   : what was repaired in the meshes, what may be wrong with them, and a given step close to its limit
    """

    case: str
    n_bodies: int
    models: tuple[ModelChoice, ...]
    contact: Choice
    method: Choice
    step: Choice
    step_limit: Choice
    tolerance: Choice
    order: float
    pilot: Choice
    verify: Choice
    redo: bool
    backend: Choice
    output: Choice
    accuracy: float
    left_out: tuple[str, ...]
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries and lists, for JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Plan:
        """The plan that `to_dict` wrote, also after a way through JSON.

        >>> choice = Choice(1, "because")
        >>> plan = Plan("x", 0, (), *[choice] * 5, 4.0, choice, choice, True, *[choice] * 2, 1e-3, (), ())
        >>> Plan.from_dict(plan.to_dict()) == plan
        True
        """
        models = tuple(
            ModelChoice(**{**one, "bodies": tuple(tuple(span) for span in one["bodies"]), "names": tuple(one["names"])})
            for one in data["models"]
        )
        choices = {key: Choice(**value) for key, value in data.items() if isinstance(value, dict)}
        return cls(
            **{
                **data,
                **choices,
                "models": models,
                "left_out": tuple(data["left_out"]),
                "warnings": tuple(data["warnings"]),
            }
        )
