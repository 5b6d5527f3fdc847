"""Nobody who may touch is missed, nobody is listed twice, and the memory of a contact goes where the spheres go."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rbfem.contact.model import FORETOLD, MEMORY_WIDTH, Pairs, WallPairs
from rbfem.contact.neighbours import (
    carry_memory,
    carry_wall_memory,
    count_in_cells,
    list_pairs,
    list_walls,
    sort_into_cells,
)

# Extents of a domain in largest reaches: a block, a slab, a needle, and one that fits into a cell.
DOMAINS = [(4, 4, 4), (12, 7, 0.01), (0.3, 40, 0.2), (0.5, 0.5, 0.5), (0, 9, 0)]


def sorted_scene(seed, n, domain):
    """Random spheres of radii 1:5 in the order of their cells, the cells, and who stands where."""
    random = np.random.default_rng(seed)
    radius = random.uniform(0.2, 1.0, n)
    skin = 0.1 * radius.min()
    width = 2.0 * radius.max() + skin
    place = np.column_stack([random.uniform(-0.5, 0.5, (n, 3)) * np.array(domain) * width + [3, -5, 70], radius])
    low = place[:, :3].min(axis=0)
    extent = np.maximum(place[:, :3].max(axis=0) - low, skin)
    n_cells = np.maximum(1, np.floor(extent / width)).astype(np.int64)
    cell, order, start = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n_cells.prod() + 1, np.int64)
    count_in_cells(place, low, n_cells / extent, n_cells, cell, start)
    before = start.copy()
    sort_into_cells(cell, start, order)
    np.testing.assert_array_equal(start, before)
    return place[order], order, skin, n_cells, start


def brute_force(place, skin):
    """All pairs nearer than the skin, by looking at each."""
    i, j = np.triu_indices(len(place), 1)
    reach = place[i, 3] + place[j, 3] + skin
    near = ((place[i, :3] - place[j, :3]) ** 2).sum(axis=1) < reach**2
    return set(zip(i[near].tolist(), j[near].tolist(), strict=True))


def listed(first, other):
    rows = np.repeat(np.arange(len(first) - 1), np.diff(first))
    return list(zip(rows.tolist(), other[: first[-1]].tolist(), strict=True))


def pairs_of(place, skin, n_cells, start):
    first, other = np.zeros(len(place) + 1, np.int32), np.empty(len(place) ** 2, np.int32)
    count = list_pairs(place, skin, n_cells, start, first, other)
    return Pairs(first, other[:count], np.zeros(count, np.int8), np.zeros((count, MEMORY_WIDTH)))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 60), st.sampled_from(DOMAINS))
def test_every_pair_within_reach_is_listed_once_at_the_earlier_of_the_two(seed, n, domain):
    place, order, skin, n_cells, start = sorted_scene(seed, n, domain)
    assert sorted(order.tolist()) == list(range(n))
    found = pairs_of(place, skin, n_cells, start)
    pairs = listed(found.first, found.other)
    assert len(set(pairs)) == len(pairs)
    assert set(pairs) == brute_force(place, skin)
    assert all(i < j for i, j in pairs)


def test_the_domains_of_these_tests_have_many_cells_one_row_and_one_cell():
    counts = [sorted_scene(1, 60, domain)[3].tolist() for domain in DOMAINS]
    assert [min(count) for count in counts] == [3, 1, 1, 1, 1]
    assert [max(count) for count in counts] == [3, 11, 39, 1, 8]


def test_a_list_too_short_tells_how_long_it_must_be_and_writes_nothing_beyond():
    place, _, skin, n_cells, start = sorted_scene(5, 60, (2, 2, 2))
    needed = len(brute_force(place, skin))
    assert needed > 20
    first, other = np.zeros(61, np.int32), np.full(20, -1, np.int32)
    assert list_pairs(place, skin, n_cells, start, first, other[:10]) == needed
    assert (other[:10] >= 0).all() and (other[10:] == -1).all()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 40))
def test_every_sphere_near_a_plane_is_listed_and_so_is_one_behind_it(seed, n):
    random = np.random.default_rng(seed)
    place = np.column_stack([random.uniform(-2, 2, (n, 3)), random.uniform(0.1, 0.5, n)])
    normal = random.normal(size=(3, 3))
    plane = np.column_stack([normal / np.linalg.norm(normal, axis=1)[:, None], random.uniform(-1, 1, 3)])
    gap = place[:, :3] @ plane[:, :3].T - plane[:, 3] - place[:, 3:]
    sphere, wall = np.empty((2, 3 * n), np.int32)
    count = list_walls(place, plane, 0.05, sphere, wall)
    assert list(zip(sphere[:count].tolist(), wall[:count].tolist(), strict=True)) == [
        tuple(row) for row in np.argwhere(gap < 0.05).tolist()
    ]
    assert list_walls(place, plane, 0.05, sphere[:0], wall[:0]) == count


def remembered(pairs, order):
    """The memory of each contact by the names of its spheres: force on the one of the lower name, and the rest."""
    found = {}
    for k, (i, j) in enumerate(listed(pairs.first, pairs.other)):
        if pairs.touches[k]:
            a, b = int(order[i]), int(order[j])
            sign = np.where(np.arange(MEMORY_WIDTH) < FORETOLD, 1.0 if a < b else -1.0, 1.0)
            found[min(a, b), max(a, b)] = sign * pairs.memory[k]
    return found


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32), st.integers(2, 40))
def test_the_memory_of_a_contact_survives_a_new_order_with_the_force_on_the_same_sphere(seed, n):
    random = np.random.default_rng(seed)
    place, order, skin, n_cells, start = sorted_scene(seed, n, (2, 2, 1))
    old = pairs_of(place, skin, n_cells, start)
    old.touches[:] = random.random(len(old.touches)) < 0.6
    old.memory[:] = random.normal(size=old.memory.shape)
    shuffle = random.permutation(n)  # a new order, with all spheres in one cell
    new = pairs_of(place[shuffle], skin, np.ones(3, np.int64), np.array([0, n]))
    now_at = np.empty(n, np.int64)
    now_at[shuffle] = np.arange(n)
    carry_memory(old, now_at, new)
    expected, found = remembered(old, order), remembered(new, order[shuffle])
    assert found.keys() == expected.keys()
    for key, memory in expected.items():
        np.testing.assert_array_equal(found[key], memory)
    assert not new.memory[new.touches == 0].any()


def test_the_memory_of_a_contact_with_a_plane_goes_along_with_its_sphere_and_keeps_its_sign():
    planes, material = np.zeros((2, 4)), np.zeros(2, np.int32)
    sphere, wall = np.array([0, 1, 1], np.int32), np.array([1, 0, 1], np.int32)
    memory = np.arange(3.0 * MEMORY_WIDTH).reshape(3, -1)
    old = WallPairs(sphere, wall, np.array([1, 0, 1], np.int8), memory, planes, material)
    listed_now = np.array([0, 0, 1], np.int32), np.array([0, 1, 1], np.int32)
    new = WallPairs(*listed_now, np.zeros(3, np.int8), np.zeros((3, MEMORY_WIDTH)), planes, material)
    carry_wall_memory(old, np.array([1, 0]), np.array([0, 2, 3]), new)  # the two have changed places
    assert new.touches.tolist() == [0, 1, 1]
    np.testing.assert_array_equal(new.memory[1:], memory[[2, 0]])


@pytest.mark.parametrize("n_cells", [(5, 1, 1), (1, 5, 1), (1, 1, 5)])
def test_spheres_on_the_rim_of_a_cell_meet_those_of_the_next(n_cells):
    direction = np.array(n_cells) > 1
    n = 11
    place = np.column_stack([np.outer(np.arange(n) * 1.05, direction), np.full(n, 0.5)])
    extent = np.where(direction, 10.5, 0.1)
    cell, order, start = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(6, np.int64)
    cells = np.array(n_cells, np.int64)
    count_in_cells(place, place[0, :3], cells / extent, cells, cell, start)
    sort_into_cells(cell, start, order)
    found = pairs_of(place[order], 0.06, cells, start)
    assert set(listed(found.first, found.other)) == {(i, i + 1) for i in range(n - 1)}
