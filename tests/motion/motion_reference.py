"""The equations of motion a second time: vectors and matrices, angular velocity in body axes, SciPy's DOP853."""

import numpy as np
from scipy.integrate import solve_ivp

from rbfem.motion import loads as kinds
from rbfem.motion.model import FIXED


def matrix_of(q):
    """The nine entries of R(q), as the textbooks print them."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def wrench_of(body, load, t, rows, bodies):
    """Force and torque about the reference point, world axes."""
    x, q, v, omega = rows[body]
    R = matrix_of(q)
    a, w = np.array(load.values, dtype=float), R @ omega
    factor = np.interp(t, *np.transpose(load.ramp)) if load.ramp else 1.0
    if load.kind == kinds.FORCE:
        return factor * a[:3], factor * np.cross(R @ a[3:6], a[:3])
    if load.kind == kinds.COUPLE:
        return np.zeros(3), factor * a[:3]
    if load.kind == kinds.WRENCH:
        return factor * (R @ a[:3]), factor * (R @ a[3:6])
    if load.kind == kinds.DRAG:
        arm = R @ np.array(bodies[body].arm)
        force = -a[0] * (v + np.cross(w, arm))
        return force, np.cross(arm, force) - a[1] * w
    if load.kind == kinds.GRADIENT:
        away = np.cos(a[0] * t) * a[4:7] + np.sin(a[0] * t) * np.cross(a[1:4], a[4:7])
        tensor = R @ np.diag(bodies[body].moments) @ R.T
        return np.zeros(3), 3 * a[0] ** 2 * np.cross(away, tensor @ away)
    lever, end, end_velocity = R @ a[:3], a[3:6], np.zeros(3)
    if load.other >= 0:
        ox, oq, ov, oomega = rows[load.other]
        O = matrix_of(oq)
        end, end_velocity = ox + O @ a[3:6], ov + np.cross(O @ oomega, O @ a[3:6])
    reach = end - (x + lever)
    along = reach / np.linalg.norm(reach)
    stretching = along @ (end_velocity - v - np.cross(w, lever))
    force = (a[6] * (np.linalg.norm(reach) - a[8]) + a[7] * stretching) * along
    return force, np.cross(lever, force)


def rates(t, y, setting):
    """d/dt of position, quaternion, velocity and body angular velocity of each body, flat."""
    rows = [np.split(row, [3, 7, 10]) for row in y.reshape(-1, 13)]
    out = np.zeros((len(rows), 13))
    for i, (body, (_, q, v, omega)) in enumerate(zip(setting.bodies, rows, strict=True)):
        if body.model == FIXED:
            continue
        R, inertia = matrix_of(q), np.diag(body.moments)
        force, torque = body.mass * setting.gravity, np.zeros(3)
        if body.is_held:
            torque = np.cross(R @ np.array(body.arm), force)
        for load in body.loads:
            more_force, more_torque = wrench_of(i, load, t, rows, setting.bodies)
            force, torque = force + more_force, torque + more_torque
        w, x, y_, z = q
        left = np.array([[-x, -y_, -z], [w, -z, y_], [z, w, -x], [-y_, x, w]])
        if not body.is_held:
            out[i, :3], out[i, 7:10] = v, force / body.mass
        out[i, 3:7] = 0.5 * left @ omega
        out[i, 10:] = np.linalg.solve(inertia, R.T @ torque - np.cross(omega, inertia @ omega))
    return out.ravel()


def reference_motion(setting):
    """(n, 13) rows of position, unit quaternion, velocity, body angular velocity at the end, by DOP853."""
    rows = [
        np.concatenate([b.position, np.array(b.attitude, dtype=float), b.velocity, b.omega]) for b in setting.bodies
    ]
    start = np.array(rows)
    start[:, 3:7] /= np.linalg.norm(start[:, 3:7], axis=1, keepdims=True)
    # rtol and atol near rounding; the mesh of steps is then far finer than any method of the table needs.
    solution = solve_ivp(rates, (0, setting.end), start.ravel(), "DOP853", args=(setting,), rtol=1e-13, atol=1e-14)
    end = solution.y[:, -1].reshape(-1, 13)
    end[:, 3:7] /= np.linalg.norm(end[:, 3:7], axis=1, keepdims=True)
    return end
