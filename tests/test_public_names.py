"""What `import rbfem` offers, and the example of the documentation."""

import inspect
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rbfem

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("name", rbfem.__all__)
def test_every_public_name_imports_and_explains_itself(name):
    thing = getattr(rbfem, name)
    assert inspect.getdoc(thing)
    assert thing.__module__.startswith("rbfem.")
    assert thing.__name__ == name


def test_the_list_of_names_is_the_list_of_homes():
    assert sorted(rbfem.__all__) == sorted(rbfem._HOME)
    assert set(rbfem.__all__) <= set(dir(rbfem))


@pytest.mark.parametrize("name", ["load", "plan", "simulate", "read_mesh", "mass_properties"])
def test_every_parameter_of_a_public_function_is_annotated(name):
    signature = inspect.signature(getattr(rbfem, name))
    assert all(one.annotation is not inspect.Parameter.empty for one in signature.parameters.values())
    assert signature.return_annotation is not inspect.Signature.empty


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'lod'"):
        rbfem.lod  # noqa: B018


def test_importing_rbfem_alone_imports_nothing_heavy():
    code = "import rbfem, sys; print(*sys.modules)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment())
    modules = set(told.stdout.split())
    assert "rbfem" in modules and not modules & {"numpy", "numba", "vtkmodules", "meshio", "pydantic", "click"}


def environment():
    return os.environ | {"PYTHONPATH": str(ROOT / "solver")}


def test_load_plan_simulate_is_all_it_takes():
    scene = rbfem.load(ROOT / "cases/cylinder")
    plan = rbfem.plan(scene)
    frames = list(rbfem.simulate(scene, plan))
    assert isinstance(scene, rbfem.Scene) and isinstance(plan, rbfem.Plan) and isinstance(frames[0], rbfem.Frame)
    assert [frames[0].time, frames[-1].time] == [0.0, scene.end_time]
    run = rbfem.simulate(scene, plan)
    assert isinstance(run, rbfem.Run) and len(list(run)) == len(frames)
    assert all(result.passed for result in run.expectations) and run.expectations


def test_overrides_are_taken_by_load_too():
    assert rbfem.load(ROOT / "cases/cylinder", ["time.end=0.2"]).end_time == 0.2


def test_read_mesh_and_mass_properties_are_all_it_takes():
    mesh = rbfem.read_mesh(ROOT / "meshes/bracket.msh")
    properties = rbfem.mass_properties(mesh, 7850.0)
    assert isinstance(mesh, rbfem.TetMesh) and isinstance(properties, rbfem.MassProperties)
    assert properties.mass == pytest.approx(7850 * properties.volume, rel=1e-14)
    np.testing.assert_allclose(properties.inertia, properties.inertia.T, rtol=1e-15)


@pytest.mark.parametrize(("error", "code"), [("RunError", 1), ("InputError", 2), ("MissingLibraryError", 3)])
def test_errors_know_their_exit_code_and_share_a_base(error, code):
    assert getattr(rbfem, error).exit_code == code
    assert issubclass(getattr(rbfem, error), rbfem.RbfemError)
