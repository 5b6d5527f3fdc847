"""What a case may say of contact between materials."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from rbfem.case.quantity import Quantity
from rbfem.case.sections import Section, Text
from rbfem.case.units import NUMBER, STIFFNESS
from rbfem.case.wording import shown

ANY = "any"


def _at_most_one(value: float) -> float:
    if value > 1.0:
        raise ValueError(f"expected a number from above 0 to 1, read {shown(value)}")
    return value


Restitution = Annotated[float, Quantity(NUMBER, above=0.0), AfterValidator(_at_most_one)]


class ContactRule(Section):
    """How two materials meet. The first rule that fits a pair holds."""

    between: Literal["any"] | tuple[Text, Text] = Field(description="Two materials, or `any`.")
    law: Literal["hertz", "linear"] = Field(
        default="hertz", description="Force law: `hertz` reads `young` and `poisson` of the materials."
    )
    restitution: Restitution = Field(description="Speed of departure by that of approach, of a central impact.")
    friction: Annotated[float, Quantity(NUMBER, at_least=0.0)] = Field(description="Coulomb's coefficient of friction.")
    normal_stiffness: Annotated[float, Quantity(STIFFNESS, above=0.0)] | None = Field(
        default=None, description="Of the linear law."
    )
    tangential_stiffness: Annotated[float, Quantity(STIFFNESS, above=0.0)] | None = Field(
        default=None, description="Of the linear law; 2/7 of the normal one if absent."
    )
