"""V5: The patch test: a block of distorted hexahedra under a uniform deformation gradient. Every
element has the stress of the closed form; interior nodes have no force."""
import numpy as np
from _patch import VARIANTS, cauchy_stress, distorted_block, start_forces, settings_of
from framework.exodus import HEX_SIDES

NAME = "V5"
TITLE = "patch test"
DECK = "v05_patch.toml"


def interior_nodes(mesh):
    """Nodes that lie on no outer side, a side of one hexahedron only."""
    sides = np.sort(mesh.hexes[:, HEX_SIDES].reshape(-1, 4), axis=1)
    kinds, count = np.unique(sides, axis=0, return_counts=True)
    return np.setdiff1d(np.arange(len(mesh.nodes)), kinds[count == 1])


def evaluate(lab):
    edges = 4
    mesh, force_unit = distorted_block(edges), 1.0 / edges**2  # E h^2
    inside = interior_nodes(mesh)
    gradient = lab.deck["initial"]["deformation"][0]["gradient"]
    rows = []
    for element, model in VARIANTS:
        run = lab.run(f"{element}_{model}", settings_of(element, model, gradient), mesh=mesh)
        forces = np.abs(start_forces(run)) / force_unit
        stress = np.abs(run.results.stress(0) - cauchy_stress(gradient, model)).max()
        rows.append([element, model, forces[inside].max(), stress, forces.max()])
    lab.check(max(row[2] for row in rows), 0, 1e-13)
    lab.check(max(row[3] for row in rows), 0, 1e-13, "stress")
    lab.require(min(row[4] for row in rows) > 1e-2, "outer_nodes_have_forces")
    lab.table("Largest forces over E h^2, stresses over E:",
              ["element", "material", "force inside", "error of the stress", "force on the outer nodes"], rows)
    with lab.figure("Force on each node of the last variant over E h^2, by distance from the centre of the block") as axes:
        distance = np.linalg.norm(mesh.nodes - 0.5, axis=1)
        axes.semilogy(distance, np.maximum(np.linalg.norm(forces, axis=1), 1e-18), ".", label="outer nodes")
        axes.semilogy(distance[inside], np.maximum(np.linalg.norm(forces[inside], axis=1), 1e-18), "o", label="nodes inside")
        axes.set(xlabel="distance", ylabel="force / (E h^2)")
