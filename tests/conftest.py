"""Cases written down as dictionaries: what every room above `case` starts its tests from."""

import copy
import json
from pathlib import Path

import pytest

import rbfem
from rbfem.case.reader import read_case
from rbfem.scene.builder import build_scene

MESHES = Path(__file__).parents[1] / "meshes"

BASIS = {
    "rbfem": 1,
    "shapes": {
        "ball": {"sphere": {"radius": 0.1}},
        "brick": {"box": {"size": [0.1, 0.2, 0.3]}},
        "bracket": {"mesh": str(MESHES / "bracket.msh")},
    },
    "materials": {"steel": {"density": 7850}, "rubber": {"density": 1100}, "water": {"density": 1000}},
    "time": {"end": 1},
}


def case_of(bodies, **keys):
    """A case of these bodies; `shape` and `material` are brick and water where they are not given."""
    defaults = {"shape": "brick", "material": "water"}
    named = [{"name": f"body{index}", **defaults, **body} for index, body in enumerate(bodies)]
    case = copy.deepcopy(BASIS) | {"bodies": named}
    for key, value in keys.items():
        case[key] = BASIS[key] | value if key in ("shapes", "materials") else value
    return case


@pytest.fixture
def write_case(tmp_path):
    """Write a case of these bodies to tmp_path/case.yaml (JSON is YAML); returns the path."""

    def write(bodies, name="case.yaml", **keys):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(case_of(bodies, **keys)), encoding="utf-8")
        return path

    return write


@pytest.fixture
def scene_of(write_case):
    """The scene of a case of these bodies."""

    def load(*bodies, **keys):
        return build_scene(read_case(write_case(bodies, **keys)))

    return load


@pytest.fixture
def run_of():
    """A scene run to its end by its own plan: the finished Run, and its frames."""

    def go(scene, plan=None):
        run = rbfem.simulate(scene, plan or rbfem.plan(scene))
        return run, list(run)

    return go
