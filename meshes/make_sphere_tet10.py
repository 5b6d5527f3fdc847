"""A sphere of radius 0.05 m in second-order tets whose surface nodes lie on the sphere.

python meshes/make_sphere_tet10.py [FOLDER]
"""

from drawing import folder_from_command_line

from rbfem.mesh.generate import generate

if __name__ == "__main__":
    generate("sphere:radius=0.05", folder_from_command_line() / "sphere_tet10.msh", size=0.017, order=2)
