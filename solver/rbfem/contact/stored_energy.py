"""Energy that the springs of contacts hold."""

import math

from rbfem.contact.laws import elastic_energy, normal_stiffness
from rbfem.contact.model import LAST_STIFFNESS, LAW, NONE, NORMAL, SHEAR


def find_stored_energy(spheres, pairs, walls, laws, n_materials, total):
    """Add the energy of all contacts, that of the normal springs at the present overlaps, to total[0]."""
    place, material = spheres.place, spheres.material
    for i in range(len(place)):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j = pairs.other[k]
            dx, dy, dz = place[i, 0] - place[j, 0], place[i, 1] - place[j, 1], place[i, 2] - place[j, 2]
            reach = place[i, 3] + place[j, 3]
            overlap = reach - math.sqrt(dx * dx + dy * dy + dz * dz)
            row = material[i] * n_materials + material[j]
            moves = spheres.inertia[i, 0] + spheres.inertia[j, 0] > 0.0
            if overlap > 0.0 and moves and laws[row, LAW] != NONE:
                total[0] += spring_energy(overlap, place[i, 3] * place[j, 3] / reach, row, laws, k, pairs)
    for k in range(len(walls.sphere)):
        i, w = walls.sphere[k], walls.wall[k]
        height = walls.plane[w, 0] * place[i, 0] + walls.plane[w, 1] * place[i, 1] + walls.plane[w, 2] * place[i, 2]
        overlap = place[i, 3] + walls.plane[w, 3] - height
        row = material[i] * n_materials + walls.material[w]
        if overlap > 0.0 and spheres.inertia[i, 0] > 0.0 and laws[row, LAW] != NONE:
            total[0] += spring_energy(overlap, place[i, 3], row, laws, k, walls)


def spring_energy(overlap, radius, row, laws, k, contacts):
    """½ k_n δ² or 2/5 k_n δ² of the normal spring, and ½ F²/k_t of the tangential one."""
    law = laws[row, LAW]
    energy = elastic_energy(law, normal_stiffness(law, laws[row, NORMAL], overlap, radius), overlap)
    if contacts.touches[k] and contacts.memory[k, LAST_STIFFNESS] > 0.0:
        x, y, z = contacts.memory[k, SHEAR], contacts.memory[k, SHEAR + 1], contacts.memory[k, SHEAR + 2]
        energy += 0.5 * (x * x + y * y + z * z) / contacts.memory[k, LAST_STIFFNESS]
    return energy
