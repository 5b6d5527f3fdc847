"""Measures the tables of docs/inertia.md on this computer: python docs/make_inertia_table.py

First a sphere meshed at several sizes: the error of its tensor against the closed form, what Richardson's estimate
makes of it from the next coarser mesh, and the slope of the error over the edge length. Then a cube of particles: how
the sum over point masses comes to the integral. Last a mesh moved far away: rounding, measured and predicted.
"""

import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np

from rbfem.fem.inertia_error import error_against_second, tensor_distance
from rbfem.fem.mass_properties import from_tensor, mass_properties, particle_sum
from rbfem.fem.primitives import Primitive, primitive_properties
from rbfem.mesh.generate import generate
from rbfem.mesh.read import read_mesh
from rbfem.mesh.tet_mesh import TetMesh

RADIUS = 0.05
SIZES = (0.02, 0.01, 0.005, 0.0025)
KINDS = {1: "tet4", 2: "tet10"}


def main() -> None:
    """Print the tables as Markdown."""
    print("| kind | edge length | tets | error of the tensor | estimate from the row above |\n|---|---|---|---|---|")
    slopes = {KINDS[order]: sphere_rows(order) for order in KINDS}
    for kind, slope in slopes.items():
        print(f"\n{kind}: the error falls as the edge length to the power {slope:.2f}")
    print("\n| particles a side | error of the tensor |\n|---|---|")
    for n in (10, 20, 40, 80):
        print(f"| {n} | {particle_error(n):.2e} |")
    print("\n| moved by | rounding, measured | rounding, predicted |\n|---|---|---|")
    far_rows()


def sphere_rows(order: int) -> float:
    """Print the rows of one kind of tet; returns the fitted slope of log error over log edge length."""
    exact = primitive_properties(Primitive("sphere", (RADIUS,) * 3), 1000.0)
    errors, coarser = [], None
    for size in SIZES:
        mesh = sphere_mesh(size, order)
        properties = mass_properties(mesh, 1000.0)
        errors.append(tensor_distance(properties, exact))
        estimate = "" if coarser is None else f"{error_against_second(properties, mesh, *coarser).discretisation:.2e}"
        print(f"| {KINDS[order]} | {1e3 * size:g} mm | {mesh.n_tets} | {errors[-1]:.2e} | {estimate} |", flush=True)
        coarser = (properties, mesh)
    return float(np.polyfit(np.log(SIZES), np.log(errors), 1)[0])


def sphere_mesh(size: float, order: int) -> TetMesh:
    """The sphere in tets of that edge length, m."""
    with tempfile.TemporaryDirectory() as folder:
        made = generate(f"sphere:radius={RADIUS}", Path(folder, "sphere.msh"), size=size, order=order)
        return read_mesh(made.path)


def particle_error(n: int) -> float:
    """Relative error of the tensor of a unit cube made of n³ equal particles at the centres of n³ small cubes."""
    x = (np.arange(n) + 0.5) / n - 0.5
    positions = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    cube = particle_sum(np.full(n**3, 1.0 / n**3), positions)
    return tensor_distance(cube, primitive_properties(Primitive("box", (0.5, 0.5, 0.5)), 1.0))


def far_rows() -> None:
    """Print how rounding grows when a mesh of 0.1 m is moved away from the origin."""
    mesh = sphere_mesh(0.015, 1)
    exact = exact_tensor(mesh)
    for shift in (0.0, 1e2, 1e4, 1e6):
        moved = mass_properties(TetMesh(mesh.nodes + 2 * RADIUS * shift * np.array([0.6, 0.5, 0.4]), mesh.tets))
        label = f"{shift:g} body sizes" if shift else "not moved"
        print(f"| {label} | {tensor_distance(moved, exact):.1e} | {moved.rounding_error:.1e} |")


def exact_tensor(mesh: TetMesh):
    """The tensor of tet4 at density one in rational arithmetic, with no rounding until the end.

    ∫ r ⊗ r dV = V/20 (Σ r_i ⊗ r_i + s ⊗ s), s = Σ r_i, about the centre of mass
    """
    volume, first, second = Fraction(0), [Fraction(0)] * 3, [[Fraction(0)] * 3 for _ in range(3)]
    exact_nodes = [[Fraction(x) for x in node] for node in mesh.nodes.tolist()]
    for tet in mesh.tets:
        corners = [exact_nodes[i] for i in tet]
        u, v, w = ([a - b for a, b in zip(corner, corners[0], strict=True)] for corner in corners[1:])
        size = sum(u[i] * (v[i - 2] * w[i - 1] - v[i - 1] * w[i - 2]) for i in range(3)) / 6
        total = [sum(corner[i] for corner in corners) for i in range(3)]
        volume += size
        for i in range(3):
            first[i] += size * total[i] / 4
            for j in range(3):
                second[i][j] += size * (sum(c[i] * c[j] for c in corners) + total[i] * total[j]) / 20
    center = [x / volume for x in first]
    about = np.array([[float(second[i][j] - volume * center[i] * center[j]) for j in range(3)] for i in range(3)])
    return from_tensor(float(volume), float(volume), np.array(center, float), np.trace(about) * np.eye(3) - about)


if __name__ == "__main__":
    main()
