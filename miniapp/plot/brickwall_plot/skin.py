"""The skin of a mesh of hexahedra: exterior faces and the sides of bodies, from the connectivity alone."""
import numpy as np

from .exodus import HEX_SIDES

SHARP = np.cos(np.radians(40))  # faces that meet at a larger angle belong to different sides of a body


def exterior_faces(hexes, count):
    """Faces of exactly one hexahedron: (face [face][corner], hexahedron of each), in the order of hexahedra.
    `count` is the number of nodes."""
    faces = hexes[:, HEX_SIDES].reshape(-1, 4)
    corners = np.sort(faces, axis=1)
    low, high = (corners[:, i] * count + corners[:, i + 1] for i in (0, 2))
    order = np.lexsort((high, low))
    low, high = low[order], high[order]
    equal = np.concatenate([[False], (low[1:] == low[:-1]) & (high[1:] == high[:-1]), [False]])
    alone = np.sort(order[~equal[1:] & ~equal[:-1]])
    return faces[alone], alone // 6


def normals(points, faces):
    """Unit normals [face][xyz]; zero for faces without area."""
    corner = points[faces]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def sides_of_bodies(faces, normal, count):
    """The side of each face: connected faces that bend by less than 40 degrees from one to the next have the same
    number."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    face = np.arange(len(ends)) // 4
    key = ends[:, 0] * count + ends[:, 1]
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    one, other = face[order[pair]], face[order[pair + 1]]
    smooth = (normal[one] * normal[other]).sum(axis=1) >= SHARP
    return connected(len(faces), one[smooth], other[smooth])


def connected(count, one, other):
    """The least index that each of `count` items is connected to by pairs (one, other)."""
    label = np.arange(count)
    while True:
        before = label.copy()
        low = np.minimum(label[one], label[other])
        for items in (before[one], before[other]):  # hooks the roots of both to the lower one
            lower_at(label, items, low)
        while not np.array_equal(label, label[label]):
            label = label[label]
        if np.array_equal(label, before):
            return label


def lower_at(target, index, values):
    """target[index] = min(target[index], values) also where indices repeat; much faster than np.minimum.at."""
    lower = values < target[index]
    while lower.any():
        index, values = index[lower], values[lower]
        target[index] = values  # one of those that repeat; the loop goes on with those below it
        lower = values < target[index]
