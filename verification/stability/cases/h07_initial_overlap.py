"""H7: Two cubes of 4 x 4 x 4 elements overlap at the start: with flat faces, edge in edge, corner
in face. At rest there must never be a force. If they approach, contact resists only the further
approach; the overlap must store no energy. If they separate, there must be no force. Overlaps
beyond the reach of the search must be refused."""
import numpy as np
from _hard import ON_A_CORNER, Block, energy_change, lifted, mesh_of, turned

NAME = "H7"
TITLE = "initial overlap"
DECK = "h07_initial_overlap.toml"
SECONDS = 15
ELEMENT = 0.25


def scenes():
    """{name: (low, high, overlap in elements)}; the search reaches 0.5 elements."""
    beside = (0.13, 0.07, 0)
    edge = turned(("x", 45), ("z", 90))
    crossing = edge @ (0.125, 0, 0) + (0.125, 0, 0)
    return {"faces": (Block("low"), Block("high", beside), 0.3),
            "edges": (Block("low", turn=turned(("x", 45))), Block("high", crossing, edge), 0.3),
            "corner in face": (Block("low"), Block("high", beside, ON_A_CORNER), 0.3)}


def start(lab, name, how, velocity, low, high, overlap, settings=None, expect=0):
    high = lifted(low, high, overlap * ELEMENT)
    return lab.run(f"{name.replace(' ', '_')}_{how}", {"initial.velocity[0].velocity": velocity, **(settings or {})},
                   mesh=mesh_of(low, high), expect=expect)


def evaluate(lab):
    rows, moved, separated, errors = [], [], [], []
    for name, scene in scenes().items():
        rest = start(lab, name, "at_rest", [0, 0, 0], *scene, {"time.steps": 200})
        moved.append(np.abs(rest.results.nodal("displacement")).max() + rest.history["contacts"].max())
        apart = start(lab, name, "apart", [0.004, 0, 0.02], *scene, {"time.steps": 200})
        separated.append(np.abs(energy_change(apart.history)).max() + apart.history["contacts"].max())
        on = start(lab, name, "on", [0.004, 0, -0.02], *scene).history
        energy = energy_change(on)
        errors.append(np.abs(energy).max())
        rows.append([name, scene[2], energy[-1], errors[-1], on["kinetic_energy"].max() / on["kinetic_energy"][0],
                     int(on["contacts"].max()), on["momentum_z"][-1] / on["momentum_z"][0], int(on["lost_contacts"][-1])])
    lab.check(max(moved), 0, 0)
    lab.check(max(separated), 0, 1e-13, "no_force_while_separating")
    lab.check(max(errors), 0, 5e-3, "energy_of_approach")
    lab.check(max(row[4] for row in rows), 1, 1e-2, "kinetic_energy_does_not_grow", error=max(0, max(row[4] for row in rows) - 1))
    lab.check(min(row[5] for row in rows) > 0, 1, 0, "approach_is_resisted")
    lab.table("Approach at 0.02 c from the overlap:", ["scene", "overlap / h", "energy, final", "energy, largest",
                                                    "largest kinetic energy / K_0", "most contacts", "momentum, final / start",
                                                    "contacts lost"], rows)
    low, high, _ = scenes()["faces"]
    deep = start(lab, "faces", "too_deep", [0, 0, -0.02], low, high, 0.8, expect=None)
    check_refusal(lab, deep)


def check_refusal(lab, run):
    """Bodies that overlap by more than the reach of contact must be refused; they would pass
    through each other."""
    lab.check(run.code in (2, 3), 1, 0, "too_deep_is_refused")
    if run.code == 0:
        lab.weak_spot("bodies that overlap at the start by more than the reach of the search pass through each other without an error")
    lab.note(f"Overlap of 0.8 elements, approaching: exit code {run.code}, “{run.message}”; the search reaches 0.5 elements.")
