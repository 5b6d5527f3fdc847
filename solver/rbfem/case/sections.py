"""What the sections of a case file are built from: the strict base class, and small types that check themselves."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator

from rbfem.case.quantity import Quantity, Vector
from rbfem.case.units import LENGTH, NUMBER, TIME, unit_factor
from rbfem.case.wording import shown

Vec3 = tuple[float, float, float]
Vec4 = tuple[float, float, float, float]
ZERO: Vec3 = (0.0, 0.0, 0.0)


class Section(BaseModel):
    """A group of keys. Unknown ones are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def _text(value: str) -> str:
    if not value.strip():
        raise ValueError("expected text, read an empty one")
    return value


def _body_name(value: str) -> str:
    if not re.fullmatch(r"[\w-]+", value):
        raise ValueError(f"expected a name of letters, digits, '_' and '-', read {shown(value)}")
    return value


def length_unit(value: str) -> str:
    if value == LENGTH.unit:
        return value
    try:
        unit_factor(value.strip(), LENGTH)
    except ValueError as error:
        raise ValueError(f"expected a unit of length such as mm, read {shown(value)}{error}") from None
    return value


def _box(corners: tuple[Vec3, Vec3]) -> tuple[Vec3, Vec3]:
    low, high = corners
    if any(a > b for a, b in zip(low, high, strict=True)):
        raise ValueError(f"expected [[lowest x, y, z], [highest x, y, z]] in m, read {shown(corners)}")
    return corners


def _ascending(ramp: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(later[0] <= earlier[0] for earlier, later in pairwise(ramp)):
        raise ValueError(f"expected ascending times, read {shown([time for time, _ in ramp])}")
    return ramp


def not_empty(items: tuple[Any, ...]) -> tuple[Any, ...]:
    if not items:
        raise ValueError("expected at least one, read an empty list")
    return items


def each_once(names: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(names)) < len(names):
        raise ValueError(f"expected each name once, read {shown(names)}")
    return names


Text = Annotated[str, AfterValidator(_text)]
Name = Annotated[str, AfterValidator(_body_name)]
Frame = Literal["world", "body"]
PositiveLength = Annotated[float, Quantity(LENGTH, above=0.0)]
Point = Annotated[Vec3, Vector(LENGTH)]
Box = Annotated[tuple[Point, Point], AfterValidator(_box)]
RAMP_MEANING = "[[time, factor], …]: linear between, constant outside; 1 if absent."
RampPoint = tuple[Annotated[float, Quantity(TIME)], Annotated[float, Quantity(NUMBER)]]
Ramp = Annotated[tuple[RampPoint, ...], AfterValidator(not_empty), AfterValidator(_ascending)]


def kind_of(*kinds: str) -> Discriminator:
    """Chooses the section by which of `kinds` is among the keys that were written."""

    def tag(value: object) -> str | None:
        if isinstance(value, Section):
            return f"<{value.kind}>"  # type: ignore[attr-defined]
        return next((f"<{key}>" for key in value if key in kinds), None) if isinstance(value, Mapping) else None

    listed = ", ".join(kinds)
    return Discriminator(tag, "no_kind", f"expected one of {listed}", {"kinds": listed})


def group_or_value(value: object) -> str:
    return "<group>" if isinstance(value, (Mapping, Section)) else "<value>"
