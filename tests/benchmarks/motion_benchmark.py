"""Body-steps of `rk4`: bodies that fall, bodies on springs, one core and two, few and many, and MuJoCo's RK4."""

from collections.abc import Callable

import numpy as np
from measuring import Effort, Row, in_time, missing, peer, smallest_times

from rbfem.motion.loads import SPRING
from rbfem.motion.model import RIGID, Bodies, Loads
from rbfem.motion.state import State, System, initial_state, make_islands, move
from rbfem.simulation.run import steps_a_call

N_BODIES, N_MANY = 1e4, 1e6
N_MUJOCO = 1e3
STEPS_A_CALL = 20
STEP = 1e-3
NANOSECONDS_A_BODY_STEP = 80.0
SHARE_ON_TWO_CORES = 0.6
GROWTH = 1.3  # what "flat" may come to, from N_BODIES to N_MANY


def motion(effort: Effort) -> list[Row]:
    """All rows of this file."""
    few, many = (max(1, round(n * effort.share)) for n in (N_BODIES, N_MANY))
    free = tumbling(few)
    return [
        *core_rows(free, few, effort),
        *growth_rows(free, tumbling(many), effort),
        spring_row(free, tumbling(few, is_sprung=True), effort),
        mujoco_row(max(1, round(N_MUJOCO * effort.share)), effort),
    ]


def core_rows(free: tuple[State, System], n: int, effort: Effort) -> list[Row]:
    tasks = stepping(free, STEPS_A_CALL, "serial"), stepping(free, STEPS_A_CALL, "parallel")
    one, two = (seconds / (n * STEPS_A_CALL) for seconds in smallest_times(2 * effort.rounds, *tasks))
    limit = NANOSECONDS_A_BODY_STEP * 1e-9
    name, reference = f"rk4, {n} bodies under gravity", f"{in_time(one)} on one"
    return [
        Row(f"{name}, one core", f"{in_time(one)} a body-step", f"{in_time(limit)} allowed", one / limit, 1.0),
        Row(f"{name}, two cores", f"{in_time(two)} a body-step", reference, two / one, SHARE_ON_TWO_CORES),
    ]


def growth_rows(few: tuple[State, System], many: tuple[State, System], effort: Effort) -> list[Row]:
    """The same steps a call for both, and the steps a call that a run would make of each."""
    n_few, n_many = (len(state.position) for state, _ in (few, many))
    rows = []
    for name, steps in (
        (f"{STEPS_A_CALL} steps a call", (STEPS_A_CALL, STEPS_A_CALL)),
        ("called as a run does", (steps_a_call(n_few, "serial"), steps_a_call(n_many, "serial"))),
    ):
        times = smallest_times(
            min(effort.rounds, 7), stepping(few, steps[0], "serial"), stepping(many, steps[1], "serial")
        )
        a_step = times[0] / (n_few * steps[0]), times[1] / (n_many * steps[1])
        title = f"rk4, {n_many} bodies under gravity, one core, {name}"
        reference = f"{in_time(a_step[0])} with {n_few}"
        rows.append(Row(title, f"{in_time(a_step[1])} a body-step", reference, a_step[1] / a_step[0], GROWTH))
    return rows


def spring_row(free: tuple[State, System], sprung: tuple[State, System], effort: Effort) -> Row:
    n = len(free[0].position)
    tasks = stepping(sprung, STEPS_A_CALL, "serial"), stepping(free, STEPS_A_CALL, "serial")
    pushed, coasting = (seconds / (n * STEPS_A_CALL) for seconds in smallest_times(effort.rounds, *tasks))
    name = f"rk4, {n} bodies, each on a spring, one core"
    return Row(name, f"{in_time(pushed)} a body-step", f"{in_time(coasting)} without", pushed / coasting)


def mujoco_row(n: int, effort: Effort) -> Row:
    """Free bodies without geometry, so that MuJoCo looks for no contacts."""
    name = f"rk4, {n} bodies under gravity, one core, against MuJoCo's RK4"
    tasks = [stepping(tumbling(n), STEPS_A_CALL, "serial")]
    mujoco = peer("mujoco")
    if mujoco:
        model = mujoco.MjModel.from_xml_string(free_bodies_in_mjcf(n))
        data = mujoco.MjData(model)
        tasks.append(lambda: mujoco.mj_step(model, data, nstep=STEPS_A_CALL))
    ours, *theirs = (seconds / (n * STEPS_A_CALL) for seconds in smallest_times(effort.rounds, *tasks))
    if not theirs:
        return Row(name, f"{in_time(ours)} a body-step", skipped=missing("mujoco"))
    return Row(name, f"{in_time(ours)} a body-step", f"{in_time(theirs[0])} MuJoCo", ours / theirs[0])


def stepping(bodies: tuple[State, System], steps: int, backend: str) -> Callable[[], State]:
    state, system = bodies
    return lambda: move(state, STEP, steps, "rk4", system, backend)


def tumbling(n: int, is_sprung: bool = False) -> tuple[State, System]:
    """Bodies of three different moments, thrown at random; if sprung, each by an off-centre point to a world point."""
    random = np.random.default_rng(7)
    moments = random.uniform(1.0, 1.9, (n, 3))
    n_loads = n if is_sprung else 0
    none, zeros = np.full(n_loads, -1), np.zeros(0, dtype=np.int64)
    values = np.tile([0.1, 0.1, 0.1, 0.0, 0.0, 2.0, 10.0, 0.1, 0.5], (n_loads, 1))
    loads = Loads(np.full(n_loads, SPRING), none, -none, values, none, zeros, np.zeros(0), np.zeros(0))
    first_load = np.arange(n + 1) if is_sprung else np.zeros(n + 1, dtype=np.int64)
    is_pushed = np.full(n, int(is_sprung))
    bodies = Bodies(np.full(n, RIGID), np.ones(n), np.ones(n), 1.0 / moments, np.zeros((n, 3)), first_load, is_pushed)
    islands = make_islands(np.arange(n), np.arange(n + 1), loads, first_load)
    attitude = random.normal(size=(n, 4))
    attitude /= np.linalg.norm(attitude, axis=1, keepdims=True)
    thrown = [random.normal(size=(n, 3)) for _ in range(3)]
    state = initial_state(thrown[0], attitude, thrown[1], thrown[2])
    return state, System(bodies, loads, islands, np.array([0.0, 0.0, -9.81]))


def free_bodies_in_mjcf(n: int) -> str:
    body = '<body pos="{} 0 0"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1.4 1.8"/></body>'
    bodies = "".join(body.format(3 * i) for i in range(n))
    option = f'<option integrator="RK4" timestep="{STEP}"/>'
    return f"<mujoco>{option}<worldbody>{bodies}</worldbody></mujoco>"
