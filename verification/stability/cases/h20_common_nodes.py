"""H20: A block falls flush on four bricks, or on three or six wedges around a point. Up to dozens of
contacts that share nodes begin, and end, in the same step; each first and last force is corrected
for its energy, and the corrections must not overshoot together. Coarse meshes are the hardest: all
nodes are common. The second table has the stiffest contact that the step allows."""
import math

import numpy as np
from _hard import energy_change
from framework.meshes import box, together

NAME = "H20"
TITLE = "contacts in common nodes"
DECK = "h20_common_nodes.toml"
SECONDS = 20
# Supports, elements along their edges, elements and width of the block, closing speed, nu
SCENES = {
    "four bricks, 1": ("four", 1, (3, 2, 3), 1.0, 0.03, 0.2),
    "four bricks, 2": ("four", 1, (4, 3, 1), 2.0, 0.03, 0.3),
    "four bricks, 3": ("four", 2, (3, 1, 2), 1.0, 0.002, 0.2),
    "four bricks, 4": ("four", 2, (3, 3, 1), 2.0, 0.002, 0.0),
    "four bricks, 5": ("four", 4, (8, 8, 4), 2.0, 0.01, 0.0),
    "three wedges, 1": ("wedges", 3, 1, (2, 2, 2), 1.2, 0.01, 0.0),
    "three wedges, 2": ("wedges", 3, 1, (3, 3, 3), 0.9, 0.002, 0.2),
    "three wedges, 3": ("wedges", 3, 4, (5, 5, 5), 1.2, 0.01, 0.0),
    "six wedges, 1": ("wedges", 6, 1, (3, 3, 3), 0.9, 0.002, 0.0),
    "six wedges, 2": ("wedges", 6, 1, (2, 2, 2), 1.2, 0.03, 0.2),
    "six wedges, 3": ("wedges", 6, 2, (1, 1, 1), 1.2, 0.01, 0.0),
    "six wedges, 4": ("wedges", 6, 4, (5, 5, 5), 1.2, 0.01, 0.0),
}


def four_bricks(elements):
    return together(*(box((1, 1, 1), (elements,) * 3, (x, y, -1), "low") for x in (-1, 0) for y in (-1, 0)))


def wedges(count, elements):
    """Prisms on kites whose common corner is at the origin."""
    angle = 2 * np.pi / count

    def wedge(number):
        def image(x):
            s, t = x[:, :1], x[:, 1:2]
            sides = [np.array([math.cos(side), math.sin(side)]) for side in (0, angle / 2, angle)]
            kite = s * (1 - t) * sides[0] + 1.15 * max(1, 1 / (1.15 * math.cos(angle / 2))) * s * t * sides[1] + (1 - s) * t * sides[2]
            turn = angle * number + 0.1
            c, r = math.cos(turn), math.sin(turn)
            return np.column_stack([c * kite[:, 0] - r * kite[:, 1], r * kite[:, 0] + c * kite[:, 1], x[:, 2]])
        return box((1, 1, 1), (elements,) * 3, (0, 0, -1), "low").mapped(image)
    return together(*(wedge(number) for number in range(count)))


def scene(kind, *rest):
    """(mesh, speed, nu); the block starts a third of a step's way or so above the supports."""
    *support, block, width, speed, poisson = rest
    low = four_bricks(*support) if kind == "four" else wedges(*support)
    high = box((width, width, 1), block, (-width / 2, -width / 2, 0.3 * speed), "high")
    return together(low, high), speed, poisson


def evaluate(lab):
    for penalty in (0.9,) if lab.quick else (0.9, 1.5):
        rows = []
        for name, definition in list(SCENES.items())[:: 4 if lab.quick else 1]:
            mesh, speed, poisson = scene(*definition)
            settings = {"initial.velocity[0].velocity": (0, 0, -speed), "material.low.poissons_ratio": poisson,
                        "material.high.poissons_ratio": poisson, "contact.penalty": penalty}
            history = lab.run(f"{name.replace(', ', '_').replace(' ', '_')}_{penalty}", settings, mesh=mesh).history
            energy = energy_change(history)
            rows.append([name, energy[-1], np.abs(energy).max(), int(history["contacts"].max()), history["max_penetration"].max(),
                         int(history["lost_contacts"][-1])])
        # The threshold of impacts at any time (V17); a penalty of 1.5 leaves 4 % of the nodes' masses to
        # the step, and is looked at with a little reserve.
        lab.check(max(row[2] for row in rows), 0, *((5e-3,) if penalty == 0.9 else (6e-3, "stiff_contact")))
        lab.check(max(row[5] for row in rows), 0, 0, f"contacts_lost_{penalty}")
        lab.table(f"By scene, penalty {penalty}:", ["scene", "energy, final", "energy, largest", "most contacts", "deepest / face",
                                                    "contacts lost"], rows)
