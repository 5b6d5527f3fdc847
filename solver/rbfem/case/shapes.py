"""What a case may say of shapes and materials."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import AfterValidator, Discriminator, Field, Tag, field_validator

from rbfem.case.quantity import Quantity, Vector
from rbfem.case.sections import Point, PositiveLength, Section, Text, Vec3, group_or_value, kind_of, length_unit
from rbfem.case.units import DENSITY, LENGTH, NUMBER, PRESSURE
from rbfem.case.wording import shown


class MeshShape(Section):
    """Tetrahedra from a file."""

    kind: ClassVar[str] = "mesh"
    mesh: Text = Field(description="Mesh file with tetrahedra in it; the path starts at the folder of the case.")
    unit: Annotated[str, AfterValidator(length_unit)] = Field(
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


class HalfSpace(Section):
    point: Point = Field(description="A point of the plane, in the world.")
    normal: Annotated[Vec3, Vector(NUMBER)] = Field(description="Direction into the free side; any length.")

    @field_validator("normal")
    @classmethod
    def _has_length(cls, normal: Vec3) -> Vec3:
        if not any(normal):
            raise ValueError(f"expected a direction, read {shown(normal)}")
        return normal


class PlaneShape(Section):
    """A plane wall without end; only a fixed body can have it."""

    kind: ClassVar[str] = "plane"
    plane: HalfSpace = Field(description="Plane wall, solid behind it.")


Shape = Annotated[
    Annotated[MeshShape, Tag("<mesh>")]
    | Annotated[SphereShape, Tag("<sphere>")]
    | Annotated[BoxShape, Tag("<box>")]
    | Annotated[CylinderShape, Tag("<cylinder>")]
    | Annotated[EllipsoidShape, Tag("<ellipsoid>")]
    | Annotated[PlaneShape, Tag("<plane>")],
    kind_of("mesh", "sphere", "box", "cylinder", "ellipsoid", "plane"),
]


class MeshField(Section):
    """A density that varies in space."""

    field: Text = Field(description="Name of a scalar cell or point field of the mesh file, in kg/m^3.")


class Material(Section):
    """What a body is made of."""

    density: Annotated[
        Annotated[float, Quantity(DENSITY, above=0.0), Tag("<value>")] | Annotated[MeshField, Tag("<group>")],
        Discriminator(group_or_value),
    ] = Field(description="Density, or {field: NAME} for one that the mesh file holds.")
    young: Annotated[float, Quantity(PRESSURE, above=0.0)] | None = Field(
        default=None, description="Young's modulus; the law `hertz` needs it."
    )
    poisson: Annotated[float, Quantity(NUMBER, above=-1.0, below=0.5)] | None = Field(
        default=None, description="Poisson's ratio; the law `hertz` needs it."
    )
