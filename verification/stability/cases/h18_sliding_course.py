"""H18: A course of bricks slides without friction over the flush head joints of the course below.
Its weight presses each brick below its neighbour by 1e-9 of a length. The lower edges of the bricks
must not catch there: nodes and faces of bodies that share no more than an edge are not in
contact."""
import numpy as np
from _hard import energy_change

NAME = "H18"
TITLE = "course sliding over head joints"
DECK = "h18_sliding_course.toml"
SECONDS = 10


def evaluate(lab):
    changes, energies, rows = [], [], []
    for name, settings in (("stiff bricks", {}), ("soft bricks", {"material.brick.youngs_modulus": 2e8}),
                           ("without edges", {"contact.edges": False}), ("penalty scheme", {"contact.scheme": "penalty"})):
        history = lab.run(name.replace(" ", "_"), settings).history
        momentum = history["momentum_x"]
        changes.append(np.abs(momentum / momentum[0] - 1).max())
        energies.append(np.abs(energy_change(history)).max())
        rows.append([name, changes[-1], energies[-1], history["max_penetration"].max()])
    lab.check(max(changes), 0, 1e-3, "momentum")
    lab.check(max(energies), 0, 5e-3, "energy")
    lab.table("Sliding over a joint:", ["run", "change of momentum", "energy error", "deepest, of a face"], rows)
