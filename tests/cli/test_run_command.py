"""`rbfem run`: exit codes, what is written and what is said."""

import csv
import json
import os
import signal
import subprocess
import time
import xml.etree.ElementTree as ElementTree

import pytest

import rbfem as library

SPRUNG = {"name": "weight", "shape": "ball", "position": [0.3, 0, 0]}
SPRUNG["loads"] = [{"spring": {"to": [0, 0, 0], "stiffness": 250.0, "damping": 1.0}}]
GRAVITY = [0, 0, -9.81]


def readable_frames(directory, name):
    """The frames that NAME.pvd lists, each parsed as far as its XML goes; their times."""
    tree = ElementTree.parse(directory / f"{name}.pvd")
    entries = tree.getroot().findall("Collection/DataSet")
    for entry in entries:
        assert b"</VTKFile>" in (directory / entry.get("file")).read_bytes()[-200:]
    return [float(entry.get("timestep")) for entry in entries]


def test_a_run_exits_with_0_and_writes_everything_that_the_design_names(rbfem, write_case, tmp_path):
    done = rbfem("run", write_case([SPRUNG], name="swing/case.yaml", time={"end": 0.1}), "-o", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, "")
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"swing.pvd", "swing_bodies.pvd", "swing.csv", "report.json", "frames"} <= names
    assert len(readable_frames(tmp_path / "out", "swing")) == 101
    for word in ("Plan of swing: 1 body", "pilot", "step limit", "left out", "error", "drift"):
        assert word in done.stdout
    lines = done.stdout.splitlines()  # what is to be copied stands on a line of its own, however long
    assert lines[-2].endswith(f"paraview {tmp_path}/out/swing.pvd") and lines[-1].endswith(f"rbfem view {tmp_path}/out")


def test_results_go_to_a_folder_of_the_name_of_the_case_by_default(rbfem, write_case, tmp_path):
    path = write_case([SPRUNG], name="swing/case.yaml", time={"end": 0.1})
    assert rbfem("run", path.parent, cwd=tmp_path).returncode == 0
    assert (tmp_path / "results/swing/report.json").exists()


def test_the_report_holds_all_that_the_design_promises(rbfem, write_case, tmp_path):
    expect = {"quantity": "bodies.weight.position", "at": 0.05, "value": [0.3, 0, 0], "tolerance": 1, "source": "near"}
    case = write_case([SPRUNG], time={"end": 0.1}, expect=[expect], gravity=GRAVITY)
    assert rbfem("run", case, "-o", tmp_path / "out").returncode == 0
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert report["rbfem"] == library.__version__
    assert report["case"] == tmp_path.name
    assert report["plan"] == json.loads(json.dumps(library.plan(library.load(case)).to_dict())) | {
        "backend": report["plan"]["backend"]  # its estimate in seconds depends on the process
    }
    assert report["error"].keys() >= {"asked", "estimated", "parts"}
    assert report["error"]["parts"].keys() >= {"mesh", "motion", "contact"}
    assert all(part["how"] for part in report["error"]["parts"].values())
    assert report["cost"].keys() >= {"wall_seconds", "steps", "force_evaluations", "body_steps_per_second"}
    assert report["cost"]["wall_seconds"].keys() >= {"read", "plan", "simulate", "write"}
    for name, brought in (("energy", "work_done"), ("momentum", "impulse"), ("angular_momentum", "impulse")):
        assert report["invariants"][name].keys() >= {"initial", "final", brought, "largest_drift"}
    assert report["final"]["time"] == 0.1
    (part,) = report["scene"]["parts"]
    assert report["scene"]["mass"] == part["mass"] == pytest.approx(1000 * part["volume"])
    assert (part["name"], part["bounding_radius"]) == ("ball", 0.1)
    body = report["final"]["bodies"]["weight"]
    assert {key: len(value) for key, value in body.items()} == {
        "position": 3,
        "quaternion": 4,
        "velocity": 3,
        "angular_velocity": 3,
    }
    (checked,) = report["expect"]
    assert checked["pass"] is True and checked["at"] == 0.05 and checked["error"] < 1 and len(checked["value"]) == 3
    assert report["warnings"] == []


