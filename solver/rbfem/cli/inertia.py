"""`rbfem inertia`: the mesh-to-inertia utility."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from rbfem.fem.density import Density
    from rbfem.fem.inertia_error import InertiaError
    from rbfem.fem.mass_properties import MassProperties
    from rbfem.mesh.tet_mesh import TetMesh


@click.command("inertia")
@click.argument("mesh_path", metavar="MESH", type=click.Path(path_type=Path))
@click.option("--density", "densities", multiple=True, metavar="D", help="See above.  [default: 1 kg/m^3]")
@click.option("--unit", default="m", show_default=True, help="What the numbers of MESH are in: m, mm, in, …")
@click.option("--about", metavar="X,Y,Z", help="Print the tensor about this point too, in metres.")
@click.option("--second", metavar="MESH", help="A coarser or finer mesh of the part: tells the discretisation error.")
@click.option(
    "--exact",
    metavar="SHAPE",
    help="What MESH stands for: a .step file, or a shape such as sphere:radius=5, in --unit.",
)
@click.option("--json", "form", flag_value="json", help="Everything as JSON.")
@click.option("--urdf", "form", flag_value="urdf", help="An <inertial> element for URDF.")
@click.option("--mjcf", "form", flag_value="mjcf", help="An <inertial> element for MuJoCo.")
@click.option("--sdf", "form", flag_value="sdf", help="An <inertial> element for SDFormat.")
def command(
    mesh_path: Path,
    densities: tuple[str, ...],
    unit: str,
    about: str | None,
    second: str | None,
    exact: str | None,
    form: str | None,
) -> None:
    """Mass, centre of mass and inertia tensor of MESH, and how wrong they can be.

    --density takes a number in kg/m^3 or with a unit ("7.85 g/cm^3"); GROUP=NUMBER, once for each of the volume
    groups that make up the part; or field:NAME, a scalar cell or point field of the mesh file.
    """
    from rbfem.cli import inertia_formats
    from rbfem.fem.inertia_error import inertia_error
    from rbfem.fem.mass_properties import mass_properties
    from rbfem.mesh.read import read_mesh

    point = None if about is None else _point(about)
    mesh = read_mesh(mesh_path, unit)
    properties = mass_properties(mesh, _density(densities, mesh))
    error = inertia_error(properties)
    if exact and second:
        raise click.BadParameter("give --exact or --second, not both", param_hint="--second")
    if exact:
        error = _against_exact(properties, mesh, exact, unit, densities)
    elif second:
        error = _against_second(properties, mesh, second, unit, densities)
    click.echo(_formatted(inertia_formats, form, properties, error, mesh, point))


def _formatted(
    formats: Any, form: str | None, properties: "MassProperties", error: "InertiaError", mesh: "TetMesh", point: Any
) -> str:
    if form == "json":
        return formats.as_json(properties, error, mesh, point)
    if form in formats.SNIPPETS:
        return formats.SNIPPETS[form](properties)
    return "\n".join(formats.as_table(properties, error, mesh, point))


def _point(text: str) -> list[float]:
    try:
        point = [float(part) for part in text.split(",")]
    except ValueError:
        point = []
    if len(point) != 3 or not all(map(math.isfinite, point)):
        raise click.BadParameter(f"read {text!r}, expected three numbers such as 0,0,0.1", param_hint="--about")
    return point


def _density(texts: tuple[str, ...], mesh: "TetMesh") -> "Density":
    """One density, or one a group, from the words of the command line."""
    from rbfem.fem.density import field_of_file

    by_group = {name: value for name, equals, value in (text.rpartition("=") for text in texts) if equals}
    if by_group and len(by_group) < len(texts):
        raise click.BadParameter("give one density, or GROUP=DENSITY for every group", param_hint="--density")
    if by_group:
        return {name: _number(value) for name, value in by_group.items()}
    if len(texts) > 1:
        raise click.BadParameter(f"read {' and '.join(texts)}, expected one", param_hint="--density")
    text = texts[0] if texts else "1"
    return field_of_file(mesh, text[len("field:") :]) if text.startswith("field:") else _number(text)


def _number(text: str) -> float:
    from rbfem.case.quantity import Quantity
    from rbfem.case.units import DENSITY

    try:
        value: object = float(text)
    except ValueError:
        value = text
    try:
        return float(Quantity(DENSITY, above=0.0).read(value))
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--density") from None


def _against_exact(
    properties: "MassProperties", mesh: "TetMesh", exact: str, unit: str, densities: tuple[str, ...]
) -> "InertiaError":
    from rbfem.fem.inertia_error import error_against_exact
    from rbfem.fem.primitives import primitive_properties, solid_properties
    from rbfem.mesh.primitives import is_primitive, parse_primitive
    from rbfem.mesh.units import metres_per

    density = _density(densities, mesh)
    if not isinstance(density, float):
        raise click.BadParameter("the exact shape is known for one density only", param_hint="--exact")
    if is_primitive(exact):
        known = primitive_properties(parse_primitive(exact).scaled(metres_per(unit)), density)
    else:
        known = solid_properties(exact, density)
    return error_against_exact(properties, known, exact)


def _against_second(
    properties: "MassProperties", mesh: "TetMesh", second: str, unit: str, densities: tuple[str, ...]
) -> "InertiaError":
    from rbfem.fem.inertia_error import error_against_second
    from rbfem.fem.mass_properties import mass_properties
    from rbfem.mesh.read import read_mesh

    other = read_mesh(second, unit)
    return error_against_second(properties, mesh, mass_properties(other, _density(densities, other)), other)
