"""Reference answers of the cases that have no table to quote, by SciPy's DOP853 at its tightest tolerance.

The equations are written anew here, with rotation matrices instead of quaternions; only the mass properties of the
meshes come from rbfem.

python cases/reference.py
"""

from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import rbfem
from rbfem.fem.surface_loads import pressure_wrench

MESHES = Path(__file__).parents[1] / "meshes"
GRAVITY = np.array([0.0, 0.0, -9.81])


def skew(a):
    """[a]×, so that skew(a) @ b = a × b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def final_motion(body, position, spin_body, velocity, wrench, end, gravity=0.0 * GRAVITY):
    """Centre of mass, rotation matrix, velocity and body angular velocity at the end.

    wrench(t, position, rotation, velocity, spin_body) -> force in world axes, torque in body axes
    """

    def rates(t, y):
        x, rotation, v, w = y[:3], y[3:12].reshape(3, 3), y[12:15], y[15:]
        force, torque = wrench(t, x, rotation, v, w)
        spin = np.linalg.solve(body.inertia, torque - np.cross(w, body.inertia @ w))
        return np.concatenate([v, (rotation @ skew(w)).ravel(), gravity + force / body.mass, spin])

    start = np.concatenate([position, np.eye(3).ravel(), velocity, spin_body])
    y = solve_ivp(rates, (0.0, end), start, method="DOP853", rtol=3e-14, atol=1e-16, max_step=end / 200).y[:, -1]
    return y[:3], y[3:12].reshape(3, 3), y[12:15], y[15:]


def nothing(t, position, rotation, velocity, spin):
    return np.zeros(3), np.zeros(3)


def free_spin(name, density, spin, end):
    body = rbfem.mass_properties(rbfem.read_mesh(MESHES / f"{name}.msh", "mm"), density)
    _, rotation, _, w = final_motion(body, np.zeros(3), spin, np.zeros(3), nothing, end)
    tell(f"{name} angular_velocity_body", w)
    tell(f"{name} direction of the mesh's z axis", rotation[:, 2])
    tell(f"{name} angular_velocity", rotation @ w)


def swinging_bolt():
    body = rbfem.mass_properties(rbfem.read_mesh(MESHES / "hex_bolt.msh", "mm"), 7850.0)
    lever = np.array([0.008, 0.0, 0.003]) - body.center_of_mass
    anchor, k, c, rest = np.array([0.1, 0.01, 0.06]), 20.0, 0.05, 0.05

    def spring(t, position, rotation, velocity, spin):
        line = anchor - position - rotation @ lever
        length = np.linalg.norm(line)
        rate = -line / length @ (velocity + rotation @ np.cross(spin, lever))
        force = (k * (length - rest) + c * rate) * line / length
        return force, np.cross(lever, rotation.T @ force)

    start = np.array([0.08, 0.0, 0.0]) + body.center_of_mass
    x, rotation, v, w = final_motion(body, start, np.zeros(3), np.zeros(3), spring, 2.0, GRAVITY)
    tell("swinging position", x)
    tell("swinging velocity", v)
    tell("swinging angular_velocity", rotation @ w)
    tell("hung mass", body.mass)
    omega = np.sqrt(k / body.mass)
    tell("hung center", body.center_of_mass + GRAVITY / omega**2 * (1 - np.cos(2 * omega)))


def pushed_bracket():
    mesh = rbfem.read_mesh(MESHES / "bracket.msh")
    body = rbfem.mass_properties(mesh, {"steel": 7850.0, "rubber": 1100.0})
    push = pressure_wrench(mesh, "loaded", 5e3, body.center_of_mass)
    tell("bracket mass", body.mass)
    tell("bracket force and torque at full pressure", push)

    def pressure(t, position, rotation, velocity, spin):
        factor = np.interp(t, [0.0, 0.02, 0.06, 0.08], [0.0, 1.0, 1.0, 0.0])
        return rotation @ push[:3] * factor, push[3:] * factor

    x, rotation, v, w = final_motion(body, body.center_of_mass, np.zeros(3), np.zeros(3), pressure, 0.5)
    tell("bracket position", x)
    tell("bracket velocity", v)
    tell("bracket angular_velocity", rotation @ w)


def tell(name, value):
    print(f"{name}: {np.array2string(np.asarray(value), precision=13, separator=', ', floatmode='unique')}")


if __name__ == "__main__":
    free_spin("t_handle", 7850.0, [0.05, 0.02, 8.0], 6.0)
    free_spin("wing_nut", 8500.0, [0.02, 0.05, 12.0], 5.0)
    swinging_bolt()
    pushed_bracket()
