"""The noun of this room: a checked tetrahedral mesh in metres."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray


def no_names() -> Mapping[str, NDArray]:
    return MappingProxyType({})


@dataclass(frozen=True)
class TetMesh:
    """Nodes and tetrahedra of a part, as `read_mesh` checked them: every tet has a positive volume.

    nodes        : (n_nodes, 3) float64, metres
    tets         : (n_tets, 4) or (n_tets, 10) int64, node indices; second-order nodes in VTK's order,
                   on the edges 01, 12, 02, 03, 13, 23
    groups       : name of a physical volume group -> (k,) indices into `tets`
    surfaces     : name of a physical surface group -> (k, 3) or (k, 6) node indices, normals pointing out of the part,
                   second-order nodes on the edges 01, 12, 20
    cell_fields  : name -> (n_tets,) scalar field of the file
    point_fields : name -> (n_nodes,) scalar field of the file
    repairs      : what was changed to make the mesh usable, in words
    warnings     : what may make an answer wrong, in words
    source       : where it came from, for messages
    """

    nodes: NDArray[np.float64]
    tets: NDArray[np.int64]
    groups: Mapping[str, NDArray] = field(default_factory=no_names)
    surfaces: Mapping[str, NDArray] = field(default_factory=no_names)
    cell_fields: Mapping[str, NDArray] = field(default_factory=no_names)
    point_fields: Mapping[str, NDArray] = field(default_factory=no_names)
    repairs: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    source: str = "<memory>"

    @property
    def n_nodes(self) -> int:
        return len(self.nodes)

    @property
    def n_tets(self) -> int:
        return len(self.tets)

    @property
    def is_second_order(self) -> bool:
        return self.tets.shape[1] == 10
