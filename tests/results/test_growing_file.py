"""Files that grow are rewritten seldom enough to be cheap and are complete in the end."""

import csv

import pytest
from toy_scene import make_frame, make_scene

from rbfem.results import growing_file
from rbfem.results.growing_file import REST, GrowingFile
from rbfem.results.table import MOST_BODIES, TableWriter


class Clock:
    """Time that passes only when somebody works; writing takes a nanosecond a byte."""

    def __init__(self, monkeypatch):
        self.now, self.last, self.rewrites, self.written = 0.0, 0.0, 0, ""
        monkeypatch.setattr(growing_file, "perf_counter", lambda: self.now)
        monkeypatch.setattr(growing_file, "write_text", self.write_text)

    def write_text(self, path, text):
        self.last = 1e-9 * len(text)
        self.now += self.last
        self.rewrites += 1
        self.written = text


@pytest.fixture
def clock(monkeypatch):
    return Clock(monkeypatch)


def test_rewriting_takes_a_hundredth_of_the_run_however_long_it_is(clock, tmp_path):
    file, n, pause = GrowingFile(tmp_path / "x.pvd", "head\n", "tail"), 20_000, 1e-6
    for _ in range(n):
        file.append("a line of some length, as long as those of a .pvd are: about eighty letters \n")
        clock.now += pause
    # The last rewrite has not had its rest yet; all others have.
    at_rest = clock.now - n * pause - clock.last
    assert at_rest <= n * pause / REST
    assert clock.rewrites < 40
    file.close()
    assert clock.written.count("\n") == n + 1
    assert clock.written.endswith("tail")


def test_a_slow_run_is_up_to_date_after_every_line(clock, tmp_path):
    file = GrowingFile(tmp_path / "x.pvd", "head\n")
    for i in range(50):
        file.append("line\n")
        assert clock.written.count("line") == i + 1
        clock.now += 1.0


def test_closing_an_up_to_date_file_writes_nothing(clock, tmp_path):
    file = GrowingFile(tmp_path / "x.pvd", "head\n")
    file.append("line\n")
    file.close()
    assert clock.rewrites == 1


def test_a_file_without_lines_still_appears(tmp_path):
    GrowingFile(tmp_path / "x.pvd", "head\n", "tail").close()
    assert (tmp_path / "x.pvd").read_text() == "head\ntail"


def read_table(scene, path, n_frames):
    table = TableWriter(scene, path)
    for i in range(n_frames):
        table.write(make_frame(scene, i))
    table.close()
    with path.open() as file:
        return list(csv.DictReader(file))


def test_the_table_holds_every_number_to_the_last_bit(scene, tmp_path):
    rows = read_table(scene, tmp_path / "toy.csv", 300)
    assert len(rows) == 300
    for i in (0, 7, 299):
        frame, row = make_frame(scene, i), {name: float(value) for name, value in rows[i].items()}
        assert row["time"] == frame.time
        assert row["energy"] == frame.balance.energy == 10.0
        assert [row[f"angular_momentum.{axis}"] for axis in "xyz"] == [4.0, 5.0, 6.0]
        assert [row[f"body.02.quaternion.{axis}"] for axis in "wxyz"] == frame.quaternion[2].tolist()
        assert [row[f"body.01.position.{axis}"] for axis in "xyz"] == frame.position[1].tolist()
        assert [row[f"body.02.angular_velocity.{axis}"] for axis in "xyz"] == frame.angular_velocity[2].tolist()


@pytest.mark.parametrize(("n_bodies", "n_columns"), [(MOST_BODIES, 13 + 13 * MOST_BODIES), (MOST_BODIES + 1, 13)])
def test_the_table_of_many_bodies_has_only_the_sums(tmp_path, n_bodies, n_columns):
    scene = make_scene(n_bodies, 0)
    (row,) = read_table(scene, tmp_path / "toy.csv", 1)
    assert len(row) == n_columns
