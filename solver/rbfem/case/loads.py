"""What a case may say of loads."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo, field_validator

from rbfem.case.quantity import Quantity, Vector
from rbfem.case.sections import RAMP_MEANING, Frame, Point, Ramp, Section, Text, Vec3, group_or_value, kind_of
from rbfem.case.units import (
    ANGULAR_DAMPING,
    ANGULAR_VELOCITY,
    DAMPING,
    FORCE,
    LENGTH,
    NUMBER,
    PRESSURE,
    STIFFNESS,
    TORQUE,
)
from rbfem.case.wording import shown

RIGHT_ANGLE = 1e-12  # largest cosine: what the rounding of two directions written with all their digits leaves


class ForceLoad(Section):
    """A force at a point."""

    kind: ClassVar[str] = "force"
    force: Annotated[Vec3, Vector(FORCE)] = Field(description="Force.")
    at: Point | None = Field(
        default=None, description="Where it acts, in the shape's own coordinates; centre of mass if absent."
    )
    frame: Frame = Field(default="world", description="Axes of the force: `body` turns with the body.")
    ramp: Ramp | None = Field(default=None, description=RAMP_MEANING)


class TorqueLoad(Section):
    """A pure torque."""

    kind: ClassVar[str] = "torque"
    torque: Annotated[Vec3, Vector(TORQUE)] = Field(description="Torque.")
    frame: Frame = Field(default="world", description="Axes of the torque: `body` turns with the body.")
    ramp: Ramp | None = Field(default=None, description=RAMP_MEANING)


class PressureLoad(Section):
    """A pressure on a part of the surface; it follows the body."""

    kind: ClassVar[str] = "pressure"
    pressure: Annotated[float, Quantity(PRESSURE)] = Field(description="Pressure; positive pushes inward.")
    on: Text = Field(description="Name of a surface group of the mesh.")
    ramp: Ramp | None = Field(default=None, description=RAMP_MEANING)


class TractionLoad(Section):
    """A force per area on a part of the surface, in the axes of the body."""

    kind: ClassVar[str] = "traction"
    traction: Annotated[Vec3, Vector(PRESSURE)] = Field(description="Force per area, in the axes of the body.")
    on: Text = Field(description="Name of a surface group of the mesh.")
    ramp: Ramp | None = Field(default=None, description=RAMP_MEANING)


class PointOfBody(Section):
    """A point that moves with another body."""

    body: Text = Field(description="Name of the other body; copies are NAME.00, NAME.01, …")
    at: Point | None = Field(
        default=None, description="Point in that body's shape coordinates; centre of mass if absent."
    )


class Spring(Section):
    """A linear spring with a damper along it."""

    at: Point | None = Field(
        default=None, description="Where it is fastened, in the shape's own coordinates; centre of mass if absent."
    )
    to: Annotated[
        Annotated[Vec3, Vector(LENGTH), Tag("<value>")] | Annotated[PointOfBody, Tag("<group>")],
        Discriminator(group_or_value),
    ] = Field(description="The other end: a world point, or {body: NAME, at: [x, y, z]}.")
    stiffness: Annotated[float, Quantity(STIFFNESS, at_least=0.0)] = Field(description="Force per elongation.")
    damping: Annotated[float, Quantity(DAMPING, at_least=0.0)] = Field(
        default=0.0, description="Force per speed of elongation."
    )
    rest_length: Annotated[float, Quantity(LENGTH, at_least=0.0)] = Field(
        default=0.0, description="Length without force."
    )


class SpringLoad(Section):
    """A spring to a point of the world or of another body."""

    kind: ClassVar[str] = "spring"
    spring: Spring = Field(description="Spring and damper along the line between its ends.")


class Drag(Section):
    """Resistance in proportion to the motion."""

    linear: Annotated[float, Quantity(DAMPING, at_least=0.0)] = Field(
        default=0.0, description="Force against the velocity of the centre of mass, per velocity."
    )
    angular: Annotated[float, Quantity(ANGULAR_DAMPING, at_least=0.0)] = Field(
        default=0.0, description="Torque against the angular velocity, per angular velocity."
    )


class DragLoad(Section):
    """Linear drag."""

    kind: ClassVar[str] = "drag"
    drag: Drag = Field(description="Resistance in proportion to velocity and angular velocity.")


def _direction(vector: Vec3) -> Vec3:
    """Of length 1."""
    length = math.hypot(*vector)
    if length == 0.0:
        raise ValueError(f"expected a direction (it is scaled to length 1), read {shown(vector)}, which has no length")
    return vector[0] / length, vector[1] / length, vector[2] / length


Direction = Annotated[Vec3, Vector(NUMBER), AfterValidator(_direction)]


class GravityGradient(Section):
    """The turning part of a central field, on a body whose orbit is a circle."""

    rate: Annotated[float, Quantity(ANGULAR_VELOCITY, above=0.0)] = Field(
        description="Angular velocity of the orbit; √(GM/r³) for a mass M at the distance r."
    )
    normal: Direction = Field(
        description="Axis of the orbit, world axes, along its angular momentum; scaled to length 1."
    )
    start: Direction = Field(
        description="From the centre of attraction to the body at t = 0, world axes, at right angles to `normal`; "
        "scaled to length 1."
    )

    @field_validator("start")
    @classmethod
    def _across_the_normal(cls, start: Vec3, info: ValidationInfo) -> Vec3:
        if "normal" not in info.data:  # refused already
            return start
        cosine = sum(a * b for a, b in zip(start, info.data["normal"], strict=True))
        if abs(cosine) > RIGHT_ANGLE:
            raise ValueError(
                f"expected a direction at right angles to `normal`, read one at {_degrees(cosine)} to it; the orbit "
                "lies across its normal, so take a direction across it, with all its digits"
            )
        return start


def _degrees(cosine: float) -> str:
    return f"{math.degrees(math.acos(max(-1.0, min(1.0, cosine)))):.12g} deg"


class GravityGradientLoad(Section):
    """The torque of a central field on a body in a circular orbit; the orbit itself is not computed, the body stays."""

    kind: ClassVar[str] = "gravity_gradient"
    gravity_gradient: GravityGradient = Field(
        description="Torque 3 n² r̂ × (I r̂), r̂ turning at the rate n; for a free body, which stays where it is."
    )


Load = Annotated[
    Annotated[ForceLoad, Tag("<force>")]
    | Annotated[TorqueLoad, Tag("<torque>")]
    | Annotated[PressureLoad, Tag("<pressure>")]
    | Annotated[TractionLoad, Tag("<traction>")]
    | Annotated[SpringLoad, Tag("<spring>")]
    | Annotated[DragLoad, Tag("<drag>")]
    | Annotated[GravityGradientLoad, Tag("<gravity_gradient>")],
    kind_of("force", "torque", "pressure", "traction", "spring", "drag", "gravity_gradient"),
]
