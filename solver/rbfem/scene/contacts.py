"""From the rules of contact in a case to the walls and the table of laws."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbfem.case.contacts import ANY, ContactRule
from rbfem.case.schema import Body, Case
from rbfem.case.shapes import Material, PlaneShape
from rbfem.contact.damping import damping_ratio_for
from rbfem.contact.model import DAMPING, FRICTION, LAW, LAW_NAMES, LAW_WIDTH, NONE, NORMAL, TANGENTIAL
from rbfem.scene.scene import Walls

LAWS = {name: law for law, name in LAW_NAMES.items()}
TANGENTIAL_SHARE = 2.0 / 7.0  # of the normal stiffness: sticking then swings as long as the bodies touch


@dataclass(frozen=True)
class Contacts:
    """Walls, the law of each pair of materials (m², LAW_WIDTH), the material of each body, and whether it can touch."""

    walls: Walls
    laws: NDArray[np.float64]
    material: NDArray[np.int64]
    can_touch: NDArray[np.bool_]


def is_plane(case: Case, body: Body) -> bool:
    """Whether a body of the case is a wall."""
    return isinstance(case.shapes[body.shape], PlaneShape)


def build_contacts(case: Case, bodies: tuple[Body, ...]) -> Contacts:
    """What of a case is about contact. Raises InputError with the line of the case.

    bodies : those that are no planes
    """
    names = list(case.materials)
    counts = [body.count for body in bodies]
    material = np.repeat([names.index(body.material) if body.material in names else -1 for body in bodies], counts)
    walls = _walls(case, names)
    present = {body.material for body in case.bodies}
    laws = np.zeros((len(names) ** 2, LAW_WIDTH))
    laws[:, LAW] = NONE
    meets = np.zeros(len(names), dtype=bool)
    for a, first in enumerate(names):
        for b, second in enumerate(names):
            rule = _rule_of(case, first, second)
            if rule is not None and {first, second} <= present:
                laws[a * len(names) + b] = _law(case, *rule, first, second)
                meets[a] = True
    can_touch = meets[material] & (material >= 0)
    can_touch &= bool((can_touch & ~np.repeat([body.fixed for body in bodies], counts)).any())  # someone has to move
    for body in bodies:
        shape = case.shapes[body.shape]
        if body.material not in names or not meets[names.index(body.material)]:
            continue
        if body.loads or body.pivot is not None:
            key = "loads" if body.loads else "pivot"
            raise case.error(
                f"bodies.{body.name}.{key}",
                f"a body that touches others takes no {key} in this version; take a material that no rule of "
                "`contacts` fits",
            )
        if shape.kind != "sphere":
            raise case.error(
                f"bodies.{body.name}.shape",
                f"contact of a {shape.kind} is not in this version: spheres touch each other and planes; take a "
                "sphere, or a material that no rule of `contacts` fits",
            )
    return Contacts(walls, laws, material, can_touch)


def _walls(case: Case, names: list[str]) -> Walls:
    planes = [(body, case.shapes[body.shape]) for body in case.bodies if is_plane(case, body)]
    rows = np.zeros((len(planes), 4))
    for row, (_, shape) in zip(rows, planes, strict=True):
        assert isinstance(shape, PlaneShape)
        normal = np.array(shape.plane.normal) / np.linalg.norm(shape.plane.normal)
        row[:3], row[3] = normal, normal @ shape.plane.point
    material = np.array([names.index(body.material) for body, _ in planes], dtype=np.int32)
    return Walls(tuple(body.name for body, _ in planes), rows, material)


def _rule_of(case: Case, first: str, second: str) -> tuple[int, ContactRule] | None:
    for index, rule in enumerate(case.contacts):
        if rule.between == ANY or sorted(rule.between) == sorted((first, second)):
            return index, rule
    return None


def _law(case: Case, index: int, rule: ContactRule, first: str, second: str) -> NDArray[np.float64]:
    row = np.zeros(LAW_WIDTH)
    row[LAW], row[FRICTION], row[DAMPING] = LAWS[rule.law], rule.friction, damping_ratio_for(rule.restitution)
    if rule.normal_stiffness is not None:
        row[NORMAL] = rule.normal_stiffness
        row[TANGENTIAL] = rule.tangential_stiffness or TANGENTIAL_SHARE * rule.normal_stiffness
        return row
    for name in (first, second):
        for key in ("young", "poisson"):
            if getattr(case.materials[name], key) is None:
                raise case.error(f"contacts.{index}", f"the law hertz needs '{key}' of material '{name}'")
    row[NORMAL], row[TANGENTIAL] = effective_moduli(case.materials[first], case.materials[second])
    return row


def effective_moduli(first: Material, second: Material) -> tuple[float, float]:
    """E* = 1/((1 - ν₁²)/E₁ + (1 - ν₂²)/E₂) and G* = 1/((2 - ν₁)/G₁ + (2 - ν₂)/G₂) with G = E/2(1 + ν), in Pa.

    Source: K. L. Johnson, Contact Mechanics, 1985, eq. 4.24 and 7.43.
    """
    normal, shear = 0.0, 0.0
    for material in (first, second):
        assert material.young is not None and material.poisson is not None
        e, nu = material.young, material.poisson
        normal += (1.0 - nu * nu) / e
        shear += 2.0 * (2.0 - nu) * (1.0 + nu) / e
    return 1.0 / normal, 1.0 / shear
