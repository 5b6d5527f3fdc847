"""A hexagon head bolt M10 x 40 after ISO 4014's main sizes: head 16 across flats and 6.4 high, chamfered at 30°,
fillet of 0.6 under the head, point chamfered 1 mm; the thread is left out. Drawn in mm.

python meshes/make_hex_bolt.py [FOLDER]
"""

import math

import gmsh
from drawing import edges_where, folder_from_command_line, quiet_gmsh, write_step

from rbfem.mesh.generate import generate

ACROSS_FLATS, HEAD, SHANK, LENGTH, FILLET = 16.0, 6.4, 10.0, 40.0, 0.6


def head() -> tuple[int, int]:
    """A hexagonal prism, its top cut by a cone of 30° that leaves a circle of 0.95 times the width."""
    occ = gmsh.model.occ
    radius = ACROSS_FLATS / math.sqrt(3)
    angles = [math.radians(60 * k + 30) for k in range(6)]
    points = [occ.addPoint(radius * math.cos(a), radius * math.sin(a), 0) for a in angles]
    lines = [occ.addLine(points[k], points[(k + 1) % 6]) for k in range(6)]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    prism = [entity for entity in occ.extrude([(2, face)], 0, 0, HEAD) if entity[0] == 3]
    top = 0.95 * ACROSS_FLATS / 2
    cone = occ.addCone(0, 0, 0, 0, 0, HEAD, top + HEAD / math.tan(math.radians(30)), top)
    (cut,), _ = occ.intersect(prism, [(3, cone)])
    return cut


def draw() -> None:
    occ = gmsh.model.occ
    shank = occ.addCylinder(0, 0, 0, 0, 0, -LENGTH, SHANK / 2)
    occ.synchronize()
    point = [tag for _, tag in gmsh.model.getEntities(2) if occ.getCenterOfMass(2, tag)[2] < -LENGTH + 1e-3]
    rim = edges_where(lambda box: box[5] < -LENGTH + 1e-3)
    occ.chamfer([shank], rim, point, [1.0])
    ((_, body),), _ = occ.fuse([head()], [(3, shank)])
    neck = edges_where(lambda box: abs(box[2]) + abs(box[5]) < 1e-3 and box[3] < SHANK / 2 + 1e-3)
    occ.fillet([body], neck, [FILLET])


if __name__ == "__main__":
    folder = folder_from_command_line()
    with quiet_gmsh():
        draw()
        write_step(folder / "hex_bolt.step")
    generate(folder / "hex_bolt.step", folder / "hex_bolt.msh", size=2.2, unit="mm")
