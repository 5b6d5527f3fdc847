"""Mass properties in the forms that people and other programs read."""

import json
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from rbfem.fem.inertia_error import InertiaError
from rbfem.fem.mass_properties import MassProperties
from rbfem.mesh.check import summarize
from rbfem.mesh.tet_mesh import TetMesh


def as_table(
    properties: MassProperties, error: InertiaError, mesh: TetMesh, about: Sequence[float] | None
) -> Iterator[str]:
    """Lines for a person. All in SI."""
    summary = summarize(mesh)
    size = summary.box[1] - summary.box[0]
    kind = "tet10" if mesh.is_second_order else "tet4"
    yield f"{mesh.source}: {summary.tets} {kind}, {summary.nodes} nodes"
    yield f"  box                {_row(size)} m"
    yield f"  quality            smallest {summary.quality_min:.3f}, median {summary.quality_median:.3f} (1: regular)"
    if summary.groups:
        yield "  volume groups      " + ", ".join(f"{name} ({count})" for name, count in summary.groups.items())
    if summary.surfaces:
        yield "  surface groups     " + ", ".join(f"{name} ({count})" for name, count in summary.surfaces.items())
    yield f"  volume             {properties.volume:.12g} m^3"
    yield f"  mass               {properties.mass:.12g} kg"
    yield f"  center of mass     {_row(properties.center_of_mass)} m"
    yield from _matrix("inertia about it", properties.inertia)
    yield f"  principal moments  {_row(properties.principal_moments)} kg m^2"
    yield from _matrix("principal axes", properties.principal_axes.T, unit="", label="axis {}")
    yield f"  radius of gyration {properties.radius_of_gyration:.12g} m"
    if about is not None:
        yield from _matrix(f"inertia about {', '.join(f'{x:g}' for x in about)}", properties.inertia_about(about))
    yield f"  error of tensor    rounding {error.rounding:.1e}"
    yield f"                     discretisation {_discretisation(error)}"
    yield from (f"  repaired           {repair}" for repair in mesh.repairs)
    yield from (f"  warning            {warning}" for warning in mesh.warnings)


def as_json(properties: MassProperties, error: InertiaError, mesh: TetMesh, about: Sequence[float] | None) -> str:
    """One JSON object, in SI. `error` is the estimated relative error of the tensor, of the parts that are known."""
    summary = summarize(mesh)
    data = {
        "mass": properties.mass,
        "volume": properties.volume,
        "center_of_mass": properties.center_of_mass.tolist(),
        "inertia": properties.inertia.tolist(),
        "principal_moments": properties.principal_moments.tolist(),
        "principal_axes": properties.principal_quaternion.tolist(),
        "error": error.total,
        "error_parts": {"rounding": error.rounding, "discretisation": error.discretisation, "how": error.how},
        "mesh": {
            "nodes": summary.nodes,
            "tets": summary.tets,
            "order": summary.order,
            "components": summary.components,
            "box": summary.box.tolist(),
            "groups": dict(summary.groups),
            "surfaces": dict(summary.surfaces),
            "quality": {"min": summary.quality_min, "median": summary.quality_median},
            "repairs": list(mesh.repairs),
            "warnings": list(mesh.warnings),
        },
    }
    if about is not None:
        data["inertia_about"] = {"point": list(about), "inertia": properties.inertia_about(about).tolist()}
    return json.dumps(data, indent=2, ensure_ascii=False)


def urdf(properties: MassProperties) -> str:
    """<inertial> of URDF: tensor about the centre of mass, axes of the mesh."""
    return "\n".join(
        (
            "<inertial>",
            f'  <origin xyz="{_numbers(properties.center_of_mass)}" rpy="0 0 0"/>',
            f'  <mass value="{properties.mass!r}"/>',
            f"  <inertia {' '.join(f'{name}={_quoted(value)}' for name, value in _six(properties))}/>",
            "</inertial>",
        )
    )


def mjcf(properties: MassProperties) -> str:
    """<inertial> of MJCF: fullinertia is xx, yy, zz, xy, xz, yz."""
    values = dict(_six(properties))
    order = [values[name] for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")]
    return (
        f'<inertial pos="{_numbers(properties.center_of_mass)}" mass="{properties.mass!r}" '
        f'fullinertia="{_numbers(order)}"/>'
    )


def sdf(properties: MassProperties) -> str:
    """<inertial> of SDFormat."""
    return "\n".join(
        (
            "<inertial>",
            f"  <pose>{_numbers(properties.center_of_mass)} 0 0 0</pose>",
            f"  <mass>{properties.mass!r}</mass>",
            "  <inertia>",
            *(f"    <{name}>{value!r}</{name}>" for name, value in _six(properties)),
            "  </inertia>",
            "</inertial>",
        )
    )


SNIPPETS: dict[str, Callable[[MassProperties], str]] = {"urdf": urdf, "mjcf": mjcf, "sdf": sdf}


def _six(properties: MassProperties) -> list[tuple[str, float]]:
    names, tensor = "xyz", properties.inertia.tolist()
    return [(f"i{names[i]}{names[j]}", tensor[i][j]) for i in range(3) for j in range(i, 3)]


def _discretisation(error: InertiaError) -> str:
    return f"unknown: {error.how}" if error.discretisation is None else f"{error.discretisation:.1e} ({error.how})"


def _matrix(name: str, matrix: np.ndarray, unit: str = " kg m^2", label: str = "") -> Iterator[str]:
    for index, row in enumerate(matrix):
        head = name if index == 0 else ""
        tail = f"  {label.format(index + 1)}" if label else unit
        yield f"  {head:<18} {_row(row)}{tail}"


def _row(values: Sequence[float] | np.ndarray) -> str:
    return "  ".join(f"{value:>18.11g}" for value in values)


def _numbers(values: Sequence[float] | np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)


def _quoted(value: float) -> str:
    return f'"{value!r}"'