def test_the_table_ends_where_the_report_does(rbfem, write_case, tmp_path):
    case = write_case([SPRUNG], name="swing/case.yaml", time={"end": 0.1})
    assert rbfem("run", case, "-o", tmp_path / "out").returncode == 0
    report = json.loads((tmp_path / "out/report.json").read_text())
    *_, last = csv.reader((tmp_path / "out/swing.csv").read_text().splitlines())
    assert float(last[0]) == report["final"]["time"]
    assert any(
        float(cell) == pytest.approx(report["final"]["bodies"]["weight"]["position"][0], rel=1e-9) for cell in last[1:]
    )


def test_the_help_says_that_a_step_of_the_case_is_not_judged_by_the_accuracy(rbfem):
    told = " ".join(rbfem("run", "--help").stdout.split())
    assert "exit code 1" in told and "step that the case gives is not judged" in told


def test_a_missed_expectation_exits_with_1_and_keeps_the_results(rbfem, write_case, tmp_path):
    expect = {"quantity": "bodies.weight.position", "value": [9, 0, 0], "tolerance": 1, "source": "wrong on purpose"}
    done = rbfem("run", write_case([SPRUNG], time={"end": 0.1}, expect=[expect]), "-o", tmp_path / "out")
    assert done.returncode == 1
    assert "MISSED" in done.stdout and "wrong on purpose" in done.stdout
    assert json.loads((tmp_path / "out/report.json").read_text())["expect"][0]["pass"] is False


def test_a_wrong_case_exits_with_2_with_all_its_errors_and_writes_nothing(rbfem, write_case, tmp_path):
    wrong = {"shape": "bal", "colour": "red", "velocity": [0, 0, "5 kg"]}
    done = rbfem("run", write_case([wrong], time={"end": -1}), "-o", tmp_path / "out")
    assert (done.returncode, done.stdout) == (2, "")
    for problem in ("no shape 'bal'; did you mean 'ball'?", "unknown key 'colour'", "5 kg", "time.end"):
        assert problem in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_a_step_beyond_the_limit_exits_with_2_unless_it_is_meant(rbfem, write_case, tmp_path, step):
    case = write_case([SPRUNG], time={"end": 2 * step, "step": step}, output={"every": 2 * step})
    done = rbfem("run", case, "-o", tmp_path / "out")
    assert done.returncode == 2 and "--beyond-limit" in done.stderr and not (tmp_path / "out").exists()
    assert rbfem("run", case, "-o", tmp_path / "out", "--beyond-limit").returncode == 0


def test_a_run_that_blows_up_exits_with_1_naming_the_body(rbfem, write_case, tmp_path):
    time = {"end": 200, "step": 0.5, "method": "semi_implicit_euler"}
    body = SPRUNG | {"loads": [{"spring": {"to": [0, 0, 0], "stiffness": 2500.0}}]}
    done = rbfem("run", write_case([body], time=time), "-o", tmp_path / "out", "--beyond-limit")
    assert done.returncode == 1
    assert "'weight'" in done.stderr and "Traceback" not in done.stderr and "Warning" not in done.stderr
    assert json.loads((tmp_path / "out/report.json").read_text())["final"]["time"] < 200


def test_set_overrides_a_value_of_a_body_by_its_name(rbfem, write_case, tmp_path):
    case = write_case([{"name": "nut"}], time={"end": 0.1})
    words = ("--set", "bodies.nut.velocity=[0, 0, 3 km/h]", "--set", "time.end=0.2")
    assert rbfem("run", case, "-o", tmp_path / "out", *words).returncode == 0
    final = json.loads((tmp_path / "out/report.json").read_text())["final"]
    assert final["time"] == 0.2
    assert final["bodies"]["nut"]["velocity"] == pytest.approx([0, 0, 3 / 3.6])


@pytest.mark.parametrize(
    "word", ["bodies.nutt.velocity=[0,0,1]", "velocity", "bodies.nut.velocity=[0,0", "time.end=soon"]
)
def test_a_wrong_override_exits_with_2_naming_it(rbfem, write_case, tmp_path, word):
    done = rbfem("run", write_case([{"name": "nut"}]), "-o", tmp_path / "out", "--set", word)
    assert done.returncode == 2 and "--set" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("kind", ["a file", "below a file", "not writable"])
