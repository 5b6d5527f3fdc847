"""Motion by its accuracy: evaluations to 1e-10 rad, seconds to 1e-8 rad beside MuJoCo and Exudyn, and free flyers."""

import dataclasses
import functools
import json
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from accuracy_benchmark import frames_of
from measuring import Effort, Row, in_time, missing, peer, smallest_times
from motion_benchmark import tumbling
from numpy.typing import NDArray

import rbfem
from rbfem.motion import quaternion
from rbfem.motion.state import State, System, move
from rbfem.planning.plan import Choice

Array = NDArray[np.float64]

SHORTEST = 0.02  # share of a motion that the smallest effort still goes through
REFERENCE_TOLERANCE = 1e-14  # of dop853, the reference of every attitude here
CHECKPOINTS = 4
ATTITUDE, ATTITUDE_IN_TIME = 1e-10, 1e-8  # rad: for evaluations, and for seconds
ASKED_FOR = 10.0 ** np.arange(-6.5, -11.0, -0.125)  # accuracies that are tried
LADDER = 4.0 * 2.0 ** np.arange(0.0, 10.0, 0.25)  # steps a radian that a peer tries, the fewest first

N_FREE, FREE_TIME, N_FRAMES = 1e5, 1e4, 10
FREE_SECONDS = 1.0

DISC = {"cylinder": {"radius": 0.08, "height": 0.03}}
LEANING = {"position": [0, -0.03, 0.051961524227066319], "quaternion": [0.96592582628906829, 0.25881904510252076, 0, 0]}
BOX = {"box": {"size": [0.1, 0.2, 0.3]}}


class Pushed(NamedTuple):
    """A body held at the origin: its shape and what a case says of it, how long, and the evaluations allowed."""

    shape: dict[str, Any]
    body: dict[str, Any]
    end: float
    allowed: int
    gravity: float = -9.81


# As much work each as the scenes that the limits were set on: there the classical RK4 in world axes needed 295109,
# 94692, 32807 and 29597 evaluations to 1e-10 rad. Here `rk4_world` was measured to need 287345, 98422, 32107 and 24920
# (and of dop853, 7353, 4041, 1830 and 886, where it was 6673, 2591, 1920 and 845).
PUSHED = {
    "Lagrange top": Pushed(DISC, LEANING | {"angular_velocity_body": [0, 0, 200]}, 1.3, 2000),
    "asymmetric top": Pushed(BOX, {"position": [0.05, 0.1, 0.15], "angular_velocity": [0, 2, 20]}, 3.2, 3000),
    "stiff spring against turning": Pushed(
        BOX,
        {
            "angular_velocity": [1, 2, 3],
            "loads": [{"spring": {"at": [0.05, 0.1, 0.15], "to": [0.06, 0.12, 0.1], "stiffness": 2e4}}],
        },
        0.7,
        2600,
        gravity=0.0,
    ),
    "top in drag": Pushed(
        DISC, LEANING | {"angular_velocity_body": [0, 0, 200], "loads": [{"drag": {"angular": 0.003}}]}, 0.21, 900
    ),
}


def peers(effort: Effort) -> list[Row]:
    """All rows of this file."""
    return [
        *(evaluations_row(name, pushed, effort) for name, pushed in PUSHED.items()),
        *(row for race in (free_tumbling(effort), heavy_top(effort)) for row in race_rows(race, effort)),
        *free_flyer_rows(effort),
    ]


class Plain(NamedTuple):
    """A plan that keeps the attitude within a limit when it is run once, as it stands, and the evaluations of that."""

    scene: rbfem.Scene
    plan: rbfem.Plan
    evaluations: int


def evaluations_row(name: str, pushed: Pushed, effort: Effort) -> Row:
    """Evaluations of the run itself; its pilot, its companion and what it did again are told beside them."""
    scene = scene_of(
        pushed.shape, 2700.0, {"pivot": [0, 0, 0], **pushed.body}, pushed.gravity, length(pushed.end, effort)
    )
    plain = cheapest_plan(scene, ATTITUDE)
    whole = rbfem.simulate(plain.scene, plain.plan)
    for _frame in whole:
        pass
    everything = whole.cost.evaluations + plain.plan.pilot.value
    title = f"{name}: evaluations to {ATTITUDE:g} rad at {CHECKPOINTS} times"
    words = f"{plain.evaluations} by {plain.plan.method.value}, {everything} with pilot and companion"
    return Row(title, words, f"{pushed.allowed} allowed", plain.evaluations / pushed.allowed, 1.0)


