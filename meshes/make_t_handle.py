"""A T-handle: bar of diameter 12 and length 80, stem of diameter 10 and length 50, rim chamfered 1 mm. Drawn in mm.

python meshes/make_t_handle.py [FOLDER]
"""

import gmsh
from drawing import edges_where, folder_from_command_line, quiet_gmsh, write_step

from rbfem.mesh.generate import generate


def draw() -> None:
    occ = gmsh.model.occ
    bar = occ.addCylinder(-40, 0, 0, 80, 0, 0, 6)
    occ.synchronize()
    ends = [tag for _, tag in gmsh.model.getEntities(2) if abs(occ.getCenterOfMass(2, tag)[0]) > 39]
    rims = edges_where(lambda box: abs(box[0]) > 39 and box[3] - box[0] < 1e-3)
    occ.chamfer([bar], rims, ends, [1.0])
    occ.fuse([(3, bar)], [(3, occ.addCylinder(0, 0, 0, 0, 0, -50, 5))])


if __name__ == "__main__":
    folder = folder_from_command_line()
    with quiet_gmsh():
        draw()
        write_step(folder / "t_handle.step")
    generate(folder / "t_handle.step", folder / "t_handle.msh", size=3.0, unit="mm")
