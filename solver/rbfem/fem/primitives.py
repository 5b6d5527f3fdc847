"""Shapes that need no mesh: exact mass properties, and a surface to draw. The centre is the origin, the axes principal.

Source of the tensors: Goldstein, Classical Mechanics, 3rd ed., chapter 5; any handbook of mechanics.
"""

from math import pi
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rbfem.fem.mass_properties import MassProperties, composed, from_tensor
from rbfem.mesh.generate import solid_moments
from rbfem.mesh.primitives import Primitive

Array = NDArray[np.float64]

SEGMENTS = 32  # around a round primitive when it is drawn; the inertia does not come from this


def primitive_properties(primitive: Primitive, density: float) -> MassProperties:
    """Exact mass properties: I_xx = m (⟨y²⟩ + ⟨z²⟩) with the mean squares of the shape.

    Box: ⟨x²⟩ = a²/3. Ellipsoid: a²/5. Cylinder: a²/4 across, h²/3 along, h the half height.

    >>> ball = primitive_properties(Primitive("sphere", (1.0, 1.0, 1.0)), 3 / (4 * np.pi))
    >>> ball.principal_moments
    array([0.4, 0.4, 0.4])
    """
    shares = {"box": (3.0, 3.0, 3.0), "cylinder": (4.0, 4.0, 3.0)}.get(primitive.kind, (5.0, 5.0, 5.0))
    mean_square = np.square(primitive.extent) / shares
    mass = density * primitive.volume
    tensor = mass * np.diag(mean_square[[1, 0, 0]] + mean_square[[2, 2, 1]])
    return from_tensor(mass, primitive.volume, np.zeros(3), tensor)


def solid_properties(source: str | Path, density: float) -> MassProperties:
    """Mass properties of the solids of a STEP or IGES file, in metres, as OpenCASCADE integrates them."""
    solids = solid_moments(source)
    return composed(
        from_tensor(density * volume, volume, np.array(center), density * np.reshape(tensor, (3, 3)))
        for volume, center, tensor in zip(solids["volumes"], solids["centers"], solids["tensors"], strict=True)
    )


def primitive_surface(primitive: Primitive) -> tuple[Array, NDArray[np.int64]]:
    """Points (p, 3) m on the surface and triangles (t, 3), normals outward."""
    unit = {"box": _unit_box, "cylinder": _unit_cylinder}.get(primitive.kind, _unit_sphere)
    points, triangles = unit()
    return points * primitive.extent, triangles


def _unit_box() -> tuple[Array, NDArray[np.int64]]:
    points = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])


def _unit_cylinder() -> tuple[Array, NDArray[np.int64]]:
    angle = 2.0 * pi * np.arange(SEGMENTS) / SEGMENTS
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.vstack([np.c_[ring, -np.ones(SEGMENTS)], np.c_[ring, np.ones(SEGMENTS)], [[0, 0, -1], [0, 0, 1]]])
    low = np.arange(SEGMENTS)
    after = np.roll(low, -1)
    high, high_after, bottom, top = low + SEGMENTS, after + SEGMENTS, 2 * SEGMENTS, 2 * SEGMENTS + 1
    side = [np.stack([low, after, high_after], axis=1), np.stack([low, high_after, high], axis=1)]
    caps = [
        np.stack([after, low, np.full(SEGMENTS, bottom)], axis=1),
        np.stack([high, high_after, np.full(SEGMENTS, top)], axis=1),
    ]
    return points, np.vstack(side + caps)


def _unit_sphere() -> tuple[Array, NDArray[np.int64]]:
    """Rings of points between two poles."""
    n_rings = SEGMENTS // 2 - 1
    latitude, longitude = np.arange(1, n_rings + 1) / (n_rings + 1), np.arange(SEGMENTS) / SEGMENTS
    polar, angle = np.meshgrid(pi * latitude, 2.0 * pi * longitude)
    rings = np.stack([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)], axis=-1)
    points = np.vstack([rings.transpose(1, 0, 2).reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    low = np.arange(SEGMENTS)
    after = np.roll(low, -1)
    top, bottom = len(points) - 2, len(points) - 1
    triangles = [np.stack([np.full(SEGMENTS, top), low, after], axis=1)]
    for ring in range(n_rings - 1):
        upper, lower = ring * SEGMENTS, (ring + 1) * SEGMENTS
        triangles.append(np.stack([upper + low, lower + low, lower + after], axis=1))
        triangles.append(np.stack([upper + low, lower + after, upper + after], axis=1))
    last = (n_rings - 1) * SEGMENTS
    triangles.append(np.stack([last + after, last + low, np.full(SEGMENTS, bottom)], axis=1))
    return points, np.vstack(triangles)
