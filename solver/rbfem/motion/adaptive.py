"""The eighth-order method of Dormand and Prince with steps of its own choice, for each island of bodies apart.

Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, sections II.4 and II.10.
"""

import math

from rbfem.compute.loops import parallel_range
from rbfem.motion.free_flight import fly
from rbfem.motion.model import STATE_WIDTH
from rbfem.motion.runge_kutta import find_stages, leave_step, sum_up

SAFETY, LEAST_FACTOR, LARGEST_FACTOR = 0.9, 0.2, 6.0
LEAST_SHARE = 1e-13  # of the span: a step this short says that the error asked for cannot be had


def step_adaptively(
    state, ledger, t, span, first_step, tolerance, tableau, nodes, weights, estimators, flags, scale,
    bodies, loads, islands, gravity, scratch, evaluations,
):  # fmt: skip
    """Go from time t to t + span by steps whose estimated local error is at most `tolerance`, in place.

    first_step  : s, the first step that is tried, and the last is cut to hit the end
    estimators  : (2, stages) weights of the estimates of order five and three
    scale       : (n, 13) size of an error that counts as one, for each column of the state; infinite where none counts
    evaluations : (k,) of the loads of each body, added up for every island; minus one where the step came to nothing
    The other arguments are those of `step_by_runge_kutta`.
    """
    for island in parallel_range(len(islands.first) - 1):
        first, last = islands.first[island], islands.first[island + 1]
        if not bodies.is_pushed[islands.member[first]]:
            fly(islands.member[first], span, state, bodies, gravity)
            continue
        done, dt, largest = 0.0, min(first_step, span), LARGEST_FACTOR
        while done < span:
            ends = done + 1.0000001 * dt >= span
            if ends:
                dt = span - done
            find_stages(
                first, last, t + done, dt, tableau, nodes, flags, state, bodies, loads, islands, gravity, scratch
            )
            evaluations[island] += len(nodes)
            error = 0.0
            for i in range(first, last):
                one = local_error(islands.member[i], dt, estimators, scale, scratch)
                error = one if not one <= error else error
            factor = SAFETY * (error / tolerance) ** -0.125 if error > 0.0 else LARGEST_FACTOR
            if error <= tolerance:
                for i in range(first, last):
                    sum_up(islands.member[i], weights, scratch)
                    leave_step(islands.member[i], dt, state, ledger, flags, bodies, scratch)
                done = span if ends else done + dt
                dt *= min(largest, max(LEAST_FACTOR, factor))
                largest = LARGEST_FACTOR
            else:
                dt *= max(LEAST_FACTOR, factor) if factor < 1.0 else LEAST_FACTOR
                largest = 1.0
                if not dt > LEAST_SHARE * span:
                    evaluations[island] = -1
                    break


def local_error(b, dt, estimators, scale, scratch):
    """The estimate of one step in units of the scale, h e₅² / √((e₅² + e₃²/100) n); not a number if the step is not."""
    fifth, third = 0.0, 0.0
    for j in range(STATE_WIDTH):
        five, three = 0.0, 0.0
        for stage in range(estimators.shape[1]):
            five += estimators[0, stage] * scratch.rate[b, stage, j]
            three += estimators[1, stage] * scratch.rate[b, stage, j]
        fifth += (five / scale[b, j]) ** 2
        third += (three / scale[b, j]) ** 2
    total = fifth + 0.01 * third
    if total == 0.0:
        return 0.0
    return abs(dt) * fifth / math.sqrt(total * STATE_WIDTH)
