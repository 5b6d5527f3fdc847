"""`rbfem plan`, `rbfem schema`, `rbfem mesh`, `rbfem view` and the help."""

import json
import re

import pytest
from click.testing import CliRunner

import rbfem as library
from rbfem.cli import commands, main

SPRUNG = {"shape": "ball", "position": [0.3, 0, 0], "loads": [{"spring": {"to": [0, 0, 0], "stiffness": 250.0}}]}

COMMANDS = ("run", "plan", "inertia", "mesh", "view", "schema", "chart", "stability")


def say(*words):
    return CliRunner().invoke(commands, [str(word) for word in words], catch_exceptions=False)


def test_help_is_quick_to_start_it_imports_no_numpy(rbfem):
    done = rbfem("--help", flags=("-X", "importtime"))
    assert done.returncode == 0
    imported = {line.rpartition("|")[2].strip().split(".")[0] for line in done.stderr.splitlines()}
    assert {"rbfem", "click"} <= imported
    assert not imported & {
        "numpy",
        "scipy",
        "numba",
        "pydantic",
        "ruamel",
        "pint",
        "meshio",
        "vtkmodules",
        "gmsh",
        "rich",
        "matplotlib",
    }
    for name in COMMANDS:
        assert re.search(rf"^  {name} ", done.stdout, re.MULTILINE)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself(name):
    done = say(name, "--help")
    assert done.exit_code == 0 and len(done.output) > 60


def test_the_version_is_told():
    assert library.__version__ in say("--version").output


def test_no_command_shows_the_help_and_exits_with_2(rbfem):
    done = rbfem()
    assert done.returncode == 2 and "Usage" in done.stdout + done.stderr


@pytest.mark.parametrize("words", [["rum"], ["run"], ["run", "x", "--fast"], ["inertia"], ["plan", "a", "b"]])
def test_a_command_used_wrongly_exits_with_2(words, capsys):
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    assert "Usage" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "plan"])
def test_a_case_that_is_not_there_exits_with_2(command, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main([command, str(tmp_path / "nowhere")])
    assert ended.value.code == 2
    assert "nowhere: no such file" in capsys.readouterr().err


def test_plan_tells_every_choice_and_runs_nothing(write_case, tmp_path):
    done = say("plan", write_case([SPRUNG, {"fixed": True}]))
    assert done.exit_code == 0
    for word in (
        "2 bodies",
        "translating",
        "fixed",
        "contact",
        "rkn4",
        "pilot",
        "step limit",
        "backend",
        "left out",
        " kg in all; bounding radius 0.1 to 0.187 m",
    ):
        assert word in done.output
    assert "2 bodies, 10.19 kg in all; bounding radius 0.1 to 0.187 m" in done.output
    assert [path.name for path in tmp_path.iterdir()] == ["case.yaml"]


def test_plan_as_json_is_the_whole_plan(write_case):
    case = write_case([SPRUNG])
    done = say("plan", case, "--json")
    plan = library.Plan.from_dict(json.loads(done.output))
    assert plan == library.plan(library.load(case))
    keys = {"models", "contact", "method", "step", "step_limit", "verify", "backend", "output", "left_out"}
    assert json.loads(done.output).keys() >= keys


def test_plan_takes_overrides_and_the_flag_to_go_beyond_the_limit(write_case, capsys):
    case = str(write_case([SPRUNG]))
    with pytest.raises(SystemExit) as ended:
        main(["plan", case, "--set", "time.step=0.5"])
    assert ended.value.code == 2 and "--beyond-limit" in capsys.readouterr().err
    assert "on purpose" in say("plan", case, "--set", "time.step=0.5", "--beyond-limit").output


def test_schema_is_a_json_schema_of_the_case():
    schema = json.loads(say("schema").output)
    assert schema["$schema"].startswith("https://json-schema.org/")
    assert {"shapes", "materials", "bodies", "time", "expect"} <= schema["properties"].keys()


def test_mesh_makes_tets_that_inertia_reads(tmp_path):
    pytest.importorskip("gmsh", reason="gmsh or one of its system libraries is missing", exc_type=Exception)
    target = tmp_path / "box.msh"
    done = say("mesh", "box:size=1,2,3", "-o", target, "--size", "1")
    assert done.exit_code == 0 and "rbfem inertia" in done.output
    told = json.loads(say("inertia", target, "--density", "2", "--json").output)
    assert told["mass"] == pytest.approx(12.0, rel=1e-12)


def test_view_without_results_exits_with_2(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["view", str(tmp_path)])
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert str(tmp_path) in told and "drawing" not in told