def test_an_output_that_cannot_be_written_exits_with_2_before_the_run(rbfem, write_case, tmp_path, kind):
    if kind == "not writable" and os.geteuid() == 0:
        target = "/proc/rbfem"  # where not even root may write
    elif kind == "not writable":
        (tmp_path / "locked").mkdir(mode=0o500)
        target = tmp_path / "locked/out"
    else:
        (tmp_path / "taken").write_text("mine")
        target = tmp_path / ("taken" if kind == "a file" else "taken/out")
    case = write_case([SPRUNG], time={"end": 100, "step": 1e-6})  # hours, were it not for the output
    done = rbfem("run", case, "-o", target)
    assert done.returncode == 2
    assert "cannot be written" in done.stderr and "-o" in done.stderr and "Traceback" not in done.stderr
    assert kind == "not writable" or (tmp_path / "taken").read_text() == "mine"


def test_the_output_is_plain_lines_when_it_is_no_terminal(rbfem, write_case, tmp_path):
    done = rbfem("run", write_case([SPRUNG], time={"end": 0.1}), "-o", tmp_path / "out")
    for text in (done.stdout, done.stderr):
        assert "\x1b" not in text and "\r" not in text


def test_a_reader_that_goes_away_gets_no_traceback(command, write_case, tmp_path):
    line, environment = command("schema")
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as process:
        process.stdout.close()
        told = process.stderr.read().decode()
        process.wait(timeout=60)
    assert process.returncode in (0, 1)
    assert "Traceback" not in told and "BrokenPipe" not in told


# ---------------------------------------------------------------------------------------------- cut short from outside

LONG = {"time": {"end": 4, "step": 1e-3}, "output": {"every": 2e-3}}  # seconds of writing, in plain Python
COPIES = {"count": 50, "place": {"in_box": [[0, 0, 0], [1, 1, 1]]}, "angular_velocity": [1, 2, 3]}


def interrupted(command, case, out, is_under_way):
    """Press Ctrl-C on a run that is under way; returns its exit code, what it said, and the seconds it took to end."""
    line, environment = command("run", case, "-o", out)
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, text=True) as process:
        deadline = time.monotonic() + 60
        while not is_under_way() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        pressed = time.monotonic()
        _, told = process.communicate(timeout=60)
    return process.returncode, told, time.monotonic() - pressed


def test_ctrl_c_leaves_a_readable_series_and_a_report_and_exits_with_130(command, write_case, tmp_path):
    out = tmp_path / "out"
    case = write_case([SPRUNG], name="swing/case.yaml", **LONG)
    code, told, seconds = interrupted(command, case, out, lambda: (out / "frames/swing_000005.vtu").exists())
    assert code == 130
    assert "interrupted" in told and "Traceback" not in told
    assert seconds < 10
    times = readable_frames(out, "swing")
    assert len(times) >= 5
    report = json.loads((out / "report.json").read_text())
    assert report["final"]["time"] == pytest.approx(times[-1], abs=0.0021)
    assert any("before its time" in warning and "interrupted" in warning for warning in report["warnings"])
    assert not [path for path in out.rglob("*.part.*")]


def test_ctrl_c_is_heard_within_seconds_while_a_compiled_call_runs(command, write_case, tmp_path):
    """One output interval is hours of compiled steps; the time to compile or load the kernels comes before."""
    out = tmp_path / "out"
    time_ = {"end": 1e5, "step": 1e-4, "method": "rk4"}
    case = write_case([COPIES], name="many/case.yaml", time=time_, output={"every": 1e5})
    first = out / "frames/many_000000.vtu"

    def is_under_way():
        return first.exists() and time.time() - first.stat().st_mtime > 4.0

    code, told, seconds = interrupted(command, case, out, is_under_way)
    assert code == 130 and "Traceback" not in told
    assert seconds < 15
    assert readable_frames(out, "many") == [0.0]


def test_a_full_disk_exits_with_1_and_leaves_the_frames_before_it_readable(command, write_case, tmp_path):
    """A limit on the size of a file stands in for the disk: the table outgrows it while the run goes on."""
    resource = pytest.importorskip("resource")

    def small_disk():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))

    case = write_case([SPRUNG], name="swing/case.yaml", time={"end": 1, "step": 1e-3}, output={"every": 1e-3})
    line, environment = command("run", case, "-o", tmp_path / "out")
    done = subprocess.run(
        line, env=environment, preexec_fn=small_disk, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 1
    assert "could not be written" in done.stderr and "readable" in done.stderr and "Traceback" not in done.stderr
    assert len(readable_frames(tmp_path / "out", "swing")) > 100
