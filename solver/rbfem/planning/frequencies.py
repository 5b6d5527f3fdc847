"""The fastest swing, decay and spin of a scene, from which the longest stable step follows."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.methods import Method
from rbfem.motion.model import FIXED, TRANSLATING, Islands, Loads
from rbfem.scene.scene import Scene

Array = NDArray[np.float64]

DENSE_BODIES = 50  # above, Lanczos finds the largest eigenvalue of an island sooner than a dense solver


@dataclass(frozen=True)
class Frequencies:
    """oscillation: ω_max of the springs and hanging weights, rad/s; decay: largest c/2m of the dampers and drags, 1/s;
    spin: largest rate of rotation at the start and what the given torques can add until the end, rad/s."""

    oscillation: float
    decay: float
    spin: float

    @property
    def step_limit(self) -> float:
        """Longest step that any method is held to: 2/(√(ω² + β²) + β), which is 2/ω_max without damping; and 2/spin.
        Infinite where nothing moves so. With ζ = β/ω the first is 2 (√(1 + ζ²) - ζ)/ω: that of an explicit step with a
        dashpot."""
        damped = np.hypot(self.oscillation, self.decay) + self.decay
        fastest = max(float(damped), self.spin)
        return 2.0 / fastest if fastest > 0.0 else np.inf


@dataclass(frozen=True)
class StepLimit:
    """seconds: the longest step, infinite where nothing limits it; rule: what it comes from, such as 2/ω."""

    seconds: float
    rule: str


def step_limit(fastest: Frequencies, method: Method) -> StepLimit:
    """The longest step that a plan lets a method take.

    2/(√(ω² + β²) + β), which is 2/ω without dampers, and 2/spin, whichever is shorter. A method that turns bodies
    exactly is not limited by a spin, and its implicit dampers leave 2/max(ω, β). 2 becomes the method's own limit
    where that is smaller; what grows at every step has none.

    >>> from rbfem.motion.methods import METHODS
    >>> fastest = Frequencies(oscillation=3.0, decay=4.0, spin=20.0)
    >>> step_limit(fastest, METHODS["rk4"]), step_limit(fastest, METHODS["kdk"])
    (StepLimit(seconds=0.1, rule='2/spin'), StepLimit(seconds=0.5, rule='2/β'))
    """
    omega, beta = fastest.oscillation, fastest.decay
    reach = min(2.0, method.oscillation_limit or 2.0)
    if method.turns_exactly:
        rates = {f"{reach:g}/ω": omega / reach, "2/β": beta / 2.0}
    else:
        rule = f"{reach:g}/(√(ω² + β²) + β)" if beta else f"{reach:g}/ω"
        rates = {rule: (float(np.hypot(omega, beta)) + beta) / reach, "2/spin": fastest.spin / 2.0}
    rule = max(rates, key=lambda one: rates[one])
    return StepLimit(1.0 / rates[rule] if rates[rule] else np.inf, rule)


def frequencies(scene: Scene, models: NDArray[np.int64], islands: Islands) -> Frequencies:
    """Frequencies of the scene as it stands at the start.

    Each spring counts with its stiffness in every direction and with its lever arms, ω² = k (1/m + (r×n)·I⁻¹(r×n)); a
    weight or force of size f on an arm a counts with the rotational stiffness it has when it pulls along the arm, which
    is the largest: f a across the arm, and none about it. So does the pull of a spring on its lever, as at the start.
    The gradient of a field of rate n counts as ω² = 3 n² |I_j - I_k|/I_i + n².
    """
    scale = _inverse_root_mass(scene, models)
    found: dict[bytes, tuple[float, float]] = {}
    swing = decay = 0.0
    for members in _islands_with_loads(scene, islands):
        key = _fingerprint(scene, members, models)
        if key not in found:
            found[key] = _fastest(scene, members, scale)
        swing, decay = max(swing, found[key][0]), max(decay, found[key][1])
    return Frequencies(float(np.sqrt(max(swing, 0.0))), 0.5 * max(decay, 0.0), _fastest_spin(scene, models))


def _inverse_root_mass(scene: Scene, models: NDArray[np.int64]) -> Array:
    """(n, 6) square roots of the inverse masses and inverse principal moments; zero for what a model leaves out."""
    mass = np.repeat(scene.mass[:, None], 3, axis=1)
    scale = 1.0 / np.sqrt(np.hstack([mass, scene.reference.moments]))
    scale[scene.is_held, :3] = 0.0
    scale[models == FIXED] = 0.0
    scale[models == TRANSLATING, 3:] = 0.0
    return scale


def _islands_with_loads(scene: Scene, islands: Islands) -> Iterator[NDArray[np.int64]]:
    has_load = (np.diff(scene.first_load) > 0) | scene.is_held
    for first, last in zip(islands.first[:-1], islands.first[1:], strict=True):
        members = islands.member[first:last]
        if has_load[members].any():
            yield members


def _fingerprint(scene: Scene, members: NDArray[np.int64], models: NDArray[np.int64]) -> bytes:
    """Bodies alone that share part, model and loads share frequencies: copies are computed once."""
    if len(members) > 1:
        return members.tobytes()
    body = int(members[0])
    rows = slice(scene.first_load[body], scene.first_load[body + 1])
    values = scene.loads.values[rows].copy()
    for row in np.flatnonzero(scene.loads.kind[rows] == kinds.SPRING):
        values[row, 3:6] = (_tension(scene, rows.start + row, body), 0.0, 0.0)  # all that the far end matters for
    size = bytes([int(models[body])]) + scene.part_of[body].tobytes() + scene.reference.offset[body].tobytes()
    return size + scene.loads.kind[rows].tobytes() + scene.loads.ramp[rows].tobytes() + values.tobytes()


def _fastest(scene: Scene, members: NDArray[np.int64], scale: Array) -> tuple[float, float]:
    """Largest eigenvalues of M^-½ K M^-½ and M^-½ C M^-½ of an island."""
    place = {int(body): index for index, body in enumerate(members)}
    columns, stiffness, damping = [], [], []
    for body in place:
        for row in range(scene.first_load[body], scene.first_load[body + 1]):
            for block, k, c in _terms(scene, row, body, place, scale):
                columns.append(block)
                stiffness.append(k)
                damping.append(c)
        if scene.is_held[body]:
            weight = scene.mass[body] * np.linalg.norm(scene.gravity)
            arm = scene.reference.arm[body]
            columns.append({place[body]: _swing_rows(body, arm, scale)})
            stiffness.append(weight * _length(arm))
            damping.append(0.0)
    return _largest(columns, stiffness, len(members)), _largest(columns, damping, len(members))


def _terms(
    scene: Scene, row: int, body: int, place: dict[int, int], scale: Array
) -> Iterator[tuple[dict, float, float]]:
    """What a load adds: rows (3, 6) by body, already scaled by M^-½, with a stiffness and a damping."""
    kind, values = scene.loads.kind[row], scene.loads.values[row]
    if kind == kinds.SPRING:
        other = int(scene.loads.other[row])
        block = {place[body]: _lever_rows(scene, body, values[0:3], scale)}
        share = 1.0
        if other in place:
            block[place[other]] = -_lever_rows(scene, other, values[3:6], scale)
            share = 0.5  # the far body's row of the table brings the other half
        yield block, share * values[6], share * values[7]
        pull = _tension(scene, row, body)
        yield {place[body]: _swing_rows(body, values[0:3], scale)}, pull * _length(values[0:3]), 0.0
    elif kind == kinds.FORCE:
        arm = values[3:6]
        force = float(_largest_factor(scene.loads, scene.loads.ramp[row])) * _length(values[0:3])
        yield {place[body]: _swing_rows(body, arm, scale)}, force * _length(arm), 0.0
    elif kind == kinds.DRAG:
        yield {place[body]: _lever_rows(scene, body, scene.reference.arm[body], scale)}, 0.0, float(values[0])
        yield {place[body]: np.diag(scale[body])[3:]}, 0.0, float(values[1])
    elif kind == kinds.GRADIENT:
        yield {place[body]: _gradient_rows(scene, body, scale)}, float(values[0]) ** 2, 0.0


def _tension(scene: Scene, row: int, body: int) -> float:
    """Size of the force of a spring as it stands at the start, N."""
    values, other = scene.loads.values[row], int(scene.loads.other[row])
    far = values[3:6] if other < 0 else _lever_point(scene, other, values[3:6])
    length = _length(far - _lever_point(scene, body, values[0:3]))
    return float(values[6]) * abs(length - float(values[8]))


def _lever_point(scene: Scene, body: int, lever: Array) -> Array:
    """World position of a lever (reference point, principal axes) at the start."""
    from_center = scene.reference.offset[body] + quaternion.rotate(scene.reference.quaternion[body], lever)
    return scene.position[body] + quaternion.rotate(scene.quaternion[body], from_center)


def _lever_rows(scene: Scene, body: int, lever: Array, scale: Array) -> Array:
    """M^-½ and then the velocity of a lever a: v + R (ω × a), with ω in principal axes: (3, 6)."""
    to_world = quaternion.to_matrix(quaternion.product(scene.quaternion[body], scene.reference.quaternion[body]))
    turning = to_world @ np.cross(np.eye(3), lever).T
    return np.hstack([np.eye(3), turning]) * scale[body]


def _swing_rows(body: int, arm: Array, scale: Array) -> Array:
    """M^-½ and then the turning across an arm: BᵀB = E - â âᵀ, (3, 6)."""
    length = _length(arm)
    across = np.cross(np.eye(3), arm / length) if length > 0.0 else np.zeros((3, 3))
    return np.hstack([np.zeros((3, 3)), across]) * scale[body]


def _gradient_rows(scene: Scene, body: int, scale: Array) -> Array:
    """M^-½ and then the turning about each axis i as a field's gradient resists it, BᵀB = 3 |I_j - I_k| + I_i: (3, 6).

    The torque 3 n² (I_j - I_k) r_j r_k changes by no more than 3 n² |I_j - I_k| times a turn of the body; I_i stands
    for the field's own turning at the rate n.
    """
    moments = scene.reference.moments[body]
    stiffness = 3.0 * np.abs(np.roll(moments, -1) - np.roll(moments, -2)) + moments
    return np.diag(np.r_[np.zeros(3), np.sqrt(stiffness)] * scale[body])[3:]


def _largest(columns: list[dict[int, Array]], weights: list[float], n_bodies: int) -> float:
    """Largest eigenvalue of Σ w BᵀB with the blocks B (3, 6) of each term."""
    if n_bodies <= DENSE_BODIES:
        matrix = np.zeros((6 * n_bodies, 6 * n_bodies))
        for block, weight in zip(columns, weights, strict=True):
            for i, left in block.items():
                for j, right in block.items():
                    matrix[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] += weight * left.T @ right
        return float(np.linalg.eigvalsh(matrix)[-1])
    return _largest_sparse(columns, weights, n_bodies)


def _largest_sparse(columns: list[dict[int, Array]], weights: list[float], n_bodies: int) -> float:
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import eigsh

    if not any(weights):
        return 0.0
    entries = [
        (3 * term + row, 6 * body + column, np.sqrt(weight) * block[row, column])
        for term, (blocks, weight) in enumerate(zip(columns, weights, strict=True))
        for body, block in blocks.items()
        for row in range(3)
        for column in range(6)
    ]
    rows, cols, values = zip(*entries, strict=True)
    root = coo_array((values, (rows, cols)), shape=(3 * len(columns), 6 * n_bodies)).tocsr()
    start = np.random.default_rng(0).normal(size=6 * n_bodies)  # the same every time, so that a plan is too
    largest = eigsh(root.T @ root, k=1, which="LA", v0=start, return_eigenvectors=False, tol=1e-4)[0]
    return float(largest) * (1.0 + 1e-4)


def _fastest_spin(scene: Scene, models: NDArray[np.int64]) -> float:
    spin = np.linalg.norm(scene.angular_velocity, axis=1)
    kind, values = scene.loads.kind, scene.loads.values
    torque = np.where((kind == kinds.COUPLE)[:, None], values[:, 0:3], values[:, 3:6])
    lasting = np.where((kind == kinds.COUPLE) | (kind == kinds.WRENCH), np.linalg.norm(torque, axis=1), 0.0)
    owners = np.repeat(np.arange(scene.n_bodies), np.diff(scene.first_load))
    gained, steady = np.zeros(scene.n_bodies), np.zeros(scene.n_bodies)
    np.add.at(gained, owners, _lasting_factor(scene) * lasting / scene.reference.moments[owners, 0])
    np.add.at(steady, owners, _largest_factor(scene.loads, scene.loads.ramp) * lasting)
    drag = np.zeros(scene.n_bodies)
    np.add.at(drag, owners, np.where(kind == kinds.DRAG, values[:, 1], 0.0))
    settles_at = np.divide(steady, drag, out=np.full(scene.n_bodies, np.inf), where=drag > 0.0)
    spin = spin + np.minimum(gained, settles_at)
    return float(spin[models > TRANSLATING].max(initial=0.0))


def _lasting_factor(scene: Scene) -> Array:
    """∫ |factor| dt over the run of the ramp of each row of the load table, s; the run's length without a ramp."""
    loads, end = scene.loads, scene.end_time
    areas = [end]
    for first, last in itertools.pairwise(loads.ramp_first):
        times = np.unique(np.clip([0.0, *loads.ramp_time[first:last], end], 0.0, end))
        factors = np.abs(np.interp(times, loads.ramp_time[first:last], loads.ramp_factor[first:last]))
        areas.append(float(np.trapezoid(factors, times)))
    return np.array(areas)[loads.ramp + 1]


def _largest_factor(loads: Loads, ramp: NDArray[np.int64]) -> Array:
    """The largest size that each of these ramps reaches; 1 for -1, no ramp."""
    if len(loads.ramp_factor) == 0:
        return np.ones(np.shape(ramp))
    largest = np.maximum.reduceat(np.abs(loads.ramp_factor), loads.ramp_first[:-1])
    return np.where(ramp >= 0, largest[ramp], 1.0)


def _length(vector: Array) -> float:
    return float(np.linalg.norm(vector))
