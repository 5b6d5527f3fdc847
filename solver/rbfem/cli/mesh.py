"""`rbfem mesh`: tets from STL, STEP, .geo or a primitive."""

import click


@click.command("mesh")
@click.argument("source")
@click.option("-o", "--output", required=True, metavar="MESH", help="The .msh file to write.")
@click.option(
    "--size", type=float, help="Edge length, in the unit of the output.  [default: diagonal / 20, or what a .geo says]"
)
@click.option("--order", type=click.IntRange(1, 2), default=1, show_default=True, help="1: tet4, 2: tet10, curved.")
@click.option("--unit", default="m", show_default=True, help="What the numbers of the output are in: m, mm, in, …")
def command(source: str, output: str, size: float | None, order: int, unit: str) -> None:
    """Fill SOURCE with tetrahedra.

    SOURCE is a closed .stl, a .step, .iges, .brep or .geo file, or one of sphere:radius=0.05, box:size=0.1,0.1,0.2,
    cylinder:radius=0.1,height=0.2, ellipsoid:radii=0.1,0.2,0.3 (centred at the origin, the cylinder along z).

    A STEP or IGES file states its own unit and is converted to --unit. The others state none: their numbers stay as
    they are, and --unit says what they mean.
    """
    from rbfem.mesh.generate import generate

    made = generate(source, output, size=size, order=order, unit=unit)
    kind = "tet4" if made.order == 1 else "tet10"
    click.echo(f"{made.path}: {made.tets} {kind}, {made.nodes} nodes, numbers in {unit}")
    click.echo(f"  volume groups   {', '.join(made.groups)}")
    click.echo(f"  surface groups  {', '.join(made.surfaces)}")
    click.echo(f"  volume of mesh  {made.volume:.10g} {unit}^3")
    if made.exact_volume is not None:
        difference = made.volume / made.exact_volume - 1.0
        click.echo(f"  exact volume    {made.exact_volume:.10g} {unit}^3 (the mesh differs by {difference:+.2e})")
    asked = "" if unit == "m" else f" --unit {unit}"
    click.echo(f"  next            rbfem inertia {made.path} --density 1000{asked}")
