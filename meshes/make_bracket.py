"""An L-shaped steel bracket with two bolt holes and a rubber pad on its shelf. In metres.

Volume groups `steel` and `rubber`; surface groups `bolted` (the back, against the wall) and `loaded` (top of the pad).

python meshes/make_bracket.py [FOLDER]
"""

import gmsh
from drawing import folder_from_command_line, quiet_gmsh

MILLIMETRE = 1e-3


def draw() -> None:
    """Wall plate 60 x 60 x 6 in the plane y = 0, shelf 60 x 50 x 6 from it, pad 40 x 30 x 8 on the shelf; in mm."""
    occ = gmsh.model.occ
    plate = occ.addBox(-30, 0, 0, 60, 6, 60)
    shelf = occ.addBox(-30, 0, 0, 60, 50, 6)
    holes = [(3, occ.addCylinder(x, -1, 42, 0, 8, 0, 4)) for x in (-18, 18)]
    steel, _ = occ.fuse([(3, plate)], [(3, shelf)])
    steel, _ = occ.cut(steel, holes)
    pad = occ.addBox(-20, 14, 6, 40, 30, 8)
    _, ((steel,), (rubber,)) = occ.fragment(steel, [(3, pad)])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [steel[1]], name="steel")
    gmsh.model.addPhysicalGroup(3, [rubber[1]], name="rubber")
    gmsh.model.addPhysicalGroup(2, faces_at(1, 0.0), name="bolted")
    gmsh.model.addPhysicalGroup(2, faces_at(2, 14.0), name="loaded")


def faces_at(axis: int, place: float) -> list[int]:
    boxes = {tag: gmsh.model.getBoundingBox(2, tag) for _, tag in gmsh.model.getEntities(2)}
    return [tag for tag, box in boxes.items() if abs(box[axis] - place) + abs(box[axis + 3] - place) < 1e-3]


if __name__ == "__main__":
    folder = folder_from_command_line()
    with quiet_gmsh():
        draw()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 5.0)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 10)
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.ScalingFactor", MILLIMETRE)
        gmsh.write(str(folder / "bracket.msh"))
