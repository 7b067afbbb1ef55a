"""V21: The angular momentum of a body that spins at w is J w, with the inertia tensor J of the solid
body. Nodal masses have the body's mass, centre and inertia tensor exactly where three elements or
more lie between opposite faces, on distorted and turned meshes too, and on regular ones of two. With
one element J is too large whatever the masses are: all nodes are on the surface. Row sums
(`element.mass = "row_sum"`) give second moments that are 1 + 2/n^2 times those of a brick of n
elements, so a given angular momentum spins it too slowly. Edges of elements and the density are 1; checks of row sums give
the moment of inertia about the long axis in these units, the others the largest error of the tensor over its largest entry."""
import numpy as np
from framework.meshes import box, quadrature, rotation

NAME = "V21"
TITLE = "inertia of a free body"
DECK = "v21_inertia.toml"
BRICKS = [(2, 1, 1), (4, 2, 2), (6, 3, 3), (8, 4, 4), (16, 8, 8)]


def brick(elements):
    return box(elements, elements, [-n / 2 for n in elements])


def distorted(elements, size=0.2):
    mesh = brick(elements)
    turn, shear = rotation((1, 2, 3), 1.0), np.array([[1, 0.4, 0.2], [0, 1, 0.3], [0, 0, 0.8]])
    noise = size * np.random.default_rng(1).uniform(-1, 1, mesh.nodes.shape)
    return mesh.mapped(lambda nodes: (nodes + noise) @ (turn @ shear).T)


def inertia(mesh):
    """The inertia tensor of the trilinear body about the origin."""
    positions, volumes = quadrature(mesh.nodes, mesh.hexes, 3)
    second = np.einsum("pe,pei,pej", volumes, positions, positions)
    return np.trace(second) * np.eye(3) - second


def spun(lab, label, mesh, mass):
    """The inertia tensor by the angular momenta at unit spin about each axis, which is turned to
    z."""
    columns, spin = [], lab.deck["initial"]["velocity"][0]["angular_velocity"][2]
    for axis in range(3):
        turned = mesh.mapped(lambda nodes: np.roll(nodes, 2 - axis, axis=1))
        momentum = lab.run(f"{label}_{mass}_{'xyz'[axis]}", {"element.mass": mass}, mesh=turned).vector("angular_momentum")[0]
        columns.append(np.roll(momentum, axis - 2) / spin)
    return np.array(columns).T


def evaluate(lab):
    rows = []
    for elements in BRICKS[:4] if lab.quick else BRICKS:
        n = elements[2]
        mesh, label = brick(elements), "x".join(map(str, elements))
        exact = inertia(mesh)
        ours, row_sum = (spun(lab, label, mesh, mass) for mass in ("inertia", "row_sum"))
        if n > 1:
            lab.check(np.abs(ours - exact).max() / exact.max(), 0, 1e-12, label if rows[1:] else "")
            lab.check(row_sum[0, 0], exact[0, 0] * (1 + 2 / n**2), 1e-12, f"{label}_row_sum")
        rows.append([label, exact[0, 0] / row_sum[0, 0] - 1, exact[0, 0] / ours[0, 0] - 1])
    for elements in [(3, 3, 3), (5, 4, 3)]:
        mesh, label = distorted(elements), "distorted_" + "x".join(map(str, elements))
        exact, found = inertia(mesh), spun(lab, label, mesh, "inertia")
        lab.check(np.abs(found - exact).max() / np.abs(exact).max(), 0, 1e-12, label)
    lab.table("Error of the spin about the long axis of a brick at a given angular momentum:",
              ["elements", "row_sum", "inertia"], rows)
