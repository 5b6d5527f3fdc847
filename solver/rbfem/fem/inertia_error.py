"""How far a mesh is from the part: measured against the exact shape or against a second mesh, never guessed."""

from dataclasses import dataclass

import numpy as np

from rbfem.errors import InputError
from rbfem.fem.mass_properties import MassProperties
from rbfem.mesh.tet_mesh import TetMesh

# The error of the tensor falls as this power of the edge length: flat faces, and faces that curve with tet10.
ORDER_FLAT, ORDER_CURVED = 2.0, 4.0
# Two meshes closer than this in edge length have errors too alike to tell them from each other.
LEAST_RATIO = 1.2
LARGEST_DISTANCE = 1.0  # of the tensor's own size: no mesh of a part is that coarse


@dataclass(frozen=True)
class InertiaError:
    """Relative error of an inertia tensor. rounding: predicted; discretisation: measured, or None; how: in words."""

    rounding: float
    discretisation: float | None
    how: str

    @property
    def total(self) -> float:
        """The sum of what is known."""
        return self.rounding + (self.discretisation or 0.0)


def inertia_error(properties: MassProperties) -> InertiaError:
    """What one mesh alone can tell: its rounding."""
    how = "one mesh cannot tell how far it is from the part; give --second or --exact"
    return InertiaError(properties.rounding_error, None, how)


def error_against_exact(properties: MassProperties, exact: MassProperties, name: str) -> InertiaError:
    """Error of the tensor of a mesh whose exact shape is known, in the same axes."""
    return InertiaError(properties.rounding_error, _distance(properties, exact, name), f"against the exact {name}")


def error_against_second(
    properties: MassProperties, mesh: TetMesh, second: MassProperties, second_mesh: TetMesh
) -> InertiaError:
    """Error of the tensor of a mesh, from a second mesh of the same part in the same axes (Richardson).

    With an error e of this mesh that falls as h^p, h ~ n_tets^(-1/3), the tensors differ by e |1 - r^p|, r the ratio of
    the edge lengths of the second mesh to this one's. p is 2, and 4 for tet10. A tet10 mesh beside a tet4 one is taken
    for the part itself, so that e is the difference.
    Raises InputError for a tet4 mesh beside a tet10 one, and for two of one kind with about as many tets.
    Source: Roache, J. Fluids Eng. 116:405, 1994.
    """
    distance = _distance(properties, second, second_mesh.source)
    name = f"{second_mesh.source} with {second_mesh.n_tets} tets"
    if second_mesh.is_second_order and not mesh.is_second_order:
        return InertiaError(properties.rounding_error, distance, f"against {name}, tet10, taken for the part itself")
    if mesh.is_second_order and not second_mesh.is_second_order:
        raise InputError(f"{name}: a tet4 mesh cannot tell the error of a tet10 one; give a second tet10 mesh")
    ratio = (mesh.n_tets / second_mesh.n_tets) ** (1.0 / 3.0)
    if max(ratio, 1.0 / ratio) < LEAST_RATIO:
        raise InputError(
            f"{name}, and the first mesh has {mesh.n_tets}: too alike to tell the error; "
            "give one with at least twice or at most half as many"
        )
    order = ORDER_CURVED if mesh.is_second_order else ORDER_FLAT
    how = f"from {name}, error taken to fall as h^{order:g}"
    return InertiaError(properties.rounding_error, distance / abs(1.0 - ratio**order), how)


def tensor_distance(one: MassProperties, other: MassProperties) -> float:
    """|I1 - I2| / |I2| in the Frobenius norm, both about their own centres of mass and in the same axes.

    >>> from rbfem.fem.mass_properties import from_tensor
    >>> a, b = (from_tensor(1.0, 1.0, np.zeros(3), s * np.eye(3)) for s in (1.01, 1.0))
    >>> round(tensor_distance(a, b), 12)
    0.01
    """
    return float(np.linalg.norm(one.inertia - other.inertia) / np.linalg.norm(other.inertia))


def _distance(one: MassProperties, other: MassProperties, name: str) -> float:
    """`tensor_distance`, refused where it can only be that of another part."""
    distance = tensor_distance(one, other)
    if distance > LARGEST_DISTANCE:
        raise InputError(
            f"{name}: its tensor differs from the mesh's by {distance:.2g} of its size: this is not the same part, or "
            "not in the same unit, or its axes lie otherwise"
        )
    return distance
