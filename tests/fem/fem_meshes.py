"""Meshes made by hand: boxes of any grading, balls in layers, and their second-order likenesses."""

from itertools import permutations

import numpy as np

from rbfem.mesh.surface import boundary_triangles
from rbfem.mesh.tet_mesh import TetMesh

EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])


def positive(nodes, tets):
    """The tets with two corners exchanged where the volume would be negative."""
    a, b, c, d = (nodes[tets[:, i]] for i in range(4))
    inverted = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) < 0.0
    return np.where(inverted[:, None], tets[:, [0, 2, 1, 3]], tets)


def grid_mesh(x, y, z, jitter=0.0, seed=0):
    """A box cut at the given coordinates, six tets a brick; jitter moves inner nodes by that share of a brick."""
    index = np.arange(len(x) * len(y) * len(z)).reshape(len(x), len(y), len(z))
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    if jitter:
        rng = np.random.default_rng(seed)
        inner = nodes[1:-1, 1:-1, 1:-1]
        least = [np.diff(axis).min() for axis in (x, y, z)]
        inner += jitter * rng.uniform(-0.5, 0.5, inner.shape) * least
    tets = []
    i, j, k = (a.ravel() for a in np.meshgrid(*[np.arange(n - 1) for n in index.shape], indexing="ij"))
    for order in permutations(range(3)):
        corner, path = np.array([i, j, k]), []
        for axis in (None, *order):
            if axis is not None:
                corner = corner + np.eye(3, dtype=int)[:, [axis]]
            path.append(index[tuple(corner)])
        tets.append(np.stack(path, axis=1))
    nodes = np.ascontiguousarray(nodes.reshape(-1, 3))
    return TetMesh(nodes, positive(nodes, np.concatenate(tets)))


def box_mesh(n=4, size=(1.0, 0.7, 0.4), corner=(0.0, 0.0, 0.0), jitter=0.4, seed=0):
    """A box of n bricks a side."""
    axes = [np.linspace(low, low + length, n + 1) for low, length in zip(corner, size, strict=True)]
    return grid_mesh(*axes, jitter=jitter, seed=seed)


def icosahedron():
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    ring = np.array([(0, s, t * golden) for s in (-1, 1) for t in (-1, 1)], dtype=float)
    corners = np.vstack([np.roll(ring, shift, axis=1) for shift in range(3)])
    apart = np.linalg.norm(corners[:, None] - corners[None], axis=-1)
    near = np.isclose(apart, 2.0)
    faces = [
        (a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]
    ]
    return corners / np.linalg.norm(corners[0]), np.array(faces)


def ball_mesh(n, radii=(1.0, 1.0, 1.0)):
    """An ellipsoid of n layers: each side of an icosahedron in n² triangles, pushed out to a sphere, coned inwards."""
    corners, faces = icosahedron()
    index, points, triangles = {}, [], []

    def number(point):
        key = tuple(np.round(point, 9) + 0.0)
        if key not in index:
            index[key] = len(points)
            points.append(point / np.linalg.norm(point))
        return index[key]

    for face in faces:
        a, b, c = corners[face]
        at = {(i, j): number(a + (i * (b - a) + j * (c - a)) / n) for i in range(n + 1) for j in range(n + 1 - i)}
        for i, j in at:
            if i + j < n:
                triangles.append((at[i, j], at[i + 1, j], at[i, j + 1]))
            if i + j < n - 1:
                triangles.append((at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]))
    shell, triangles = np.array(points), np.sort(np.array(triangles), axis=1)
    nodes = np.vstack([np.zeros((1, 3)), *[shell * (layer / n) for layer in range(1, n + 1)]])
    tets = [np.column_stack([np.zeros(len(triangles), dtype=int), triangles + 1])]
    for layer in range(n - 1):
        low, high = triangles + 1 + layer * len(shell), triangles + 1 + (layer + 1) * len(shell)
        a, b, c = low.T
        d, e, f = high.T
        tets += [np.stack(corner, axis=1) for corner in ((a, b, c, f), (a, b, e, f), (a, d, e, f))]
    nodes = nodes * radii
    return TetMesh(nodes, positive(nodes, np.concatenate(tets)))


def second_order(mesh, radii=None):
    """The same mesh as tet10; with radii, mid-side nodes between two nodes of that ellipsoid lie on it too."""
    ends = np.sort(mesh.tets[:, EDGES].reshape(-1, 2), axis=1)
    edges, of_tet = np.unique(ends, axis=0, return_inverse=True)
    middles = mesh.nodes[edges].mean(axis=1)
    if radii is not None:
        level = np.linalg.norm(mesh.nodes / radii, axis=1)
        outside = (np.abs(level[edges] - 1.0) < 1e-9).all(axis=1)
        middles[outside] /= np.linalg.norm(middles[outside] / radii, axis=1, keepdims=True)
    tets = np.hstack([mesh.tets, mesh.n_nodes + of_tet.reshape(-1, 6)])
    return TetMesh(np.vstack([mesh.nodes, middles]), tets)


def with_surface(mesh, **groups):
    """The mesh with surface groups: name=function of the triangles' centres (k, 3) -> which belong; None: all."""
    triangles = boundary_triangles(mesh)
    centers = mesh.nodes[triangles[:, :3]].mean(axis=1)
    chosen = {name: triangles if test is None else triangles[test(centers)] for name, test in groups.items()}
    return TetMesh(mesh.nodes, mesh.tets, surfaces=chosen)


def moved(mesh, shift=(0.0, 0.0, 0.0), turn=None, scale=1.0):
    """x -> scale R x + shift."""
    nodes = scale * (mesh.nodes if turn is None else mesh.nodes @ np.asarray(turn).T)
    return TetMesh(nodes + np.asarray(shift), mesh.tets, groups=mesh.groups, surfaces=mesh.surfaces)
