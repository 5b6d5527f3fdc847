"""The free rotors, a call at a time on one core: a moderate step, any duration at all, and the split rotor."""

import numpy as np
from measuring import Effort, Row, in_time, smallest_times

from rbfem.compute.loops import loop
from rbfem.motion.rotor import turn_by_splitting, turn_freely

N_CALLS = 2e5
NANOSECONDS_A_CALL, NANOSECONDS_A_LONG_CALL = 300.0, 1000.0
RECIPROCALS = (1.0, 1.0 / 2.0, 1.0 / 3.0)
STATE = (1.0, 0.0, 0.0, 0.0, 0.7, 0.8, 0.9)
STEP, LONG = 0.3, 1e4  # s; a quarter of a radian, and a thousand turns


def rotor(effort: Effort) -> list[Row]:
    """All rows of this file."""
    n = max(1, round(N_CALLS * effort.share))
    exact, split = loop(turn_on_and_on, "serial"), loop(split_on_and_on, "serial")
    tasks = [lambda: exact(*run(STEP, n)), lambda: exact(*run(LONG, n)), lambda: split(*run(STEP, n))]
    short, long, splitting = (seconds / n for seconds in smallest_times(effort.rounds, *tasks))
    return [
        limit_row("exact rotor, a step of a quarter radian", short, NANOSECONDS_A_CALL),
        limit_row("exact rotor, a thousand turns in one call", long, NANOSECONDS_A_LONG_CALL),
        Row(
            "exact rotor against five plain rotations", in_time(short), f"{in_time(splitting)} split", short / splitting
        ),
    ]


def limit_row(name: str, seconds: float, nanoseconds: float) -> Row:
    limit = nanoseconds * 1e-9
    return Row(f"{name}, one core", f"{in_time(seconds)} a call", f"{in_time(limit)} allowed", seconds / limit, 1.0)


def run(duration: float, n: int):
    return np.array(STATE), np.array(RECIPROCALS), duration, n


def turn_on_and_on(state, reciprocals, duration, n_calls):
    q0, q1, q2, q3, l1, l2, l3 = state[0], state[1], state[2], state[3], state[4], state[5], state[6]
    r1, r2, r3 = reciprocals[0], reciprocals[1], reciprocals[2]
    for _ in range(n_calls):
        q0, q1, q2, q3, l1, l2, l3 = turn_freely(q0, q1, q2, q3, l1, l2, l3, r1, r2, r3, duration)
    state[0], state[1], state[2], state[3], state[4], state[5], state[6] = q0, q1, q2, q3, l1, l2, l3


def split_on_and_on(state, reciprocals, duration, n_calls):
    q0, q1, q2, q3, l1, l2, l3 = state[0], state[1], state[2], state[3], state[4], state[5], state[6]
    r1, r2, r3 = reciprocals[0], reciprocals[1], reciprocals[2]
    for _ in range(n_calls):
        q0, q1, q2, q3, l1, l2, l3 = turn_by_splitting(q0, q1, q2, q3, l1, l2, l3, r1, r2, r3, duration)
    state[0], state[1], state[2], state[3], state[4], state[5], state[6] = q0, q1, q2, q3, l1, l2, l3