def cheapest_plan(scene: rbfem.Scene, limit: float) -> Plain:
    """Of the plans that `auto` makes of the accuracies of ASKED_FOR, the one that stays within the limit for least.

    The accuracy is chosen by the true error, as the steps of the peers are: what is asked of `auto` for the same error
    is stricter or looser, by the margin of its estimate.
    """
    reference = frames_of(scene, planned(scene), "dop853", REFERENCE_TOLERANCE)
    found = []
    for accuracy in ASKED_FOR:
        asked = dataclasses.replace(scene, accuracy=float(accuracy))
        plan = planned(asked)
        run = rbfem.simulate(asked, unchecked(plan))
        errors = [turned(one.quaternion, other.quaternion) for one, other in zip(run, reference, strict=True)]
        if max(errors) <= limit:
            found.append(Plain(asked, plan, run.cost.evaluations))
    if not found:
        raise rbfem.RunError(f"{scene.title}: no plan for an accuracy down to {ASKED_FOR[-1]:.1g} keeps {limit:g} rad")
    return min(found, key=lambda plain: plain.evaluations)


def planned(scene: rbfem.Scene) -> rbfem.Plan:
    """Compiled, on one core, whatever `auto` would do with so little work."""
    return dataclasses.replace(rbfem.plan(scene), backend=Choice("serial", "measured"))


def unchecked(plan: rbfem.Plan) -> rbfem.Plan:
    """The same method and step, run once without a companion."""
    return dataclasses.replace(plan, verify=Choice(0, "the reference tells"), redo=False)


def turned(one: Array, other: Array) -> float:
    return float(quaternion.angle_between(one, other).max())


def length(seconds: float, effort: Effort) -> float:
    return seconds * max(SHORTEST, effort.share)


