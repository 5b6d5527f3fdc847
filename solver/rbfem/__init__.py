"""rbfem: how a part given as a tetrahedral mesh moves, at the error you accept.

>>> import rbfem
>>> scene = rbfem.load("cases/cylinder")              # doctest: +SKIP
>>> plan = rbfem.plan(scene)                          # doctest: +SKIP
>>> for frame in rbfem.simulate(scene, plan):         # doctest: +SKIP
...     print(frame.time, frame.position[0])
"""

import importlib
from typing import TYPE_CHECKING

__version__ = "0.1.0"

if TYPE_CHECKING:
    from rbfem.errors import InputError, MissingLibraryError, RbfemError, RunError
    from rbfem.fem.mass_properties import MassProperties, mass_properties, particle_sum
    from rbfem.mesh.read import read_mesh
    from rbfem.mesh.tet_mesh import TetMesh
    from rbfem.planning.plan import Plan
    from rbfem.planning.planner import plan
    from rbfem.scene.builder import load
    from rbfem.scene.scene import Scene
    from rbfem.simulation.frame import Frame
    from rbfem.simulation.run import Run, simulate

# Where each public name lives; it is imported when it is first used, so that `rbfem --help` loads none of it.
_HOME = {
    "Frame": "rbfem.simulation.frame",
    "InputError": "rbfem.errors",
    "MassProperties": "rbfem.fem.mass_properties",
    "MissingLibraryError": "rbfem.errors",
    "Plan": "rbfem.planning.plan",
    "RbfemError": "rbfem.errors",
    "Run": "rbfem.simulation.run",
    "RunError": "rbfem.errors",
    "Scene": "rbfem.scene.scene",
    "TetMesh": "rbfem.mesh.tet_mesh",
    "load": "rbfem.scene.builder",
    "mass_properties": "rbfem.fem.mass_properties",
    "particle_sum": "rbfem.fem.mass_properties",
    "plan": "rbfem.planning.planner",
    "read_mesh": "rbfem.mesh.read",
    "simulate": "rbfem.simulation.run",
}

__all__ = [
    "Frame",
    "InputError",
    "MassProperties",
    "MissingLibraryError",
    "Plan",
    "RbfemError",
    "Run",
    "RunError",
    "Scene",
    "TetMesh",
    "load",
    "mass_properties",
    "particle_sum",
    "plan",
    "read_mesh",
    "simulate",
]


def __getattr__(name: str):
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name]), name)
    raise AttributeError(f"module 'rbfem' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
