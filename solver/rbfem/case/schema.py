"""What a case file may say. Every key has its meaning and every number its dimension, here and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    PrivateAttr,
    StrictBool,
    StrictInt,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
)

from rbfem.case.quantity import Attitude, Quantity, Vector
from rbfem.case.units import (
    ACCELERATION,
    ANGULAR_DAMPING,
    ANGULAR_MOMENTUM,
    ANGULAR_VELOCITY,
    DAMPING,
    DENSITY,
    ENERGY,
    FORCE,
    LENGTH,
    MASS,
    MOMENT_OF_INERTIA,
    MOMENTUM,
    NUMBER,
    PRESSURE,
    STIFFNESS,
    TIME,
    TORQUE,
    VELOCITY,
    Dimension,
    unit_factor,
)
from rbfem.case.wording import did_you_mean, shown
from rbfem.errors import InputError

BY_GROUP = "by-group"
MOST_COPIES = 10_000_000

Vec3 = tuple[float, float, float]
Vec4 = tuple[float, float, float, float]
ZERO: Vec3 = (0.0, 0.0, 0.0)


class Section(BaseModel):
    """A group of keys. Unknown ones are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


# ---------------------------------------------------------------------------------------------------- small types


def _text(value: str) -> str:
    if not value.strip():
        raise ValueError("expected text, read an empty one")
    return value


def _body_name(value: str) -> str:
    if not re.fullmatch(r"[\w-]+", value):
        raise ValueError(f"expected a name of letters, digits, '_' and '-', read {shown(value)}")
    return value


def _length_unit(value: str) -> str:
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


def _not_empty(items: tuple[Any, ...]) -> tuple[Any, ...]:
    if not items:
        raise ValueError("expected at least one, read an empty list")
    return items


def _each_once(names: tuple[str, ...]) -> tuple[str, ...]:
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
Ramp = Annotated[tuple[RampPoint, ...], AfterValidator(_not_empty), AfterValidator(_ascending)]


def kind_of(*kinds: str) -> Discriminator:
    """Chooses the section by which of `kinds` is among the keys that were written."""

    def tag(value: object) -> str | None:
        if isinstance(value, Section):
            return f"<{value.kind}>"  # type: ignore[attr-defined]
        return next((f"<{key}>" for key in value if key in kinds), None) if isinstance(value, Mapping) else None

    listed = ", ".join(kinds)
    return Discriminator(tag, "no_kind", f"expected one of {listed}", {"kinds": listed})


def _group_or_value(value: object) -> str:
    return "<group>" if isinstance(value, (Mapping, Section)) else "<value>"


# --------------------------------------------------------------------------------------------------------- shapes


class MeshShape(Section):
    """Tetrahedra from a file."""

    kind: ClassVar[str] = "mesh"
    mesh: Text = Field(description="Mesh file with tetrahedra in it; the path starts at the folder of the case.")
    unit: Annotated[str, AfterValidator(_length_unit)] = Field(
        default="m", description="Unit of length of the mesh file."
    )


class Sphere(Section):
    radius: PositiveLength = Field(description="Radius.")


class SphereShape(Section):
    """A sphere; its origin is its centre."""

    kind: ClassVar[str] = "sphere"
    sphere: Sphere = Field(description="Exact sphere, no mesh needed.")


class Cuboid(Section):
    size: Annotated[Vec3, Vector(LENGTH, above=0.0)] = Field(description="Edge lengths along x, y, z.")


class BoxShape(Section):
    """A rectangular box; its origin is its centre."""

    kind: ClassVar[str] = "box"
    box: Cuboid = Field(description="Exact box, no mesh needed.")


class Cylinder(Section):
    radius: PositiveLength = Field(description="Radius.")
    height: PositiveLength = Field(description="Height along z.")


class CylinderShape(Section):
    """A cylinder about its own z axis; its origin is its centre."""

    kind: ClassVar[str] = "cylinder"
    cylinder: Cylinder = Field(description="Exact cylinder, axis z, no mesh needed.")


class Ellipsoid(Section):
    radii: Annotated[Vec3, Vector(LENGTH, above=0.0)] = Field(description="Half axes along x, y, z.")


class EllipsoidShape(Section):
    """An ellipsoid; its origin is its centre."""

    kind: ClassVar[str] = "ellipsoid"
    ellipsoid: Ellipsoid = Field(description="Exact ellipsoid, no mesh needed.")


Shape = Annotated[
    Annotated[MeshShape, Tag("<mesh>")]
    | Annotated[SphereShape, Tag("<sphere>")]
    | Annotated[BoxShape, Tag("<box>")]
    | Annotated[CylinderShape, Tag("<cylinder>")]
    | Annotated[EllipsoidShape, Tag("<ellipsoid>")],
    kind_of("mesh", "sphere", "box", "cylinder", "ellipsoid"),
]


# ------------------------------------------------------------------------------------------------------ materials


class MeshField(Section):
    """A density that varies in space."""

    field: Text = Field(description="Name of a scalar cell or point field of the mesh file, in kg/m^3.")


class Material(Section):
    """What a body is made of."""

    density: Annotated[
        Annotated[float, Quantity(DENSITY, above=0.0), Tag("<value>")] | Annotated[MeshField, Tag("<group>")],
        Discriminator(_group_or_value),
    ] = Field(description="Density, or {field: NAME} for one that the mesh file holds.")


# ---------------------------------------------------------------------------------------------------------- loads


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
        Discriminator(_group_or_value),
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


Load = Annotated[
    Annotated[ForceLoad, Tag("<force>")]
    | Annotated[TorqueLoad, Tag("<torque>")]
    | Annotated[PressureLoad, Tag("<pressure>")]
    | Annotated[TractionLoad, Tag("<traction>")]
    | Annotated[SpringLoad, Tag("<spring>")]
    | Annotated[DragLoad, Tag("<drag>")],
    kind_of("force", "torque", "pressure", "traction", "spring", "drag"),
]


# --------------------------------------------------------------------------------------------------------- bodies


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


# ------------------------------------------------------------------------------------------- time, output, expect


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
    fields: Annotated[tuple[Literal["velocity", "density"], ...], AfterValidator(_each_once)] = Field(
        default=("velocity",), description="Fields in the frames besides the moved points."
    )


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


# ----------------------------------------------------------------------------------------------------------- case


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
    bodies: Annotated[tuple[Body, ...], AfterValidator(_not_empty)] = Field(description="The bodies, at least one.")
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
        return InputError(f"{self.where(key)}: {key}: {message}")


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
