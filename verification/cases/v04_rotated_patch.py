"""V4: A rigid rotation of a block of distorted hexahedra by 2.1 rad gives no force and no stress.
After a uniform deformation F and a rotation R, the stress is R sigma(F) R^T and the forces are R
f(F). The linear material is not objective and is left out."""
import numpy as np
from _patch import VARIANTS, cauchy_stress, distorted_block, start_forces, settings_of
from framework.meshes import rotation

NAME = "V4"
TITLE = "rotated patch"
DECK = "v04_rotated_patch.toml"
STRETCH = np.array([[0.05, 0.08, -0.03], [0.02, -0.06, 0.04], [0.01, -0.07, 0.09]])


def evaluate(lab):
    edges = 3
    mesh, force_unit = distorted_block(edges), 1.0 / edges**2  # E h^2
    turn = rotation((1, 2, 3), 2.1)
    rows = []
    for element, model in VARIANTS:
        if model == "linear":
            continue
        runs = {}
        for name, gradient in (("turned", turn - np.eye(3)), ("stretched", STRETCH),
                               ("both", turn @ (np.eye(3) + STRETCH) - np.eye(3))):
            runs[name] = lab.run(f"{element}_{model}_{name}", settings_of(element, model, gradient), mesh=mesh)
        exact = turn @ cauchy_stress(STRETCH, model) @ turn.T
        rows.append([element, model,
                     np.abs(start_forces(runs["turned"])).max() / force_unit,
                     np.abs(runs["turned"].results.stress(0)).max(),
                     np.abs(runs["both"].results.stress(0) - exact).max(),
                     np.abs(start_forces(runs["both"]) - start_forces(runs["stretched"]) @ turn.T).max() / force_unit])
    columns = np.array([row[2:] for row in rows])
    # A few hundred operations on numbers of size E or E h^2, each rounded to 1.1e-16 of them.
    for name, error in zip(("", "stress_of_a_rotation", "stress_rotated", "forces_rotated"), columns.max(axis=0)):
        lab.check(error, 0, 1e-13, name)
    lab.table("Largest forces over E h^2, stresses over E:",
              ["element", "material", "force of a rotation", "stress of a rotation", "R sigma R^T", "R f"], rows)
    draw(lab, distorted_block(edges), turn)


def draw(lab, mesh, turn):
    with lab.figure("The reference mesh and the rotated block, seen along z") as axes:
        for nodes, label in ((mesh.nodes, "reference"), (mesh.nodes @ turn.T, "turned")):
            lines = nodes[mesh.hexes][:, [0, 1, 2, 3, 0, 4, 5, 6, 7, 4]]
            axes.plot(*lines.transpose(1, 0, 2)[..., :2].transpose(2, 0, 1), linewidth=0.6,
                      color="#35124a" if label == "reference" else "#d1603d")
        axes.set(xlabel="x", ylabel="y", aspect="equal")
