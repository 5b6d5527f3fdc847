"""The table is made and says what it must. Nothing here is about speed: sizes are tiny and the times mean nothing."""

import sys

import numpy as np
import pytest
from compare import BENCHMARKS, main, measure, ratio_in_words, table
from measuring import Effort, Row, smallest_times
from peers_benchmark import ATTITUDE_IN_TIME, PEERS, free_tumbling, heavy_top, longest_steps, true_end, turned
from sheared_block import A, block_of_tets, block_surface, exact_tensor
from start_up_benchmark import numpy_row, t_handle_row

import rbfem
from rbfem.mesh.surface import enclosed_volume

TINY = Effort(share=1e-3, rounds=1)


@pytest.fixture
def no_peers(monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", None)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.setitem(sys.modules, "exudyn", None)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("accuracy", ("above the one asked for", "above the one printed", "cheapest fixed method")),
        ("inertia", ("a tet", "triangles", "moved by 1e+06 sizes", "memory for")),
        ("motion", ("two cores", "called as a run does", "on a spring", "MuJoCo")),
        ("peers", ("Lagrange top", "top in drag", "free tumbling", "its plan and its check", "all cores")),
        ("rotor", ("quarter radian", "thousand turns", "plain rotations")),
        ("start-up", ("`rbfem --help`", "modules of NumPy", "cases/t_handle")),
        ("writing", ("moved, written, renamed", ".pvd and .csv")),
    ],
)
def test_each_benchmark_gives_its_rows_and_skips_a_missing_peer_by_name(name, words, no_peers):
    text = table(measure([name], TINY))
    for word in words:
        assert word in text
    for peer in {"inertia": ["trimesh"], "motion": ["mujoco"], "peers": ["mujoco", "exudyn"]}.get(name, []):
        assert f"| skipped: {peer} is not installed |" in text
    assert len({line.count(" | ") for line in text.splitlines()[2:]}) == 1


def test_with_its_peer_there_the_row_has_a_ratio():
    pytest.importorskip("trimesh")
    rows = [row for row in measure(["inertia"], TINY) if "trimesh" in row.benchmark]
    assert rows
    assert all(row.ratio > 0 and not row.skipped for row in rows)


@pytest.mark.parametrize("library", PEERS)
def test_a_peer_computes_the_same_motion(library):
    pytest.importorskip(library)
    for race in (free_tumbling(TINY), heavy_top(TINY)):
        end = true_end(race)
        for name, task_of in PEERS[library](race):
            _, task = longest_steps(race, name, task_of, end)
            assert turned(task()[None], end) <= ATTITUDE_IN_TIME


def test_help_imports_no_numpy_and_the_row_says_so():
    row = numpy_row()
    assert (row.rbfem, row.verdict) == ("0", "met")


def test_a_case_that_is_not_there_is_skipped_by_name(monkeypatch, tmp_path):
    monkeypatch.setattr("start_up_benchmark.T_HANDLE", tmp_path)
    assert t_handle_row(TINY).verdict == "skipped: cases/t_handle is not there"


def test_every_benchmark_is_in_the_help_and_an_unknown_one_is_refused(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["compare.py", "inertie"])
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 2
    told = capsys.readouterr().err
    assert all(name in told for name in ("inertie", *BENCHMARKS))


def test_the_table_is_printed_and_written_to_the_file_asked_for(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(BENCHMARKS, "inertia", lambda effort: [Row("a", "1 s", "2 s", 0.5, asked=0.4)])
    monkeypatch.setattr(sys, "argv", ["compare.py", "inertia", "-o", str(tmp_path / "table.md")])
    main()
    assert capsys.readouterr().out == (tmp_path / "table.md").read_text()
    assert "| a | 1 s | 2 s | 0.5 | ≤ 0.4 | missed |" in (tmp_path / "table.md").read_text()


@pytest.mark.parametrize(
    ("ratio", "asked", "verdict"),
    [(1.3, 1.3, "met"), (1.31, 1.3, "missed"), (0.0, 0.0, "met"), (5.0, None, "for information")],
)
def test_a_row_is_met_up_to_what_was_asked(ratio, asked, verdict):
    assert Row("a", "b", "c", ratio, asked).verdict == verdict


def test_a_skipped_row_is_never_met():
    assert Row("a", "b", asked=1.0, skipped="trimesh is not installed").verdict == "skipped: trimesh is not installed"


def test_small_ratios_read_as_fractions():
    assert [ratio_in_words(ratio) for ratio in (0.0, 1 / 56, 0.64, 1.27)] == ["0", "1/56", "0.64", "1.27"]


def test_tasks_take_turns_and_the_first_turn_does_not_count(monkeypatch):
    clock = iter([0, 0, 9, 9, 9, 10, 20, 20, 22, 30, 30, 33, 40, 40, 41, 50, 50, 57])
    monkeypatch.setattr("measuring.time.perf_counter", lambda: next(clock))
    calls = []
    times = smallest_times(2, lambda: calls.append("a"), lambda: calls.append("b"))
    assert calls == ["a", "b"] * 3
    assert times == [1, 3]


@pytest.mark.parametrize("shift", [0.0, 100.0])
def test_tets_and_surface_of_the_sheared_block_enclose_the_volume_of_the_closed_form(shift):
    surface = block_surface(4, shift)
    volume = abs(np.linalg.det(A))
    assert enclosed_volume(surface.points, surface.triangles) == pytest.approx(volume, rel=1e-12)
    body = rbfem.mass_properties(block_of_tets((2, 3, 4), shift), 2.0, backend="numpy")
    assert body.mass == pytest.approx(2.0 * volume, rel=1e-12)
    assert body.inertia == pytest.approx(exact_tensor(2.0), rel=1e-11, abs=1e-12)


def test_the_surface_is_closed():
    surface = block_surface(3)
    edges = surface.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forward, backward = {tuple(edge) for edge in edges}, {tuple(edge) for edge in edges[:, ::-1]}
    assert len(forward) == len(edges) == 3 * 12 * 3**2
    assert forward == backward
