"""Reference answers of the cases that have no table to quote.

Most are by SciPy's DOP853 at its tightest tolerance: the equations are written anew here, with rotation matrices
instead of quaternions, and only the mass properties of the meshes come from rbfem. The tumble is by mpmath's elliptic
functions to 50 digits, the satellite that only pitches by SciPy's.

python cases/reference.py
"""

from pathlib import Path
from types import SimpleNamespace

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

import rbfem
from rbfem.fem.surface_loads import pressure_wrench

MESHES = Path(__file__).parents[1] / "meshes"
GRAVITY = np.array([0.0, 0.0, -9.81])
IDENTITY = np.eye(3)


def skew(a):
    """[a]×, so that skew(a) @ b = a × b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def final_motion(body, position, spin_body, velocity, wrench, end, gravity=0.0 * GRAVITY, attitude=IDENTITY):
    """Centre of mass, rotation matrix, velocity and body angular velocity at the end.

    wrench(t, position, rotation, velocity, spin_body) -> force in world axes, torque in body axes
    """

    def rates(t, y):
        x, rotation, v, w = y[:3], y[3:12].reshape(3, 3), y[12:15], y[15:]
        force, torque = wrench(t, x, rotation, v, w)
        spin = np.linalg.solve(body.inertia, torque - np.cross(w, body.inertia @ w))
        return np.concatenate([v, (rotation @ skew(w)).ravel(), gravity + force / body.mass, spin])

    start = np.concatenate([position, attitude.ravel(), velocity, spin_body])
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


def box(size, density):
    """Mass, and the tensor about the centre."""
    mass, square = density * np.prod(size), np.square(size)
    return SimpleNamespace(mass=mass, inertia=np.diag(mass / 12 * (square.sum() - square)))


def held(body, lever):
    """The same body about a point at -lever from its centre: Steiner."""
    about = body.inertia + body.mass * (lever @ lever * IDENTITY - np.outer(lever, lever))
    return SimpleNamespace(mass=body.mass, inertia=about)


def top(name, body, lever, attitude, spin, end):
    """A body held at the origin, its centre at `lever` in its own axes, under gravity."""

    def weight(t, position, rotation, velocity, spin):
        return np.zeros(3), np.cross(lever, rotation.T @ (body.mass * GRAVITY))

    about = held(body, lever)
    energy = 0.5 * spin @ about.inertia @ spin - body.mass * GRAVITY @ attitude @ lever
    _, rotation, _, w = final_motion(about, np.zeros(3), spin, np.zeros(3), weight, end, attitude=attitude)
    tell(f"{name} mass", body.mass)
    tell(f"{name} energy", energy)
    tell(
        f"{name} energy of the reference minus that",
        0.5 * w @ about.inertia @ w - body.mass * GRAVITY @ rotation @ lever - energy,
    )
    tell(f"{name} position", rotation @ lever)
    tell(f"{name} angular_velocity_body", w)
    tell(f"{name} angular_momentum", rotation @ about.inertia @ w)


def lagrange_top():
    radius, height = 0.08, 0.03
    mass = 7850.0 * np.pi * radius**2 * height
    across = mass * (radius**2 / 4 + height**2 / 12)
    disc = SimpleNamespace(mass=mass, inertia=np.diag([across, across, mass * radius**2 / 2]))
    tilt = Rotation.from_rotvec([np.pi / 6, 0.0, 0.0]).as_matrix()
    top("lagrange_top", disc, np.array([0.0, 0.0, 0.06]), tilt, np.array([0.0, 0.0, 60.0]), 2.0)


def asymmetric_top():
    size = np.array([0.1, 0.2, 0.3])
    top("asymmetric_top", box(size, 2700.0), size / 2, IDENTITY, np.array([0.0, 2.0, 20.0]), 3.0)


ORBIT, PERIODS = 1.1e-3, 5


def satellites():
    """Roll, pitch and yaw are x, y and z; the orbit turns about y and begins on z."""
    body = box(np.array([2.0, 1.0, 4.0]), 125.0)
    end = 30000.0

    def field(t, position, rotation, velocity, spin):
        away = rotation.T @ [np.sin(ORBIT * t), 0.0, np.cos(ORBIT * t)]
        return np.zeros(3), 3 * ORBIT**2 * np.cross(away, body.inertia @ away)

    attitude = Rotation.from_quat([0.1, -0.15, 0.2, 0.95]).as_matrix()  # scalar last
    spin = np.array([2e-4, 1.1e-3, -3e-4])
    _, rotation, _, w = final_motion(body, np.zeros(3), spin, np.zeros(3), field, end, attitude=attitude)
    tell("satellite rocker quaternion, scalar last", Rotation.from_matrix(rotation).as_quat())
    tell("satellite rocker angular_velocity", rotation @ w)

    roll, pitch, yaw = np.diag(body.inertia)
    swing = ORBIT * np.sqrt(3 * (roll - yaw) / pitch)
    k = np.sin(np.radians(20.0))
    sn, cn, *_ = ellipj(swing * end + ellipk(k * k), k * k)
    angle, rate = np.arcsin(k * sn), swing * k * cn
    turned = ORBIT * end + angle
    tell("satellite pitcher quaternion", [np.cos(turned / 2), 0.0, np.sin(turned / 2), 0.0])
    tell("satellite pitcher angular_velocity", [0.0, ORBIT + rate, 0.0])


def tumble():
    """Torque-free rotation by Jacobi's elliptic functions, the turn about the angular momentum by quadrature.

    Landau and Lifshitz, Mechanics, section 37; their axes 1, 2, 3 are x, y, z here, in the case that goes round z.
    """
    mp.mp.dps = 60
    one, end = mp.mpf(1), mp.mpf(100000)
    size, spin = [one / 10, one / 5, 3 * one / 10], [mp.mpf(20), mp.mpf(50), mp.mpf(35)]
    mass, total = 2700 * size[0] * size[1] * size[2], sum(s * s for s in size)
    inertia = [mass / 12 * (total - s * s) for s in size]
    i1, i2, i3 = inertia
    twice_energy = sum(i * w * w for i, w in zip(inertia, spin, strict=True))
    square = sum((i * w) ** 2 for i, w in zip(inertia, spin, strict=True))
    largest = [
        mp.sqrt((twice_energy * i3 - square) / (i1 * (i3 - i1))),
        mp.sqrt((twice_energy * i3 - square) / (i2 * (i3 - i2))),
        mp.sqrt((square - twice_energy * i1) / (i3 * (i3 - i1))),
    ]
    m = (i2 - i1) * (twice_energy * i3 - square) / ((i3 - i2) * (square - twice_energy * i1))
    # ω₂ grows where (I₃ - I₁) ω₃ ω₁ > 0 and so falls here: the argument runs backwards.
    rate = -mp.sqrt((i3 - i2) * (square - twice_energy * i1) / (i1 * i2 * i3))
    begin = mp.ellipf(mp.atan2(spin[1] / largest[1], spin[0] / largest[0]), m)

    def omega(t):
        u = begin + rate * t
        return [a * mp.ellipfun(f, u, m=m) for a, f in zip(largest, ("cn", "sn", "dn"), strict=True)]

    def precession(t):
        x, y, _ = (i * w for i, w in zip(inertia, omega(t), strict=True))
        return mp.sqrt(square) * (x * x / i1 + y * y / i2) / (x * x + y * y)

    def frame(t, angle):
        """Rz(angle) Rx(θ) Rz(φ) with the direction of the angular momentum (sin θ sin φ, sin θ cos φ, cos θ)."""
        x, y, z = (i * w / mp.sqrt(square) for i, w in zip(inertia, omega(t), strict=True))
        return turn_about_z(angle) * turn_about_x(mp.acos(z)) * turn_about_z(mp.atan2(x, y))

    period = 2 * mp.ellipk(m) / abs(rate)  # of the squares
    n = int(end / period)
    rest = end - n * period
    angle = n * mp.quad(precession, mp.linspace(0, period, 9)) + mp.quad(precession, mp.linspace(0, rest, 9))
    rotation = frame(mp.mpf(0), mp.mpf(0)).T * frame(end, angle)
    w = omega(end)
    slope = (omega(mp.mpf("1e-20"))[1] - omega(mp.mpf(0))[1]) * mp.mpf("1e20") * i2 / ((i3 - i1) * spin[2] * spin[0])
    tell(
        "tumble start minus what is given, and slope over Euler's",
        [*(float(a - b) for a, b in zip(omega(mp.mpf(0)), spin, strict=True)), float(slope)],
    )
    tell("tumble revolutions", float(mp.norm(spin) * end / (2 * mp.pi)))
    tell("tumble angular_velocity_body", [float(x) for x in w])
    tell("tumble angular_velocity", [float(x) for x in rotation * mp.matrix(w)])
    tell("tumble quaternion, scalar last", Rotation.from_matrix(np.array(rotation.tolist(), dtype=float)).as_quat())


def turn_about_z(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def turn_about_x(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def tell(name, value):
    print(f"{name}: {np.array2string(np.asarray(value), precision=13, separator=', ', floatmode='unique')}")


if __name__ == "__main__":
    free_spin("t_handle", 7850.0, [0.05, 0.02, 8.0], 6.0)
    free_spin("wing_nut", 8500.0, [0.02, 0.05, 12.0], 5.0)
    swinging_bolt()
    pushed_bracket()
    lagrange_top()
    asymmetric_top()
    satellites()
    tumble()
