"""What is drawn of a results file: geometry, field and arrows of each step."""
import numpy as np

from .errors import PlotError
from .surface import Surface, signed_distance

DISPLACEMENTS = ("displacement", "displ", "disp")
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx", "1", "2", "3")  # of element fields


class Scene:
    """A file with the chosen field and vectors. `field` None is the displacement, if there is one; `arrows` is the name
    of a vector or None; `plane` (point, normal) cuts."""

    def __init__(self, results, field=None, scale=1.0, plane=None, arrows=None):
        self.results, self.scale = results, scale
        self.displacement = next(filter(results.is_vector, DISPLACEMENTS), None) if len(results.times) else None
        self.field, self.arrows = field or self.displacement, arrows
        vectors = sorted({name[:-2] for name in results.names["nod"] if results.is_vector(name[:-2])})
        scalars = [name for name in results.names["nod"] if name[:-2] not in vectors] + results.names["elem"]
        if not len(results.times) and (field or arrows):
            raise PlotError(f"{results.paths[0]}: the file has a mesh and no steps, thus no fields")
        if self.field and self.field not in [*vectors, *results.names["nod"], *results.names["elem"]]:
            parts = [f"{self.field}_{part}" for part in COMPONENTS if f"{self.field}_{part}" in scalars]
            raise PlotError(f"{results.paths[0]}: " + (
                f"{self.field} has the components {', '.join(parts)}; choose one" if parts else
                f"there is no field {self.field}; there are {', '.join(vectors + scalars)} and the components of the vectors"))
        if arrows and arrows not in vectors:
            raise PlotError(f"{results.paths[0]}: there is no nodal vector {arrows}; there are {', '.join(vectors) or 'none'}")
        if plane is not None:
            check_cut(results.nodes, plane)
        self.surface = Surface(results.hexes, results.nodes, plane)

    def points(self, step):
        """The vertices of the surface [vertex][xyz]."""
        return self.surface.evaluate(self._nodes(step))

    def values(self, step):
        """The field at the vertices [vertex] or triangles [triangle]; the magnitude of a vector. None without one."""
        if self.field is None:
            return None
        if self.field in self.results.names["elem"]:
            return self.results.element(self.field, step)[self.surface.element]
        values = self.results.nodal(self.field, step)
        return self.surface.evaluate(np.linalg.norm(values, axis=1) if values.ndim == 2 else values)

    def label(self):
        """The name of the field in words."""
        return self.field.replace("_", " ") + (" magnitude" if self.results.is_vector(self.field) else "")

    def vectors(self, step):
        """(points, vectors) [arrow][xyz]. Forces are summed over each side of a body: the force of a node belongs to that
        of its sides on which it presses most. Other vectors stand at the nodes of the skin."""
        nodes, values = self._nodes(step), self.results.nodal(self.arrows, step)
        skin = np.unique(self.surface.faces)
        skin = skin[values[skin].any(axis=1)]
        if self.surface.plane is not None:
            skin = skin[signed_distance(self.results.nodes[skin], self.surface.plane) < 0]
        if not self.arrows.startswith("force"):
            return nodes[skin], values[skin]
        chosen = np.zeros(len(nodes), dtype=bool)
        chosen[skin] = True
        faces = np.flatnonzero(chosen[self.surface.faces].any(axis=1))
        if not len(faces):
            return np.zeros((0, 3)), np.zeros((0, 3))
        corner = nodes[self.surface.faces[faces]]
        normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        node, side = self.surface.faces[faces].ravel(), np.repeat(self.surface.face_sides[faces], 4)
        pressed = (values[node] * np.repeat(normal, 4, axis=0)).sum(axis=1)
        order = np.lexsort((side, pressed, node))
        order = order[np.concatenate([[True], np.diff(node[order]) > 0])]
        order = order[chosen[node[order]]]
        node, (side, index) = node[order], np.unique(side[order], return_inverse=True)
        weight = np.linalg.norm(values[node], axis=1)

        def total(value):
            return np.stack([np.bincount(index, value[:, i], len(side)) for i in range(3)], axis=1)

        return total(nodes[node] * weight[:, None]) / np.bincount(index, weight)[:, None], total(values[node])

    def _nodes(self, step):
        if self.displacement is None:
            return self.results.nodes
        return self.results.nodes + self.scale * self.results.nodal(self.displacement, step)


def check_cut(nodes, plane):
    """Raises PlotError for a plane (point, normal) that misses all bodies."""
    depth = signed_distance(nodes, plane)
    if depth.min() >= 0 or depth.max() <= 0:
        low, high = (",".join(f"{value:g}" for value in corner) for corner in (nodes.min(axis=0), nodes.max(axis=0)))
        raise PlotError(f"the cut removes {'everything' if depth.min() >= 0 else 'nothing'}; undeformed, the bodies reach from {low} to {high}")
