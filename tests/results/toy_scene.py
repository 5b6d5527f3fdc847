"""A scene of two parts made by hand, and frames of it in which everything moves."""

import dataclasses

import numpy as np

from rbfem.mesh.tet_mesh import TetMesh
from rbfem.scene.scene import Part, Scene
from rbfem.simulation.frame import Balance, Frame

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
OUTWARD = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def corner_part():
    """A mesh of one tet, (0,0,0) (1,0,0) (0,1,0) (0,0,1), of density 6: 1 kg. The mesh's zero is not its centre."""
    mesh = TetMesh(nodes=CORNERS, tets=np.array([[0, 1, 2, 3]]))
    return make_part("corner", "mesh", CORNERS - 0.25, OUTWARD, mass=1.0, volume=1 / 6, mesh=mesh)


def block_part():
    """A primitive box of 0.2 x 0.4 x 0.6 m and 4.8 kg: density 100."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = np.array([[a, b, c] for f in faces for a, b, c in ((f[0], f[1], f[2]), (f[0], f[2], f[3]))])
    return make_part("block", "box", signs * [0.1, 0.2, 0.3], triangles, mass=4.8, volume=0.048, material=1)


def make_part(name, kind, points, triangles, mass, volume, mesh=None, material=0):
    n_tets = mesh.n_tets if mesh else 0
    return Part(
        name=name,
        kind=kind,
        mesh=mesh,
        points=points,
        triangles=triangles,
        triangle_material=np.full(len(triangles), material),
        tet_material=np.full(n_tets, material),
        tet_density=np.full(n_tets, mass / volume),
        origin=np.full(3, -0.25) if mesh else np.zeros(3),
        mass=mass,
        volume=volume,
        inertia=np.eye(3),
        principal_moments=np.ones(3),
        principal_quaternion=np.array([1.0, 0, 0, 0]),
        bounding_radius=float(np.linalg.norm(points, axis=1).max()),
        inertia_error=0.0,
    )


def make_scene(n_corners=2, n_blocks=1, parts=None, fields=("velocity",), name="toy"):
    """Corners first, then blocks; only with what the results are made from, everything else is None."""
    n = n_corners + n_blocks
    facts = {
        "name": name,
        "names": tuple(f"body.{i:02d}" for i in range(n)),
        "parts": parts or (corner_part(), block_part()),
        "part_of": np.repeat([0, 1], [n_corners, n_blocks]),
        "materials": ("brass", "oak & glue"),
        "output_fields": tuple(fields),
        "can_touch": np.zeros(n, dtype=bool),
    }
    return Scene(**{field.name: facts.get(field.name) for field in dataclasses.fields(Scene)})


def make_frame(scene, index, interval=1 / 30, centre=(0.0, 0.0, 0.0)):
    """Bodies in a row, each turning about z at its own rate and rising at 2 m/s."""
    n, time = len(scene.names), index * interval
    rate = 1.0 + np.arange(n)
    half = 0.5 * rate * time
    zero = np.zeros(n)
    return Frame(
        index=index,
        time=time,
        position=np.column_stack([2.0 * np.arange(n), zero, zero + 2 * time]) + centre,
        quaternion=np.column_stack([np.cos(half), zero, zero, np.sin(half)]),
        velocity=np.tile([0, 0, 2.0], (n, 1)),
        angular_velocity=np.column_stack([zero, zero, rate]),
        kinetic_energy=2.0 + 0.5 * rate**2,
        balance=Balance(
            1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.1, np.array([1.0, 2, 3]), np.array([4.0, 5, 6]), np.zeros(3), np.zeros(3)
        ),
    )
