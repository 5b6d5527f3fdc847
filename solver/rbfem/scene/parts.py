"""From a shape and a material of the case to a Part."""

import numpy as np
from numpy.typing import NDArray

from rbfem.case.schema import BY_GROUP, Case
from rbfem.case.shapes import BoxShape, CylinderShape, EllipsoidShape, Material, MeshShape, PlaneShape, SphereShape
from rbfem.errors import InputError
from rbfem.fem.density import Density, density_field, field_of_file, groups_of_tets
from rbfem.fem.mass_properties import MassProperties, mass_properties
from rbfem.fem.primitives import primitive_properties, primitive_surface
from rbfem.mesh.primitives import Primitive, from_sizes
from rbfem.mesh.read import read_mesh
from rbfem.mesh.surface import boundary_faces
from rbfem.mesh.tet_mesh import TetMesh
from rbfem.scene.scene import Part

# A six-node triangle is drawn as four flat ones.
QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])


def build_part(case: Case, shape_name: str, material_name: str) -> Part:
    """The part of that shape and material. Raises InputError with the line of the case."""
    shape = case.shapes[shape_name]
    key = f"shapes.{shape_name}"
    if not isinstance(shape, MeshShape):
        return _primitive_part(case, shape_name, material_name)
    try:
        mesh = read_mesh(case.folder / shape.mesh, shape.unit)
        return _mesh_part(case, shape_name, material_name, mesh)
    except InputError as error:
        raise case.error(key, str(error)) from None


def _primitive_part(case: Case, shape_name: str, material_name: str) -> Part:
    shape = case.shapes[shape_name]
    assert not isinstance(shape, MeshShape | PlaneShape)
    primitive = _primitive(shape)
    density = case.materials[material_name].density
    assert isinstance(density, float)  # the case has refused a field for a primitive
    points, triangles = primitive_surface(primitive)
    none = np.zeros(0)
    return _part(
        shape_name,
        primitive.kind,
        None,
        primitive_properties(primitive, density),
        points=points,
        triangles=triangles,
        triangle_material=np.full(len(triangles), _index(case, material_name)),
        tet_material=none.astype(np.int64),
        tet_density=none,
        bounding_radius=primitive.bounding_radius,
    )


def _mesh_part(case: Case, shape_name: str, material_name: str, mesh: TetMesh) -> Part:
    density, tet_material = _filling(case, material_name, mesh)
    properties = mass_properties(mesh, density)
    faces = boundary_faces(mesh)
    used, corners = np.unique(faces.triangles, return_inverse=True)
    triangles: NDArray[np.int64] = corners.reshape(faces.triangles.shape)
    owners = faces.tets
    if mesh.is_second_order:
        triangles, owners = triangles[:, QUARTERS].reshape(-1, 3), np.repeat(owners, 4)
    points = mesh.nodes[used] - properties.center_of_mass
    return _part(
        shape_name,
        "mesh",
        mesh,
        properties,
        points=points,
        triangles=triangles,
        triangle_material=tet_material[owners],
        tet_material=tet_material,
        tet_density=np.array(density_field(mesh, density).of_tets(mesh)),
        bounding_radius=float(np.linalg.norm(points, axis=1).max()),
    )


def _filling(case: Case, material_name: str, mesh: TetMesh) -> tuple[Density, NDArray[np.int64]]:
    """Density of the mesh, and (n_tets,) the material of each tet."""
    if material_name != BY_GROUP:
        density = _density(case.materials[material_name], mesh)
        return density, np.full(mesh.n_tets, _index(case, material_name))
    names = [name for name in mesh.groups if name in case.materials]
    try:
        owner = groups_of_tets(mesh, names)
    except InputError as error:
        without = [name for name in mesh.groups if name not in case.materials]
        hint = f"; no material is called {', '.join(repr(name) for name in without)}" if without else ""
        raise InputError(f"material by-group: {error}{hint} (materials: {', '.join(case.materials)})") from None
    fields = [_density(case.materials[name], mesh) for name in names]
    checked = [density_field(mesh, field) for field in fields]
    if any(field.is_nodal for field in checked):
        raise InputError("material by-group: a density that varies from node to node cannot be of one group only")
    by_tet = [field.of_tets(mesh) for field in checked]
    density = np.choose(owner, by_tet) if len(by_tet) <= 32 else np.array(by_tet)[owner, np.arange(mesh.n_tets)]
    return density, np.array([_index(case, name) for name in names])[owner]


def _density(material: Material, mesh: TetMesh) -> Density:
    if isinstance(material.density, float):
        return material.density
    return field_of_file(mesh, material.density.field)


def _index(case: Case, material_name: str) -> int:
    return list(case.materials).index(material_name)


def _primitive(shape: SphereShape | BoxShape | CylinderShape | EllipsoidShape) -> Primitive:
    sizes = dict(getattr(shape, shape.kind))
    return from_sizes(shape.kind, {name: size if isinstance(size, tuple) else (size,) for name, size in sizes.items()})


def _part(name: str, kind: str, mesh: TetMesh | None, properties: MassProperties, **drawn) -> Part:
    return Part(
        name=name,
        kind=kind,
        mesh=mesh,
        origin=-properties.center_of_mass,
        mass=properties.mass,
        volume=properties.volume,
        inertia=properties.inertia,
        principal_moments=properties.principal_moments,
        principal_quaternion=properties.principal_quaternion,
        inertia_error=properties.rounding_error,
        **drawn,
    )
