"""Moments of one straight tetrahedron, exact: the polynomials integrated by the factorial formula.

The functions hold only sums and products, so the same text serves one tet, a compiled loop over all of them, and whole
arrays of tets at once. Corners are a, b, c, d; coordinates are metres.
"""


def tet_volume(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Signed volume (b - a) · ((c - a) × (d - a)) / 6, and |b - a|² |c - a|² |d - a|² / 36, which its rounding follows.

    >>> tet_volume(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 3.0)
    (0.5, 0.25)
    """
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    wx, wy, wz = dx - ax, dy - ay, dz - az
    six = ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)
    square = (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz) * (wx * wx + wy * wy + wz * wz)
    return six / 6.0, square / 36.0


def tet_moments(volume, ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Integrals of x, y, z, x², y², z², xy, xz, yz over a tetrahedron of that volume.

    ∫ x dV = V/4 Σx_i,  ∫ x y dV = V/20 (Σx_i y_i + Σx_i Σy_i)

    >>> [round(120 * m, 9) for m in tet_moments(1 / 6, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)]
    [5.0, 5.0, 5.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0]
    """
    sx, sy, sz = ax + bx + cx + dx, ay + by + cy + dy, az + bz + cz + dz
    v4, v20 = 0.25 * volume, 0.05 * volume
    return (
        v4 * sx,
        v4 * sy,
        v4 * sz,
        v20 * (sx * sx + ax * ax + bx * bx + cx * cx + dx * dx),
        v20 * (sy * sy + ay * ay + by * by + cy * cy + dy * dy),
        v20 * (sz * sz + az * az + bz * bz + cz * cz + dz * dz),
        v20 * (sx * sy + ax * ay + bx * by + cx * cy + dx * dy),
        v20 * (sx * sz + ax * az + bx * bz + cx * cz + dx * dz),
        v20 * (sy * sz + ay * az + by * bz + cy * cz + dy * dz),
    )


def weighted_first_moment(volume, r, x):
    """∫ ρ x dV = V/20 (Σρ_i x_i + Σρ_i Σx_i) for fields given at the corners r[0…3], x[0…3].

    >>> round(weighted_first_moment(1.0, (1.0,) * 4, (4.0, 0.0, 0.0, 0.0)), 12)
    1.0
    """
    return 0.05 * volume * (dot(r, x) + total(r) * total(x))


def weighted_second_moment(volume, r, x, y):
    """∫ ρ x y dV = V/120 (ΣρΣxΣy + ΣρΣxy + ΣxΣρy + ΣyΣρx + 2Σρxy), all sums over the corners: a cubic integrand.

    >>> round(weighted_second_moment(1.0, (1.0,) * 4, (1.0,) * 4, (1.0,) * 4), 12)
    1.0
    """
    r_sum, x_sum, y_sum = total(r), total(x), total(y)
    pairs = r_sum * dot(x, y) + x_sum * dot(r, y) + y_sum * dot(r, x)
    triple = r[0] * x[0] * y[0] + r[1] * x[1] * y[1] + r[2] * x[2] * y[2] + r[3] * x[3] * y[3]
    return volume * (r_sum * x_sum * y_sum + pairs + 2.0 * triple) / 120.0


def total(a):
    """Σ a_i over the four corners.

    >>> total((1, 2, 3, 4))
    10
    """
    return a[0] + a[1] + a[2] + a[3]


def dot(a, b):
    """Σ a_i b_i over the four corners.

    >>> dot((1, 2, 3, 4), (1, 1, 1, 1))
    10
    """
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
