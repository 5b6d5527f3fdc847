"""Who may touch whom before anything has moved by half the skin: cells as wide as the longest reach, and lists."""

from rbfem.contact.model import FORETOLD, MEMORY_WIDTH


def count_in_cells(place, low, per_length, n_cells, cell, start):
    """Number the cell of every sphere, and begin the table of where each cell's spheres stand.

    low (3,) m, corner of the grid; per_length (3,) cells a metre; n_cells (3,); cell (n,) out; start (n_cells + 1,) out
    """
    for c in range(len(start)):
        start[c] = 0
    for i in range(len(place)):
        a = min(max(int((place[i, 0] - low[0]) * per_length[0]), 0), n_cells[0] - 1)
        b = min(max(int((place[i, 1] - low[1]) * per_length[1]), 0), n_cells[1] - 1)
        c = min(max(int((place[i, 2] - low[2]) * per_length[2]), 0), n_cells[2] - 1)
        cell[i] = (c * n_cells[1] + b) * n_cells[0] + a
        start[cell[i] + 1] += 1
    for c in range(len(start) - 1):
        start[c + 1] += start[c]


def sort_into_cells(cell, start, order):
    """order (n,) out: the spheres cell by cell. `start` is used up, and comes back as it was."""
    for i in range(len(cell)):
        order[start[cell[i]]] = i
        start[cell[i]] += 1
    for c in range(len(start) - 1, 0, -1):
        start[c] = start[c - 1]
    start[0] = 0


def list_pairs(place, skin, n_cells, start, first, other):
    """List the pairs nearer than `skin` of spheres in the order of their cells, each at the first of the two.

    A cell is wider than the longest reach, so a partner stands in the 27 cells around. Those that come later: the rest
    of this cell and the next in its row, and three cells each of the four rows ahead.

    first (n + 1,) out     other : out
    returns : how many pairs there are; what does not fit into `other` is not written
    """
    count = 0
    for c in range(n_cells[2]):
        for b in range(n_cells[1]):
            for a in range(n_cells[0]):
                here = (c * n_cells[1] + b) * n_cells[0] + a
                for i in range(start[here], start[here + 1]):
                    first[i] = count
                    for row in range(5):
                        ahead, up = (row, 0) if row < 2 else (row - 3, 1)
                        if b + ahead < 0 or b + ahead >= n_cells[1] or c + up >= n_cells[2]:
                            continue
                        line = ((c + up) * n_cells[1] + b + ahead) * n_cells[0]
                        begin = i + 1 if row == 0 else start[line + max(a - 1, 0)]
                        end = start[line + min(a + 1, n_cells[0] - 1) + 1]
                        count = list_near(i, begin, end, place, skin, count, other)
    first[len(place)] = count
    return count


def list_near(i, begin, end, place, skin, count, other):
    """Append those of the spheres from begin to before end that sphere i may touch; returns the new count."""
    x, y, z, reach = place[i, 0], place[i, 1], place[i, 2], place[i, 3] + skin
    for j in range(begin, end):
        dx, dy, dz = x - place[j, 0], y - place[j, 1], z - place[j, 2]
        far = reach + place[j, 3]
        if dx * dx + dy * dy + dz * dz < far * far:
            if count < len(other):
                other[count] = j
            count += 1
    return count


def list_walls(place, plane, skin, sphere, wall):
    """List the spheres nearer than `skin` to a plane, sphere by sphere; returns how many there are."""
    count = 0
    for i in range(len(place)):
        for w in range(len(plane)):
            height = plane[w, 0] * place[i, 0] + plane[w, 1] * place[i, 1] + plane[w, 2] * place[i, 2] - plane[w, 3]
            if height - place[i, 3] < skin:
                if count < len(sphere):
                    sphere[count], wall[count] = i, w
                count += 1
    return count


def carry_memory(old, now_at, new):
    """Hand on the memory of contacts to new lists; now_at[i] is where the sphere stands now that stood at i.

    Seen from the other sphere of a pair the tangential force has the other sign.
    """
    for i in range(len(old.first) - 1):
        for k in range(old.first[i], old.first[i + 1]):
            if old.touches[k]:
                a, b, sign = now_at[i], now_at[old.other[k]], 1.0
                if a > b:
                    a, b, sign = b, a, -1.0
                for m in range(new.first[a], new.first[a + 1]):
                    if new.other[m] == b:
                        new.touches[m] = 1
                        for j in range(MEMORY_WIDTH):
                            new.memory[m, j] = old.memory[k, j] * (sign if j < FORETOLD else 1.0)


def carry_wall_memory(old, now_at, first, new):
    """The same for planes; first[i] is where those of sphere i begin in the new list."""
    for k in range(len(old.sphere)):
        if old.touches[k]:
            i = now_at[old.sphere[k]]
            for m in range(first[i], first[i + 1]):
                if new.wall[m] == old.wall[k]:
                    new.touches[m] = 1
                    for j in range(MEMORY_WIDTH):
                        new.memory[m, j] = old.memory[k, j]
