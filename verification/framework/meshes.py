"""Meshes of hexahedra: boxes, their images under maps, and unions of several."""
import itertools
import math
from dataclasses import dataclass, field

import numpy as np

from .exodus import HEX_CORNERS, HEX_SIDES

# The indices in HEX_SIDES of the sides of `box` at the least and the largest x, y, z.
BOX_SIDES = {"y0": 0, "x1": 1, "y1": 2, "x0": 3, "z0": 4, "z1": 5}


@dataclass
class Mesh:
    """Hexahedra of several blocks; indices count from 0."""

    nodes: np.ndarray  # [node][xyz]
    hexes: np.ndarray  # [element][corner], ordered by block
    blocks: dict  # {name: number of elements}
    node_sets: dict = field(default_factory=dict)  # {name: nodes}
    side_sets: dict = field(default_factory=dict)  # {name: [[element, side]]}

    def hexes_by_block(self):
        return np.split(self.hexes, np.cumsum(list(self.blocks.values()))[:-1])

    def mapped(self, image):
        """The mesh with its nodes at image(nodes)."""
        return Mesh(image(self.nodes), self.hexes, self.blocks, self.node_sets, self.side_sets)


def quadrature(nodes, hexes, points=2):
    """(positions, volumes) [point][element] of a Gauss rule; 2 points an axis are exact for the
    volume of trilinear hexahedra, 3 for second moments."""
    corner = 2.0 * HEX_CORNERS - 1
    places, weights = np.polynomial.legendre.leggauss(points)
    positions, parts = [], []
    for at in itertools.product(range(points), repeat=3):
        factor = (1 + corner * places[list(at)]) / 2
        gradient = np.stack([corner[:, i] * factor[:, (i + 1) % 3] * factor[:, (i + 2) % 3] / 2 for i in range(3)])
        parts.append(np.linalg.det(np.einsum("ic,ecj->eij", gradient, nodes[hexes])) * weights[list(at)].prod())
        positions.append(factor.prod(axis=1) @ nodes[hexes])
    return np.array(positions), np.array(parts)


def volumes(nodes, hexes):
    return quadrature(nodes, hexes)[1].sum(axis=0)


def monomials(x):
    """1, x, y, z and xx, yy, zz, yz, zx, xy [point][monomial]."""
    pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)]
    return np.column_stack([np.ones(len(x)), x, *(x[:, i] * x[:, j] for i, j in pairs)])


def lumped_masses(nodes, hexes, density=1.0):
    """An eighth of each element's mass at each of its corners. `density` is one number or one per
    element."""
    masses = np.zeros(len(nodes))
    np.add.at(masses, hexes, (density * volumes(nodes, hexes) / 8)[:, None])
    return masses


def nodal_masses(nodes, hexes, density=1.0):
    """The masses of `element.mass = "inertia"`, the default: those with the mass, centre and second
    moments of each body, two elements or more through the thickness
    (mechanics/theory.md, equation (37); in directions of one element the excess stays)."""
    masses = lumped_masses(nodes, hexes, density)
    positions, weights = quadrature(nodes, hexes, 3)
    for body in bodies(len(nodes), hexes):
        elements = np.isin(hexes[:, 0], body)
        exact = (weights * density)[:, elements].reshape(-1), positions[:, elements].reshape(-1, 3)
        total, centre = exact[0].sum(), exact[0] @ exact[1] / exact[0].sum()
        second = np.einsum("n,ni,nj", exact[0], exact[1] - centre, exact[1] - centre) / total
        frame = np.linalg.inv(np.linalg.cholesky(second)).T
        share, y = masses[body] / total, (nodes[body] - centre) @ frame
        q = monomials(y) * np.sqrt([1, 1, 1, 1, 1, 1, 1, 2, 2, 2])
        residual = [1, 0, 0, 0, 1, 1, 1, 0, 0, 0] - share @ q
        gram = (q * share[:, None] ** 2).T @ q
        linear = np.linalg.solve(gram[:4, :4], np.column_stack([residual[:4], gram[:4, 4:]]))
        needed, schur = residual[4:] - gram[4:, :4] @ linear[:, 0], gram[4:, 4:] - gram[4:, :4] @ linear[:, 1:]
        variance, modes = np.linalg.eigh(schur)
        coefficient = modes.T @ needed
        kept = (variance > 1e-3 * gram[0, 0]) & (coefficient ** 2 * gram[0, 0] <= variance)
        quadratic = modes[:, kept] @ (coefficient[kept] / variance[kept])
        masses[body] *= 1 + share * (q[:, :4] @ (linear[:, 0] - linear[:, 1:] @ quadratic) + q[:, 4:] @ quadratic)
    return masses