def scene_of(
    shape: dict[str, Any], density: float, body: dict[str, Any], gravity: float, end: float, frames: int = CHECKPOINTS
) -> rbfem.Scene:
    """One body of one material, frames evenly spaced."""
    case = {
        "rbfem": 1,
        "shapes": {"part": shape},
        "materials": {"stuff": {"density": density}},
        "bodies": [{"name": "body", "shape": "part", "material": "stuff", **body}],
        "gravity": [0, 0, gravity],
        "time": {"end": end},
        "output": {"every": end / frames},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.yaml"
        path.write_text(json.dumps(case), encoding="utf-8")
        return rbfem.load(path)


class Race(NamedTuple):
    """A motion that others compute as well.

    name             : what it is, in a few words
    scene            : for rbfem; the frame at its end counts
    attitude         : (4,) of the body at the start
    moments          : (3,) kg m^2 about the point that stays, in the body's own axes
    arm              : (3,) m from that point to the centre of mass, body axes
    mass, weight     : kg; N, downwards
    angular_velocity : (3,) rad/s, world axes
    """

    name: str
    scene: rbfem.Scene
    attitude: Array
    moments: Array
    arm: Array
    mass: float
    weight: float
    angular_velocity: Array


Task = Callable[[], Array]  # computes the motion once more and gives the attitude at its end, (4,)


def free_tumbling(effort: Effort) -> Race:
    """Moments 1, 2, 3, thrown about the middle axis: a plate, so thin that its thickness is lost in rounding."""
    end, spin, thickness = length(20.0, effort), np.array([0.01, 5.0, 0.01]), 1e-9
    shape = {"box": {"size": [2.0**0.5, 1.0, thickness]}}
    scene = scene_of(shape, 12.0 / (2.0**0.5 * thickness), {"angular_velocity": spin.tolist()}, 0.0, end, 1)
    still = np.array([1.0, 0.0, 0.0, 0.0])
    return Race(f"{end:g} s of free tumbling", scene, still, np.array([1.0, 2.0, 3.0]), np.zeros(3), 12.0, 0.0, spin)


def heavy_top(effort: Effort) -> Race:
    """The disc of cases/heavy_top: 15 kg, 1 m from the point that holds it, 150 rad/s."""
    end, attitude, spin = length(2.0, effort), np.array([0.5, -0.5, -0.5, -0.5]), np.array([0.0, 150.0, -4.61538])
    mass, radius, thickness, gravity = 15.0, 0.25, 1e-6, 9.81
    body = {
        "position": [0, 1, 0],
        "quaternion": attitude.tolist(),
        "angular_velocity": spin.tolist(),
        "pivot": [0, 0, 0],
    }
    shape = {"cylinder": {"radius": radius, "height": thickness}}
    scene = scene_of(shape, mass / (np.pi * radius**2 * thickness), body, -gravity, end, 1)
    across = mass * (radius**2 / 4.0 + thickness**2 / 12.0 + 1.0)
    moments = np.array([across, across, mass * radius**2 / 2.0])
    arm = in_body(attitude, np.array([0.0, 1.0, 0.0]))
    return Race(f"{end:g} s of the heavy top", scene, attitude, moments, arm, mass, mass * gravity, spin)


def in_body(attitude: Array, vector: Array) -> Array:
    return quaternion.rotate_back(attitude[None], vector[None])[0]


def race_rows(race: Race, effort: Effort) -> Iterator[Row]:
    """rbfem beside each peer, each with what costs it least within the limit.

    Left out, because they are far slower: MuJoCo's implicit and semi-implicit Euler (order 1), Exudyn's generalized-α
    (order 2). Of Exudyn's explicit methods the quickest counts.
    """
    plain = cheapest_plan(race.scene, ATTITUDE_IN_TIME)
    end = true_end(race)
    ours = functools.partial(last_attitude, plain.scene, unchecked(plain.plan))
    title = f"{race.name} to {ATTITUDE_IN_TIME:g} rad"
    for library, contenders in PEERS.items():
        if peer(library) is None:
            (seconds,) = smallest_times(effort.rounds, ours)
            yield Row(f"{title}, against {library}", in_time(seconds), skipped=missing(library))
            continue
        theirs = [longest_steps(race, name, task_of, end) for name, task_of in contenders(race)]
        seconds, *others = smallest_times(effort.rounds, ours, *(task for _, task in theirs))
        best = int(np.argmin(others))
        reference = f"{in_time(others[best])} by {theirs[best][0]}"
        yield Row(f"{title}, against {library}", in_time(seconds), reference, seconds / others[best], 0.1)
    yield checked_row(title, plain, effort)


def true_end(race: Race) -> Array:
    """(1, 4), the attitude at the end."""
    return frames_of(race.scene, planned(race.scene), "dop853", REFERENCE_TOLERANCE)[-1].quaternion


def checked_row(title: str, plain: Plain, effort: Effort) -> Row:
    """What the plan and the check add, at the same accuracy; and, beside it, the stepping by itself."""
    whole, alone = smallest_times(
        effort.rounds,
        lambda: last_attitude(plain.scene, planned(plain.scene)),
        lambda: last_attitude(plain.scene, unchecked(plain.plan)),
    )
    steps = min(seconds_of_steps(plain) for _ in range(effort.rounds))
    without = f"{in_time(alone)} without, {in_time(steps)} of it for the steps of {plain.plan.method.value}"
    return Row(f"{title}, with its plan and its check", in_time(whole), without, whole / alone)


def seconds_of_steps(plain: Plain) -> float:
    """What the run itself counts: its motion, without building the system and making the frames."""
    run = rbfem.simulate(plain.scene, unchecked(plain.plan))
    for _frame in run:
        pass
    return run.cost.wall_seconds


def last_attitude(scene: rbfem.Scene, plan: rbfem.Plan) -> Array:
    *_, last = rbfem.simulate(scene, plan)
    return last.quaternion[0]


def longest_steps(race: Race, name: str, task_of: Callable[[int], Task], end: Array) -> tuple[str, Task]:
    """The first rung of the ladder within the limit, in words and as a task."""
    turns = float(np.linalg.norm(race.angular_velocity)) * race.scene.end_time
    for steps_a_radian in LADDER:
        n_steps = round(steps_a_radian * turns)
        task = task_of(n_steps)
        if turned(task()[None], end) <= ATTITUDE_IN_TIME:
            return f"{name}, {n_steps} steps", task
    raise rbfem.RunError(f"{race.name}: {name} does not get within {ATTITUDE_IN_TIME:g} rad")


def by_mujoco(race: Race) -> list[tuple[str, Callable[[int], Task]]]:
    """A ball joint at the point that stays, without geometry, so that MuJoCo looks for no contacts."""
    mujoco = peer("mujoco")
    assert mujoco is not None
    about_center = race.moments - race.mass * (race.arm @ race.arm - race.arm**2)
    spin = in_body(race.attitude, race.angular_velocity)

    def task_of(n_steps: int) -> Task:
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option integrator="RK4" timestep="{race.scene.end_time / n_steps!r}" '
            f'gravity="0 0 {-race.weight / race.mass!r}"/><worldbody><body><joint type="ball"/>'
            f'<inertial pos="{words(race.arm)}" mass="{race.mass!r}" '
            f'diaginertia="{words(about_center)}"/></body></worldbody></mujoco>'
        )
        data = mujoco.MjData(model)

        def task() -> Array:
            mujoco.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = race.attitude, spin
            mujoco.mj_step(model, data, nstep=n_steps)
            return data.qpos.copy()

        return task

    return [("RK4", task_of)]


