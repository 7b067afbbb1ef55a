"""The triangles that are drawn: the skin of the bodies, or what a plane leaves of it and the section itself.

Each quadrilateral is four triangles around its centre. The plane cuts the undeformed bodies, so that a section moves
with the material. Vertices are the nodes of the skin and of cut elements, centres of faces and elements, and points on
edges between those; `evaluate` takes any nodal field to them.
"""
import numpy as np

from .exodus import HEX_SIDES
from .skin import connected, exterior_faces, normals, sides_of_bodies


class Surface:
    """Triangles [triangle][vertex], and for each of them its `face` (faces of the skin first, then elements of the
    section), `element` and `side` (see skin.sides_of_bodies; the section of a body is a side too)."""

    def __init__(self, hexes, nodes, plane=None):
        """`plane` is (point, unit normal): material beyond it, where the normal points, is removed. Planes of the mesh
        belong to the removed half by a hair, so that a cut along a joint shows the bodies that stay."""
        if plane is not None:
            point, normal = plane
            plane = point - 1e-9 * np.linalg.norm(np.ptp(nodes, axis=0)) * normal, normal
        self.plane = plane
        faces, owners = exterior_faces(hexes, len(nodes))
        self.faces, self.face_sides = faces, sides_of_bodies(faces, normals(nodes, faces), len(nodes))
        cut = np.zeros(0, dtype=np.int64)
        if plane is not None:
            depth = signed_distance(nodes, plane)
            kept = (depth[faces] < 0).any(axis=1)
            faces, owners, side = faces[kept], owners[kept], self.face_sides[kept]
            cut = np.flatnonzero((depth[hexes] < 0).any(axis=1) & (depth[hexes] >= 0).any(axis=1))
        else:
            side = self.face_sides
        self._used = np.union1d(faces, hexes[cut])
        self._quads = np.concatenate([faces, hexes[cut][:, HEX_SIDES].reshape(-1, 4)])
        self._quads = np.searchsorted(self._used, self._quads)
        self._hexes = np.searchsorted(self._used, hexes[cut])
        self._edges = None
        centre = len(self._used) + np.arange(len(self._quads))
        around = np.stack([self._quads, np.roll(self._quads, -1, axis=1), np.repeat(centre[:, None], 4, axis=1)], axis=2)
        self.triangles = around[:len(faces)].reshape(-1, 3)
        self.face = np.repeat(np.arange(len(faces)), 4)
        if plane is not None:
            middle = len(self._used) + len(self._quads) + np.repeat(np.arange(len(cut)), 24)
            tetrahedra = np.column_stack([around[len(faces):].reshape(-1, 3), middle])
            self._cut(signed_distance(self.evaluate(nodes), plane), tetrahedra, len(faces), plane, nodes)
        self.element = np.concatenate([owners, cut])[self.face]
        section = connected(len(self._used), np.repeat(self._hexes[:, 0], 7), self._hexes[:, 1:].ravel())[self._hexes[:, 0]]
        self.side = np.concatenate([side, len(self.faces) + section])[self.face]

    def evaluate(self, values):
        """Values at the vertices, from values [node] or [node][component]."""
        values = np.asarray(values)[self._used]
        values = np.concatenate([values, values[self._quads].mean(axis=1), values[self._hexes].mean(axis=1)])
        if self._edges is None:
            return values
        start, end, part = self._edges
        part = part.reshape((-1,) + (1,) * (values.ndim - 1))
        return np.concatenate([values, values[start] * (1 - part) + values[end] * part])

    def _cut(self, depth, tetrahedra, num_faces, plane, nodes):
        edges, num_vertices = [], len(depth)

        def crossing(inside, outside):
            """The vertex where an edge from a kept to a removed vertex meets the plane."""
            part = depth[inside] / (depth[inside] - depth[outside])
            first = num_vertices + sum(len(p) for _, _, p in edges)
            edges.append((inside, outside, part))
            return first + np.arange(len(inside))

        # Triangles of the skin: whole, or with one or two kept corners. The first corner is the odd one.
        kept = depth[self.triangles] < 0
        number = kept.sum(axis=1)
        triangles, face = [self.triangles[number == 3]], [self.face[number == 3]]
        for count in (1, 2):
            chosen = np.flatnonzero(number == count)
            odd = np.argmax(kept[chosen] == (count == 1), axis=1)
            a, b, c = (self.triangles[chosen, (odd + i) % 3] for i in range(3))
            if count == 1:
                triangles.append(np.stack([a, crossing(a, b), crossing(a, c)], axis=1))
                face.append(self.face[chosen])
            else:
                ab, ac = crossing(b, a), crossing(c, a)
                triangles += [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
                face += [self.face[chosen]] * 2
        # Section of the tetrahedra: a triangle if one corner is alone, or a quadrilateral.
        kept = depth[tetrahedra] < 0
        number = kept.sum(axis=1)
        first, element = sum(map(len, triangles)), num_faces + np.arange(len(tetrahedra)) // 24
        for count in (1, 2, 3):
            chosen = np.flatnonzero(number == count)
            order = np.argsort(~kept[chosen], axis=1, kind="stable")  # kept corners first
            a, b, c, d = np.take_along_axis(tetrahedra[chosen], order, axis=1).T
            pairs = {1: ((a, b), (a, c), (a, d)), 2: ((a, c), (a, d), (b, d), (b, c)), 3: ((a, d), (b, d), (c, d))}[count]
            corners = [crossing(*pair) for pair in pairs]
            for i in range(1, len(corners) - 1):
                triangles.append(np.stack([corners[0], corners[i], corners[i + 1]], axis=1))
                face.append(element[chosen])
        self.triangles, self.face = np.concatenate(triangles), np.concatenate(face)
        self._edges = [np.concatenate(part) for part in zip(*edges)]
        # A section faces the removed half.
        section = self.triangles[first:]
        corner = self.evaluate(nodes)[section]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        wrong = normal @ plane[1] < 0
        section[wrong] = section[wrong][:, [0, 2, 1]]


def signed_distance(points, plane):
    """Distance of points from a plane (point, unit normal)."""
    point, normal = plane
    return (points - point) @ normal