def bodies(num_nodes, hexes):
    """The nodes of each connected part of a mesh; the parts are in the order of their lowest
    nodes."""
    label, before = np.arange(num_nodes), None
    while not np.array_equal(label, before):
        before = label.copy()
        np.minimum.at(label, hexes, label[hexes].min(axis=1, keepdims=True))
    return [np.flatnonzero(label == first) for first in np.unique(label[np.unique(hexes)])]


def box(size, elements, origin=(0, 0, 0), name="block", sets=None):
    """A block of equal elements in the element block `name`. Its node sets and side sets are
    `sets`.x0, .x1, .y0, .y1, .z0 and .z1; `sets` is the name by default."""
    return graded_box([np.linspace(o, o + s, n + 1) for o, s, n in zip(origin, size, elements)], name, sets)


def graded_box(coordinates, name="block", sets=None):
    """A block with nodes at all triples of three ascending lists of coordinates."""
    nx, ny, nz = (len(values) for values in coordinates)
    z, y, x = np.meshgrid(*coordinates[::-1], indexing="ij")
    nodes = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    number = np.arange(nx * ny * nz).reshape(nz, ny, nx)
    hexes = np.stack([number[k:nz - 1 + k, j:ny - 1 + j, i:nx - 1 + i].reshape(-1) for i, j, k in HEX_CORNERS], axis=1)
    mesh = Mesh(nodes, hexes, {name: len(hexes)})
    ends = {f"{axis}{end}": np.flatnonzero(np.isclose(nodes[:, i], values[-end], rtol=0, atol=1e-12 * np.ptp(values)))
            for i, (axis, values) in enumerate(zip("xyz", coordinates)) for end in (0, 1)}
    for end, members in ends.items():
        mesh.node_sets[f"{sets or name}.{end}"] = members
        side = BOX_SIDES[end]
        elements = np.flatnonzero(np.isin(hexes[:, HEX_SIDES[side]], members).all(axis=1))
        mesh.side_sets[f"{sets or name}.{end}"] = np.stack([elements, np.full(len(elements), side)], axis=1)
    return mesh


def together(*meshes):
    """One mesh of several that share no node. Blocks of the same name must be adjacent; sets must
    have different names."""
    union = Mesh(np.concatenate([mesh.nodes for mesh in meshes]), np.empty((0, 8), dtype=np.int64), {})
    first_node = 0
    for mesh in meshes:
        first_elem = len(union.hexes)
        union.hexes = np.concatenate([union.hexes, mesh.hexes + first_node])
        for name, count in mesh.blocks.items():
            union.blocks[name] = union.blocks.get(name, 0) + count
        for name, nodes in mesh.node_sets.items():
            union.node_sets[name] = nodes + first_node
        for name, sides in mesh.side_sets.items():
            union.side_sets[name] = sides + [first_elem, 0]
        first_node += len(mesh.nodes)
    return union


def rotation(axis, angle):
    """The matrix of a rotation by `angle` about `axis` (Rodrigues); the same bits on any processor, unlike with sines of NumPy."""
    n = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
