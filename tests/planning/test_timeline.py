"""When a run stops to look."""

import numpy as np
import pytest

from rbfem.planning.timeline import n_frames, output_times, steps_between, stops, total_steps

EXPECT = {"quantity": "bodies.body0.position", "value": [0, 0, 0], "tolerance": 1, "source": "none"}


def test_outputs_are_multiples_of_the_interval_and_the_end(scene_of):
    scene = scene_of({}, time={"end": 1}, output={"every": 0.3})
    np.testing.assert_allclose(output_times(scene), [0, 0.3, 0.6, 0.9, 1.0], rtol=1e-15)
    assert n_frames(scene) == 5


@pytest.mark.parametrize(("end", "every", "count"), [(0.7, 0.1, 8), (1.0, "1/60", 61), (4, "1/60", 241), (0.3, 0.1, 4)])
def test_an_end_that_is_a_multiple_but_for_rounding_gets_no_second_frame(scene_of, end, every, count):
    times = output_times(scene_of({}, time={"end": end}, output={"every": every}))
    assert len(times) == count
    assert times[-1] == end


@pytest.mark.parametrize("end", [1e-3, 1e-12])
def test_an_interval_beyond_the_end_gives_the_first_and_the_last_frame(scene_of, end):
    assert output_times(scene_of({}, time={"end": end}, output={"every": 5})).tolist() == [0.0, end]


def test_breakpoints_and_expectations_are_stops_without_a_frame(scene_of):
    ramp = [[-1, 0], [0, 1], [0.25, 2], [0.5, 3], [7, 4]]
    loads = [{"force": [1, 0, 0], "ramp": ramp}]
    scene = scene_of({"loads": loads}, time={"end": 1}, output={"every": 0.5}, expect=[EXPECT | {"at": 0.7}])
    assert [(stop.time, stop.is_output) for stop in stops(scene)] == [
        (0.25, False),
        (0.5, True),
        (0.7, False),
        (1.0, True),
    ]


def test_a_breakpoint_at_an_output_but_for_rounding_is_that_output(scene_of):
    loads = [{"force": [1, 0, 0], "ramp": [[0, 0], [0.1 + 0.2, 1]]}]
    scene = scene_of({"loads": loads}, time={"end": 0.6}, output={"every": 0.3})
    assert [stop.time for stop in stops(scene)] == [0.3, 0.6]


def test_steps_between_stops_are_equal_two_at_least_and_no_longer_than_asked():
    for span, step in [(1.0, 0.3), (0.1, 0.1), (1.0, 1e-3), (0.7, 0.2), (1 / 3, 1 / 300)]:
        count = steps_between(0.0, span, step)
        assert span / count <= step * (1 + 1e-8)
        assert count == 2 or span / (count - 1) > step * (1 - 1e-8)


def test_the_steps_of_a_run_are_those_between_its_stops(scene_of, run_of):
    loads = [{"force": [1, 0, 0], "ramp": [[0, 0], [0.21, 1]]}]
    scene = scene_of({"loads": loads}, time={"end": 1, "step": 0.04}, output={"every": 0.3})
    run, _ = run_of(scene)
    steps = [6, 3, 8, 8, 3]  # to 0.21, 0.3, 0.6, 0.9 and 1
    assert total_steps(scene, 0.04) == sum(steps)
    assert run.cost.steps == sum(steps) + sum((n + 1) // 2 for n in steps)  # of the companion half as many, rounded up
