"""Measures the numbers of docs/where_methods_fail.md and draws its pictures: python docs/make_failures.py"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from rbfem.motion import loads as kinds
from rbfem.motion import quaternion
from rbfem.motion.methods import METHODS
from rbfem.motion.model import RIGID, Bodies, Loads
from rbfem.motion.state import State, System, initial_state, make_islands, move
from rbfem.study.amplification import stable_step
from rbfem.study.stability_map import growth, spinning_bodies
from rbfem.study.stability_picture import STYLE, draw_maps, maps

PICTURES = Path(__file__).parent / "pictures"
MOMENTS = np.array([1.0, 2.0, 3.0])
TORQUE = np.array([2.0, -4.0, 3.0])
INTERMEDIATE = (0.01, 5.0, 0.01)
SWINGS = np.arange(0.02, 8.0, 0.02)
KINK_STEPS = (8, 16, 32, 64, 128)
KINK_EVALUATIONS = 384  # so many steps of `kdk`, 32 of `dop853_fixed`
ROUNDING = 1e-12  # errors below say nothing about an order
CORNERS = 0.3 + 0.4 * (np.arange(32) * 0.6180339887 % 1.0)  # spread evenly over every length of step
KINK_METHODS = ("kdk", "spiral", "rk4", "lie_rk4", "rkn4", "rkn6", "dop853_fixed")


def main() -> None:
    """Print the tables as Markdown and save the pictures."""
    PICTURES.mkdir(exist_ok=True)
    for title, rows in (
        ("explicit Euler: energy after ten swings", spiral_rows()),
        ("length of the quaternion", length_rows()),
        ("free tumbling for 20 s", world_rows()),
        ("limits with spin", spin_rows()),
        ("limits with dashpots", dashpot_rows()),
        ("separatrix", separatrix_rows()),
        ("orders at a kink", kink_rows()),
    ):
        print(f"\n{title}\n")
        for row in rows:
            print("| " + " | ".join(row) + " |", flush=True)
    draw_spiral()
    draw_stability_maps()
    draw_kinks()


def body(omega, ramp=(), is_pushed=True) -> tuple[System, State]:
    """A body of the moments 1, 2, 3 that spins in body axes and feels `TORQUE`, world axes, times a ramp, if any."""
    points = np.array(ramp, dtype=float).reshape(-1, 2)
    n_loads = 1 if len(points) else 0
    loads = Loads(
        kind=np.full(n_loads, kinds.COUPLE),
        other=np.full(n_loads, -1),
        is_external=np.ones(n_loads, dtype=np.int64),
        values=np.tile(np.concatenate([TORQUE, np.zeros(6)]), (n_loads, 1)),
        ramp=np.zeros(n_loads, dtype=np.int64),
        ramp_first=np.array([0, len(points)]) if n_loads else np.zeros(1, dtype=np.int64),
        ramp_time=np.ascontiguousarray(points[:, 0]),
        ramp_factor=np.ascontiguousarray(points[:, 1]),
    )
    bodies = Bodies(
        model=np.array([RIGID]),
        mass=np.ones(1),
        inverse_mass=np.ones(1),
        inverse_moments=1.0 / MOMENTS[None],
        arm=np.zeros((1, 3)),
        first_load=np.array([0, n_loads]),
        is_pushed=np.array([int(is_pushed)]),
    )
    none = np.zeros((1, 3))
    state = initial_state(none, np.array([[1.0, 0.0, 0.0, 0.0]]), none, np.array([omega]) * MOMENTS)
    islands = make_islands(np.array([0]), np.array([0, 1]), loads, bodies.first_load)
    return System(bodies, loads, islands, np.zeros(3)), state


def turned(a: State, b: State) -> float:
    """Angle between two attitudes, rad."""
    return float(quaternion.angle_between(quaternion.normalize(a.quaternion), quaternion.normalize(b.quaternion))[0])


def energy(system: System, state: State) -> float:
    return float(0.5 * (state.angular_momentum**2 * system.bodies.inverse_moments).sum())


def orbit(method: str, swing: float, swings: float) -> tuple[np.ndarray, np.ndarray]:
    """Stretch of the spring over its first amplitude and its rate in the same unit, after every step."""
    one = np.array([swing])
    system, quiet = spinning_bodies(one, 0.0 * one, 0.0 * one)
    state = replace(quiet, velocity=np.array([[0.0, 0.0, 1e-3]]))
    too_heavy_to_turn = np.full((1, 3), 1e-12)
    system = replace(system, bodies=system.bodies._replace(inverse_moments=too_heavy_to_turn))
    frequency = np.sqrt(system.loads.values[0, 6])
    n = round(swings * 2.0 * np.pi / frequency)
    stretch, rate = [], []
    for _ in range(n):
        stretch.append(state.position[0, 2] * frequency / 1e-3)
        rate.append(state.velocity[0, 2] / 1e-3)
        state = move(state, 1.0, 1, method, system, "serial")
    return np.array(stretch), np.array(rate)


def spiral_rows() -> Iterator[tuple[str, ...]]:
    for method in ("euler", "semi_implicit_euler", "kdk", "rk4"):
        found = []
        for swing in (0.1, 0.05, 0.025):
            stretch, rate = orbit(method, swing * np.sqrt(2.5), 10.0)
            found.append(f"{stretch[-1] ** 2 + rate[-1] ** 2:.3g}")
        yield (f"`{method}`", *found)


def length_rows() -> Iterator[tuple[str, ...]]:
    """After 100 turns about the axis of the largest moment, wobbling a little."""
    for method in ("rk4_world", "rk4"):
        system, start = body((0.02, 0.02, 1.0), is_pushed=False)
        found = []
        for steps in (20, 40, 80):
            n = 100 * steps
            end = move(start, 200.0 * np.pi / n, n, method, system, "serial")
            found.append(f"{np.linalg.norm(end.quaternion) - 1.0:+.1e}")
        yield (f"`{method}`", *found)


def world_rows() -> Iterator[tuple[str, ...]]:
    """Energy gained and angle lost in 20 s of tumbling, 100 steps a second."""
    system, start = body((1.0, 2.0, 0.5), is_pushed=False)
    exact = move(start, 20.0, 1, "exact", system, "serial")
    for method in ("euler", "semi_implicit_euler", "rk4_world", "rk4", "lie_rk4", "dlm", "kdk"):
        end = move(start, 0.01, 2000, method, system, "serial")
        gain = energy(system, end) / energy(system, start) - 1.0
        yield f"`{method}`", f"{gain:+.1e}", f"{turned(end, exact):.1e}"


def longest(method: str, damping_ratio: float, spin_ratio: float) -> str:
    """dt ω_max up to which a disturbance of a sprung body does not grow."""
    grown = growth(method, SWINGS, np.full_like(SWINGS, damping_ratio), np.full_like(SWINGS, spin_ratio))
    first = int(np.argmax(grown > 0.0))
    return f"{SWINGS[first - 1]:.2f}" if first > 5 else "none"


def spin_rows() -> Iterator[tuple[str, ...]]:
    for method in ("kdk", "dlm", "spiral", "rk4", "lie_rk4", "rk4_world", "semi_implicit_euler", "euler"):
        yield (f"`{method}`", *(longest(method, 0.0, spin) for spin in (0.0, 0.1, 0.3, 1.0)))


def dashpot_rows() -> Iterator[tuple[str, ...]]:
    ratios = (0.0, 0.1, 0.5, 1.0)
    yield ("2(√(1 + ζ²) - ζ)", *(f"{2.0 * (np.hypot(1.0, z) - z):.2f}" for z in ratios))
    for method in ("spiral", "semi_implicit_euler", "kdk", "dlm", "rk4"):
        yield (f"`{method}`", *(longest(method, ratio, 0.0) for ratio in ratios))
        yield (f"`{method}`, theory", *(f"{stable_step(method, 1.0, ratio):.2f}" for ratio in ratios))


def separatrix_rows() -> Iterator[tuple[str, ...]]:
    """Angle lost in 20 s with a spin near the intermediate axis, and near the largest for comparison."""
    for method in ("semi_implicit_euler", "dlm", "spiral", "rk4", "lie_rk4", "dop853_fixed"):
        yield (f"`{method}`", *(f"{_lost(method, omega):.1e}" for omega in (INTERMEDIATE, (0.01, 0.01, 5.0))))
    found = []
    for small in ((1e-8, 5.0, 1e-8), (1e-8, 1e-8, 5.0)):
        system, start = body(small, is_pushed=False)
        nudged = replace(start, angular_momentum=start.angular_momentum + np.array([[1e-8, 0.0, 0.0]]))
        found.append(max(_apart(system, start, nudged, time) for time in np.linspace(0.1, 20.0, 200)))
    yield ("two exact motions whose starts differ by 1e-8 rad/s", *(f"{angle:.1e}" for angle in found))


def _apart(system: System, a: State, b: State, time: float) -> float:
    return turned(move(a, time, 1, "exact", system, "serial"), move(b, time, 1, "exact", system, "serial"))


def _lost(method: str, omega: tuple) -> float:
    """Angle to the exact motion after 20 s in steps of 5 ms; as a pushed body, or some methods would be exact too."""
    system, start = body(omega)
    exact = move(start, 20.0, 1, "exact", body(omega, is_pushed=False)[0], "serial")
    return turned(move(start, 0.005, 4000, method, system, "serial"), exact)


def ramp_of(kind: str, corner: float) -> tuple:
    """A torque without a kink between 0 and 1 s, with a corner there, or with a jump."""
    return {
        "smooth": ((-1.0, 0.5), (2.0, 1.5)),
        "corner": ((-1.0, 0.0), (corner, 0.0), (2.0, 2.0)),
        "jump": ((-1.0, 0.0), (corner, 0.0), (corner + 1e-9, 1.0), (2.0, 1.0)),
    }[kind]


def kink_errors(method: str, kind: str, steps: tuple[int, ...] = KINK_STEPS) -> np.ndarray:
    """Error after 1 s for each number of steps, root of the mean square over where in a step the kink lies."""
    found = []
    for corner in CORNERS:
        system, start = body((1.2, 2.2, -1.4), ramp_of(kind, corner))
        reference = start
        for until in (corner, corner + 1e-9, 1.0):
            step = (until - reference.time) / 400
            reference = move(reference, step, 400, "dop853_fixed", system, "serial")
        found.append([turned(move(start, 1.0 / n, n, method, system, "serial"), reference) for n in steps])
    return np.sqrt(np.mean(np.square(found), axis=0))


def order_of(errors: np.ndarray) -> str:
    """Slope of log error against log step above rounding."""
    above = errors > ROUNDING
    if above.sum() < 2:
        return "rounding"
    return f"{np.polyfit(-np.log(np.array(KINK_STEPS)[above]), np.log(errors[above]), 1)[0]:.1f}"


def kink_rows() -> Iterator[tuple[str, ...]]:
    """Orders on a smooth torque, at a corner and at a jump; then the errors with `KINK_EVALUATIONS`, and the steps."""
    kinds_of_torque = ("smooth", "corner", "jump")
    for method in KINK_METHODS:
        orders = [order_of(kink_errors(method, kind)) for kind in kinds_of_torque]
        steps = round(KINK_EVALUATIONS / METHODS[method].evaluations)
        errors = [f"{kink_errors(method, kind, (steps,))[0]:.1e}" for kind in kinds_of_torque]
        yield (f"`{method}`", *orders, str(steps), *errors)


def draw_spiral() -> None:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(8.4, 3.3), facecolor="white")
        panels = figure.subplots(1, 3)
        for axes, method in zip(panels, ("euler", "semi_implicit_euler", "kdk"), strict=True):
            stretch, rate = orbit(method, 0.1 * np.sqrt(2.5), 5.0)
            axes.plot(stretch, rate, color="#0072B2", linewidth=1.0, marker=".", markersize=2)
            axes.set(xlim=(-5.2, 5.2), ylim=(-5.2, 5.2), aspect="equal", xlabel="stretch", title=method)
            axes.spines[["top", "right"]].set_visible(False)
            axes.tick_params(length=0)
        panels[0].set_ylabel("rate of the stretch")
        figure.tight_layout()
        figure.savefig(PICTURES / "euler_spiral.png", dpi=100)


def draw_stability_maps() -> None:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(12.0, 5.0), facecolor="white")
        draw_maps(figure, maps(), None, left=0.05)
        figure.savefig(PICTURES / "stability_maps.png", dpi=100)


def draw_kinks() -> None:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    titles = {"smooth": "smooth torque", "corner": "a corner inside a step", "jump": "a jump inside a step"}
    hues = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#3A3A3A")
    with rc_context(STYLE):
        figure = Figure(figsize=(10.0, 3.9), facecolor="white")
        panels = figure.subplots(1, 3, sharey=True)
        for axes, (kind, title) in zip(panels, titles.items(), strict=True):
            for method, hue in zip(KINK_METHODS, hues, strict=True):
                line = kink_errors(method, kind)
                evaluations = METHODS[method].evaluations * np.array(KINK_STEPS)
                axes.plot(evaluations, line, color=hue, marker="o", markersize=3, label=method)
            axes.set(xscale="log", yscale="log", xlabel="evaluations", title=title)
            axes.grid(color="#E4E4E4", linewidth=0.7)
            axes.tick_params(length=0, which="both")
        panels[0].set_ylabel("attitude error after 1 s, rad")
        panels[1].legend(frameon=False, fontsize=8, loc="lower left")
        figure.tight_layout()
        figure.savefig(PICTURES / "kinks.png", dpi=100)


if __name__ == "__main__":
    main()
