"""When a run stops to look: at outputs, at breakpoints of ramps and where something is expected."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rbfem.scene.scene import Scene

Array = NDArray[np.float64]

NEAR = 1e-9  # times this share of an output interval, or of the run if that is shorter, apart are one


@dataclass(frozen=True)
class Stop:
    """A time that a step ends at, and whether a frame is written there."""

    time: float
    is_output: bool


def output_times(scene: Scene) -> Array:
    """0, then every output interval, and the end."""
    count = math.floor(scene.end_time / scene.output_interval + NEAR)
    times: Array = scene.output_interval * np.arange(count + 1, dtype=np.float64)
    if count == 0 or scene.end_time - times[-1] > NEAR * scene.output_interval:
        return np.append(times, scene.end_time)
    times[-1] = scene.end_time
    return times


def n_frames(scene: Scene) -> int:
    """Frames of the series, the one at time zero included."""
    return len(output_times(scene))


def nearness(scene: Scene) -> float:
    """Times closer than this, s, are one."""
    return NEAR * min(scene.output_interval, scene.end_time)


def stops(scene: Scene) -> list[Stop]:
    """Every time after zero at which a step must end, ascending."""
    outputs = output_times(scene)[1:]
    at_outputs = [Stop(time, True) for time in outputs.tolist()]
    extra = np.concatenate([scene.loads.ramp_time, [expect.time for expect in scene.expectations]])
    near = nearness(scene)
    extra = extra[(extra > near) & (extra < scene.end_time)]
    if not len(extra):
        return at_outputs
    nearest = np.abs(extra[:, None] - outputs[np.searchsorted(outputs, extra).clip(0, len(outputs) - 1)][:, None])
    before = np.abs(extra[:, None] - outputs[(np.searchsorted(outputs, extra) - 1).clip(0)][:, None])
    new = np.unique(extra[(np.minimum(nearest, before) > near).ravel()])
    return sorted([*at_outputs, *(Stop(time, False) for time in new.tolist())], key=lambda stop: stop.time)


def with_looks(stops: list[Stop], step: float | None, least: int, between: int) -> list[Stop]:
    """Few stops far apart with looks in between, `least` in all, where at least `between` steps lie between two.

    >>> [stop.time for stop in with_looks([Stop(1.0, True)], 0.01, 4, 20)]
    [0.25, 0.5, 0.75, 1.0]
    >>> with_looks([Stop(1.0, True)], 0.1, 4, 20)
    [Stop(time=1.0, is_output=True)]
    """
    if step is None or len(stops) >= least:
        return stops
    every, begin = [], 0.0
    for stop in stops:
        parts = min(-(-least // len(stops)), steps_between(begin, stop.time, step) // between)
        every += [Stop(begin + i / parts * (stop.time - begin), False) for i in range(1, parts)]
        every.append(stop)
        begin = stop.time
    return every


def steps_between(start: float, end: float, step: float | None) -> int:
    """Equal steps, no longer than `step`, that fill a span: two at least, so that a companion run can take fewer; one
    for a method that needs no steps.

    >>> steps_between(0.0, 1.0, 0.3), steps_between(0.0, 1.0, 0.25), steps_between(0.0, 1.0, 9.0)
    (4, 4, 2)
    >>> steps_between(0.0, 1.0, None)
    1
    """
    return 1 if step is None else max(2, math.ceil((end - start) / step - NEAR))


def longest_step(scene: Scene, step: float) -> float:
    """The longest that is taken, s, where no step may be longer than `step`."""
    times = [0.0, *(stop.time for stop in stops(scene))]
    return max((b - a) / steps_between(a, b, step) for a, b in pairwise(times))


def total_steps(scene: Scene, step: float | None) -> int:
    """Steps of the whole run."""
    times = [0.0, *(stop.time for stop in stops(scene))]
    return int(sum(steps_between(a, b, step) for a, b in pairwise(times)))
