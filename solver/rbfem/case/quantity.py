"""Numbers and vectors of the schema that know what they measure.

An annotation is all there is: reading, the error message, the JSON schema and the reference page follow from it.
"""

from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from rbfem.case.units import Dimension, to_si
from rbfem.case.wording import shown

LARGEST = 1e50  # in SI; beyond, products of a few numbers no longer fit a float


@dataclass(frozen=True)
class Quantity:
    """One number: its dimension, the bounds it must keep (in SI) and the word that may stand in its place."""

    dimension: Dimension
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    word: str | None = None

    def read(self, value: object) -> float | str:
        """The value in SI; raises ValueError saying what was expected."""
        if self.word is not None and value == self.word:
            return self.word
        number = to_si(value, self.dimension, self.expected)
        if abs(number) > LARGEST:
            raise ValueError(f"expected {self.expected} of at most {LARGEST:.0e} in size, read {shown(value)}")
        if not self._is_within(number):
            raise ValueError(f"expected {self.expected}, read {shown(value)}")
        return number

    def _is_within(self, number: float) -> bool:
        return (
            (self.above is None or number > self.above)
            and (self.at_least is None or number >= self.at_least)
            and (self.below is None or number < self.below)
        )

    @property
    def expected(self) -> str:
        adjective = "positive" if self.above == 0 else ""
        parts = [self.dimension.described(adjective)]
        if self.at_least is not None:
            parts.append(f"that is at least {self.at_least:g}")
        if self.below is not None:
            parts.append(f"below {self.below:g}")
        if self.word is not None:
            parts.append(f"or {self.word}")
        return " ".join(parts)

    def json_schema(self) -> dict[str, Any]:
        bounds = {"exclusiveMinimum": self.above, "minimum": self.at_least, "exclusiveMaximum": self.below}
        schema: dict[str, Any] = {"type": ["number", "string"]}
        schema.update({key: bound for key, bound in bounds.items() if bound is not None})
        return schema | {"x-unit": self.dimension.unit}

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self.json_schema()


@dataclass(frozen=True)
class Vector:
    """A list of `size` numbers of one dimension."""

    dimension: Dimension
    size: int = 3
    above: float | None = None

    def read(self, value: object) -> tuple[float | str, ...]:
        """The numbers in SI; raises ValueError naming every item that is wrong."""
        if not isinstance(value, (list, tuple)) or len(value) != self.size:
            raise ValueError(f"expected a list of {self.size} numbers{self._of_what()}, read {shown(value)}")
        numbers, wrong = [], []
        for place, item in enumerate(value, start=1):
            try:
                numbers.append(self._item.read(item))
            except ValueError as error:
                wrong.append(f"number {place}: {error}")
        if wrong:
            raise ValueError("; ".join(wrong))
        return tuple(numbers)

    @property
    def _item(self) -> Quantity:
        return Quantity(self.dimension, above=self.above)

    def _of_what(self) -> str:
        return f" ({self.dimension.meaning} in {self.dimension.unit})" if self.dimension.unit else ""

    def json_schema(self) -> dict[str, Any]:
        item = self._item.json_schema()
        unit = item.pop("x-unit")
        return {"type": "array", "items": item, "minItems": self.size, "maxItems": self.size, "x-unit": unit}

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return self.json_schema()


@dataclass(frozen=True)
class Attitude(Vector):
    """A quaternion, scalar first. Its length says nothing, but it must have one."""

    def read(self, value: object) -> tuple[float | str, ...]:
        numbers = super().read(value)
        length = sum(float(number) ** 2 for number in numbers if abs(float(number)) < 1e100) ** 0.5
        if not 1e-6 < length < 1e6:
            raise ValueError(f"expected a quaternion of length about 1 (it is scaled to 1), read {shown(value)}")
        return numbers
