import numpy as np
import pytest
from fem_meshes import ball_mesh, box_mesh

from rbfem.fem import primitives
from rbfem.fem.mass_properties import mass_properties
from rbfem.fem.primitives import Primitive, primitive_properties, primitive_surface
from rbfem.mesh.surface import enclosed_volume

BOX = Primitive("box", (0.5, 0.35, 0.2))
BALL = Primitive("sphere", (0.3, 0.3, 0.3))
EGG = Primitive("ellipsoid", (0.5, 0.4, 0.2))
CAN = Primitive("cylinder", (0.3, 0.3, 0.45))
ALL = [BOX, BALL, EGG, CAN]
each = pytest.mark.parametrize("shape", ALL, ids=lambda shape: shape.kind)

# Mass over density and the three moments over the mass, from a handbook of mechanics.
HANDBOOK = [
    (BOX, 1.0 * 0.7 * 0.4, ((0.49 + 0.16) / 12, (1.0 + 0.16) / 12, (1.0 + 0.49) / 12)),
    (BALL, 4 / 3 * np.pi * 0.027, (0.4 * 0.09,) * 3),
    (EGG, 4 / 3 * np.pi * 0.04, ((0.16 + 0.04) / 5, (0.25 + 0.04) / 5, (0.25 + 0.16) / 5)),
    (CAN, np.pi * 0.09 * 0.9, ((3 * 0.09 + 0.81) / 12, (3 * 0.09 + 0.81) / 12, 0.09 / 2)),
]


@pytest.mark.parametrize(("shape", "volume", "moments"), HANDBOOK, ids=[row[0].kind for row in HANDBOOK])
def test_mass_and_moments_are_the_handbooks(shape, volume, moments):
    body = primitive_properties(shape, 2.5)
    assert body.volume == pytest.approx(volume, rel=1e-15)
    assert body.mass == pytest.approx(2.5 * volume, rel=1e-15)
    assert body.inertia == pytest.approx(body.mass * np.diag(moments), rel=1e-14)
    assert (body.center_of_mass == 0.0).all()


def test_a_box_is_its_own_mesh():
    mesh = mass_properties(box_mesh(3, (1.0, 0.7, 0.4), (-0.5, -0.35, -0.2)), 2.5)
    assert mesh.inertia == pytest.approx(primitive_properties(BOX, 2.5).inertia, rel=1e-13, abs=1e-16)


def test_an_ellipsoids_meshes_tend_to_it():
    exact = primitive_properties(EGG, 1.0)
    errors = [np.linalg.norm(mass_properties(ball_mesh(n, EGG.extent)).inertia - exact.inertia) for n in (2, 4, 8)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2) and errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)


@each
def test_the_drawn_surface_is_closed_and_faces_outwards(shape):
    points, triangles = primitive_surface(shape)
    edges = {(int(a), int(b)) for t in triangles for a, b in zip(t, np.roll(t, -1), strict=True)}
    assert len(edges) == 3 * len(triangles)
    assert all((b, a) in edges for a, b in edges)
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ki,ki->k", normals, corners.mean(axis=1)) > 0.0).all()
    assert set(triangles.ravel()) == set(range(len(points)))


@each
def test_the_bounding_radius_is_that_of_the_farthest_point(shape):
    points, _ = primitive_surface(shape)
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(shape.bounding_radius, rel=1e-15)


@each
def test_the_drawn_volume_tends_to_the_exact_one(shape, monkeypatch):
    errors = []
    for segments in (16, 32, 64):
        monkeypatch.setattr(primitives, "SEGMENTS", segments)
        errors.append(1.0 - enclosed_volume(*primitive_surface(shape)) / shape.volume)
    if shape.kind == "box":
        assert np.abs(errors).max() < 1e-15
    else:
        assert errors[0] > errors[1] > errors[2] > 0.0
        assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)
