"""What a case file may say. Every key has its meaning and every number its dimension, in this room and nowhere else."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, PrivateAttr, StrictBool, StrictInt

from rbfem.case.contacts import ContactRule
from rbfem.case.expectations import Expect
from rbfem.case.loads import Load
from rbfem.case.quantity import Attitude, Quantity, Vector
from rbfem.case.sections import ZERO, Box, Name, Point, Section, Text, Vec3, Vec4, each_once, not_empty
from rbfem.case.shapes import Material, Shape
from rbfem.case.units import ACCELERATION, ANGULAR_VELOCITY, NUMBER, TIME, VELOCITY
from rbfem.case.wording import located
from rbfem.errors import InputError

BY_GROUP = "by-group"
MOST_COPIES = 10_000_000


class Place(Section):
    """Where the copies of a body start: drawn from the seed."""

    in_box: Box = Field(description="[[lowest x, y, z], [highest x, y, z]] that holds the centres of mass, in m.")
    orientation: Literal["random", "aligned"] = Field(default="aligned", description="Attitude of each copy.")


class Body(Section):
    """A body, or `count` copies of it."""

    name: Name = Field(description="Its name; copies are called NAME.00, NAME.01, …")
    shape: Text = Field(description="Name of its shape.")
    material: Text = Field(
        description=f"Name of its material, or `{BY_GROUP}`: each mesh group takes the one of its name."
    )
    count: Annotated[StrictInt, Field(ge=1, le=MOST_COPIES)] = Field(
        default=1, description="Number of copies; more than one needs `place`."
    )
    place: Place | None = Field(default=None, description="Random places instead of `position`.")
    position: Point = Field(
        default=ZERO, description="Where the mesh's own origin (a primitive's centre) starts, in the world."
    )
    quaternion: Annotated[Vec4, Attitude(NUMBER, size=4)] = Field(
        default=(1.0, 0.0, 0.0, 0.0),
        description="Attitude at the start, shape axes to world, scalar first; scaled to length 1.",
    )
    velocity: Annotated[Vec3, Vector(VELOCITY)] = Field(default=ZERO, description="Of the centre of mass at the start.")
    angular_velocity: Annotated[Vec3, Vector(ANGULAR_VELOCITY)] = Field(
        default=ZERO, description="At the start, world axes."
    )
    angular_velocity_body: Annotated[Vec3, Vector(ANGULAR_VELOCITY)] | None = Field(
        default=None, description="At the start, in the axes of the shape; instead of `angular_velocity`."
    )
    fixed: StrictBool = Field(default=False, description="True for a body that never moves.")
    pivot: Point | None = Field(
        default=None, description="World point where a ball joint holds it: it can only turn about it."
    )
    loads: tuple[Load, ...] = Field(default=(), description="What pushes it, besides gravity.")

    def copy_names(self) -> tuple[str, ...]:
        """NAME, or NAME.00, NAME.01, … for several copies."""
        if self.count == 1:
            return (self.name,)
        width = copy_width(self.count)
        return tuple(f"{self.name}.{index:0{width}}" for index in range(self.count))


def copy_width(count: int) -> int:
    """Digits of the number behind a copy's name.

    >>> copy_width(50), copy_width(1001)
    (2, 4)
    """
    return max(2, len(str(count - 1)))


class Time(Section):
    """How long, in what steps, by what method."""

    end: Annotated[float, Quantity(TIME, above=0.0)] = Field(description="The run goes from 0 to here.")
    step: Annotated[float | Literal["auto"], Quantity(TIME, above=0.0, word="auto")] = Field(
        default="auto", description="Step of the method, or `auto`: chosen by the plan."
    )
    method: Text = Field(default="auto", description="Name of the method, or `auto`: chosen by the plan.")


class Output(Section):
    """What is written, and how often."""

    every: Annotated[float, Quantity(TIME, above=0.0)] | None = Field(
        default=None, description="Time between frames; a hundredth of `time.end` if absent."
    )
    fields: Annotated[tuple[Literal["velocity", "density"], ...], AfterValidator(each_once)] = Field(
        default=("velocity",), description="Fields in the frames besides the moved points."
    )


@dataclass(frozen=True)
class Source:
    """Where a case was read, and where in it each value stands: dotted key -> `cases/x/case.yaml:12`."""

    folder: Path = Path()
    name: str = "case"
    file: str = "case"
    places: dict[str, str] = field(default_factory=dict)


class Case(Section):
    """What the user wrote, checked, in SI, every value knowing its line in the file."""

    rbfem: Literal[1] = Field(description="Version of this format: 1.")
    title: str = Field(default="", description="What the case shows, in a line.")
    seed: Annotated[StrictInt, Field(ge=0)] = Field(default=0, description="Everything random derives from it.")
    accuracy: Annotated[float, Quantity(NUMBER, above=0.0, below=1.0)] = Field(
        default=1e-3,
        description="The error you accept: of the position as a share of the body's radius, of the attitude in rad.",
    )
    shapes: dict[Text, Shape] = Field(description="Shapes by name.")
    materials: dict[Text, Material] = Field(description="Materials by name.")
    contacts: tuple[ContactRule, ...] = Field(
        default=(), description="How materials meet: the first rule that fits a pair holds; without one they pass."
    )
    bodies: Annotated[tuple[Body, ...], AfterValidator(not_empty)] = Field(description="The bodies, at least one.")
    gravity: Annotated[Vec3, Vector(ACCELERATION)] = Field(
        default=ZERO, description="Acceleration of everything that is free."
    )
    time: Time = Field(description="How long and how.")
    output: Output = Field(default_factory=Output, description="What is written.")
    expect: tuple[Expect, ...] = Field(default=(), description="What is known about the answer.")

    _source: Source = PrivateAttr(default_factory=Source)

    def model_post_init(self, context: Any) -> None:
        if isinstance(context, Source):
            self._source = context

    @property
    def folder(self) -> Path:
        """Relative paths in the case start here."""
        return self._source.folder

    @property
    def name(self) -> str:
        """Of the case's folder, or of the file when that is not called case.yaml."""
        return self._source.name

    def where(self, key: str) -> str:
        """`cases/x/case.yaml:12` for a dotted key such as `bodies.nut.shape`, or for what is written around it."""
        while key and key not in self._source.places:
            key = key.rpartition(".")[0]
        return self._source.places.get(key, self._source.file)

    def error(self, key: str, message: str) -> InputError:
        """What to raise when the value at `key` turns out to be wrong."""
        return InputError(f"{located(self.where(key), key)}: {message}")


def json_schema() -> dict[str, Any]:
    """JSON schema of the case file (draft 2020-12) for editors; numbers may be strings with a unit."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | _with_units(Case.model_json_schema())


def _with_units(schema: Any) -> Any:
    """The same schema, where `x-unit` has become a sentence of the description."""
    if isinstance(schema, list):
        return [_with_units(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    schema = {key: _with_units(value) for key, value in schema.items()}
    if unit := schema.pop("x-unit", ""):
        schema["description"] = f"{schema.get('description', '')} SI unit: {unit}.".strip()
    return schema
