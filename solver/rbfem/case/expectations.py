"""What a case may say of its answer."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, ValidationInfo, WithJsonSchema, field_validator

from rbfem.case.quantity import Quantity, Vector
from rbfem.case.sections import Section, Text
from rbfem.case.units import (
    ANGULAR_MOMENTUM,
    ANGULAR_VELOCITY,
    ENERGY,
    LENGTH,
    MASS,
    MOMENT_OF_INERTIA,
    MOMENTUM,
    NUMBER,
    TIME,
    VELOCITY,
    Dimension,
)
from rbfem.case.wording import did_you_mean, shown

QUANTITIES_OF_A_BODY: dict[str, tuple[Dimension, int]] = {
    "position": (LENGTH, 3),
    "velocity": (VELOCITY, 3),
    "quaternion": (NUMBER, 4),
    "angular_velocity": (ANGULAR_VELOCITY, 3),
    "angular_velocity_body": (ANGULAR_VELOCITY, 3),
    "mass": (MASS, 1),
    "center_of_mass": (LENGTH, 3),
    "principal_moments": (MOMENT_OF_INERTIA, 3),
}
QUANTITIES_IN_TOTAL: dict[str, tuple[Dimension, int]] = {
    "energy": (ENERGY, 1),
    "kinetic": (ENERGY, 1),
    "rotational": (ENERGY, 1),
    "work": (ENERGY, 1),
    "momentum": (MOMENTUM, 3),
    "angular_momentum": (ANGULAR_MOMENTUM, 3),
    "center_of_mass": (LENGTH, 3),
}


def _quantity(value: str) -> str:
    start, _, rest = value.partition(".")
    owner, _, name = rest.rpartition(".")
    if start == "bodies" and owner:
        known = QUANTITIES_OF_A_BODY
    elif start == "total" and not owner:
        known = QUANTITIES_IN_TOTAL
    else:
        raise ValueError(f"expected bodies.NAME.QUANTITY or total.QUANTITY, read {shown(value)}")
    if name not in known:
        raise ValueError(f"no quantity {shown(name)}{did_you_mean(name, known)}")
    return value


class Expect(Section):
    """A number that is known about the answer: `rbfem run` checks it."""

    quantity: Annotated[str, AfterValidator(_quantity)] = Field(
        description=f"`bodies.NAME.` and one of {', '.join(QUANTITIES_OF_A_BODY)}; "
        f"or `total.` and one of {', '.join(QUANTITIES_IN_TOTAL)}."
    )
    at: Annotated[float, Quantity(TIME, at_least=0.0)] | None = Field(
        default=None, description="When; `time.end` if absent."
    )
    value: Annotated[
        float | tuple[float, ...],
        WithJsonSchema({"type": ["number", "string", "array"], "items": {"type": ["number", "string"]}}),
    ] = Field(
        description="The value that is known: a number, or a list of as many as the quantity has, in its SI unit."
    )
    tolerance: Annotated[float, WithJsonSchema({"type": ["number", "string"], "exclusiveMinimum": 0.0})] = Field(
        description="The largest difference that passes, in the unit of the value."
    )
    source: Text = Field(description="Where the value is known from.")

    @field_validator("value", mode="plain")
    @classmethod
    def _value_of_the_quantity(cls, value: object, info: ValidationInfo) -> object:
        if "quantity" not in info.data:  # refused already
            return value
        dimension, size = quantity_measures(info.data["quantity"])
        return Quantity(dimension).read(value) if size == 1 else Vector(dimension, size).read(value)

    @field_validator("tolerance", mode="plain")
    @classmethod
    def _tolerance_in_the_same_unit(cls, value: object, info: ValidationInfo) -> object:
        dimension, _ = quantity_measures(info.data["quantity"]) if "quantity" in info.data else (NUMBER, 1)
        return Quantity(dimension, above=0.0).read(value)


def quantity_measures(quantity: str) -> tuple[Dimension, int]:
    """What a quantity measures and how many numbers it has.

    >>> quantity_measures("bodies.nut.velocity")[1], quantity_measures("total.energy")[0].unit
    (3, 'J')
    """
    table = QUANTITIES_IN_TOTAL if quantity.startswith("total.") else QUANTITIES_OF_A_BODY
    return table[quantity.rpartition(".")[2]]
