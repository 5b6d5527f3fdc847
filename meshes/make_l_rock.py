"""Three L-shaped rocks about 0.1 m long: an L of two boxes whose nodes are moved by a seeded random field. In metres.

python meshes/make_l_rock.py [FOLDER]
"""

import gmsh
import numpy as np
from drawing import folder_from_command_line, quiet_gmsh

SIZE = 0.1
ROUGHNESS = 0.05


def draw() -> None:
    """An L of length 1, height 0.7 and thickness about 0.4."""
    occ = gmsh.model.occ
    occ.fuse([(3, occ.addBox(0, 0, 0, 1, 0.4, 0.4))], [(3, occ.addBox(0, 0, 0, 0.4, 0.4, 0.7))])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="rock")
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)], name="surface")


def roughen(seed: int) -> None:
    """Move every node by a few random waves. Their slope stays below one, so no tet is turned inside out."""
    generator = np.random.default_rng(seed)
    waves = generator.uniform(-8.0, 8.0, (6, 3))
    phases = generator.uniform(0.0, 2 * np.pi, 6)
    amplitudes = generator.uniform(-ROUGHNESS, ROUGHNESS, (6, 3)) * np.array([1.0, 0.8, 1.0])
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    nodes = np.reshape(coordinates, (-1, 3))
    moved = nodes + np.sin(nodes @ waves.T + phases) @ amplitudes
    for tag, node in zip(tags, SIZE * moved, strict=True):
        gmsh.model.mesh.setNode(tag, node, [])


if __name__ == "__main__":
    folder = folder_from_command_line()
    for seed in range(3):
        with quiet_gmsh():
            draw()
            gmsh.option.setNumber("Mesh.MeshSizeMax", 0.2)
            gmsh.model.mesh.generate(3)
            roughen(seed)
            gmsh.write(str(folder / f"l_rock_{seed}.msh"))