def words(numbers: Array) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def by_exudyn(race: Race) -> list[tuple[str, Callable[[int], Task]]]:
    """Its explicit methods, on the Lie group of rotations.

    The point that stays is made the centre of a free body that has the moments about it, and the weight acts at the
    arm: the same rotation, without the constraint that the explicit methods would have to eliminate.
    """
    exudyn = peer("exudyn")
    assert exudyn is not None
    types = exudyn.DynamicSolverType
    return [(name, functools.partial(exudyn_task, race, getattr(types, name))) for name in ("RK44", "RK67", "DOPRI5")]


def exudyn_task(race: Race, solver: Any, n_steps: int) -> Task:
    import exudyn
    import exudyn.utilities as parts

    system = exudyn.SystemContainer().AddSystem()
    body = system.CreateRigidBody(
        inertia=parts.RigidBodyInertia(race.mass, np.diag(race.moments)),
        referenceRotationMatrix=matrix(race.attitude),
        initialAngularVelocity=race.angular_velocity.tolist(),
        nodeType=exudyn.NodeType.RotationRotationVector,
    )
    if race.weight:
        marker = system.AddMarker(parts.MarkerBodyPosition(bodyNumber=body, localPosition=race.arm.tolist()))
        system.AddLoad(parts.Force(markerNumber=marker, loadVector=[0.0, 0.0, -race.weight]))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.endTime = race.scene.end_time
    settings.timeIntegration.numberOfSteps = n_steps
    settings.timeIntegration.automaticStepSize = False
    settings.solution.file.write = False
    settings.solution.sensors.active = False

    def task() -> Array:
        system.SolveDynamic(settings, solverType=solver)
        rows = system.GetObjectOutputBody(body, exudyn.OutputVariableType.RotationMatrix, [0, 0, 0])
        return parts.RotationMatrix2EulerParameters(np.reshape(rows, (3, 3)))

    return task


def matrix(attitude: Array) -> Array:
    return quaternion.rotate(np.tile(attitude, (3, 1)), np.eye(3)).T


PEERS = {"mujoco": by_mujoco, "exudyn": by_exudyn}


def free_flyer_rows(effort: Effort) -> Iterator[Row]:
    """Bodies of three different moments that nothing but gravity moves, by the closed form."""
    n = max(1, round(N_FREE * effort.share))
    flyers = tumbling(n)
    tasks = [functools.partial(fly, flyers, backend) for backend in ("serial", "parallel")]
    times = smallest_times(min(effort.rounds, 5), *tasks)
    for cores, seconds in zip(("one core", "all cores"), times, strict=True):
        title = f"{n} free bodies for {FREE_TIME:g} s, {N_FRAMES} frames, {cores}"
        yield Row(title, in_time(seconds), f"{in_time(FREE_SECONDS)} allowed", seconds / FREE_SECONDS, 1.0)


def fly(flyers: tuple[State, System], backend: str) -> State:
    state, system = flyers
    for _ in range(N_FRAMES):
        state = move(state, FREE_TIME / N_FRAMES, 1, "exact", system, backend)
    return state
