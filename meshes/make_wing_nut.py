"""A wing nut for an M8 bolt: conical hub with a bore of 6.65 (core diameter of the thread), two wings. Drawn in mm.

python meshes/make_wing_nut.py [FOLDER]
"""

import gmsh
from drawing import folder_from_command_line, quiet_gmsh, write_step

from rbfem.mesh.generate import generate

BORE = 6.65
# One wing in the xz plane: from inside the hub, up and out to a rounded tip.
WING = [(4.5, 1.5), (13.0, 8.0), (19.0, 17.0), (11.5, 17.0), (5.0, 9.0)]


def wing(side: int) -> int:
    occ = gmsh.model.occ
    points = [occ.addPoint(side * x, -1.5, z) for x, z in WING]
    tip = occ.addPoint(side * 15.25, -1.5, 20.75)
    lines = [occ.addLine(points[k], points[k + 1]) for k in (0, 1)]
    lines.append(occ.addCircleArc(points[2], tip, points[3], center=False))
    lines += [occ.addLine(points[3], points[4]), occ.addLine(points[4], points[0])]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    return next(tag for dimension, tag in occ.extrude([(2, face)], 0, 3.0, 0) if dimension == 3)


def draw() -> None:
    occ = gmsh.model.occ
    hub = occ.addCone(0, 0, 0, 0, 0, 10, 8.0, 6.5)
    body, _ = occ.fuse([(3, hub)], [(3, wing(1)), (3, wing(-1))])
    occ.cut(body, [(3, occ.addCylinder(0, 0, -1, 0, 0, 30, BORE / 2))])


if __name__ == "__main__":
    folder = folder_from_command_line()
    with quiet_gmsh():
        draw()
        write_step(folder / "wing_nut.step")
    generate(folder / "wing_nut.step", folder / "wing_nut.msh", size=1.6, unit="mm")
