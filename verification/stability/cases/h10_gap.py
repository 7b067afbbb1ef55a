"""H10: Two cubes of 4 x 4 x 4 elements with a gap of 0.001 to 0.09 elements, less than the reach of
the search (0.1): candidates, but not in contact. At rest and while they separate there must be no
force: neither prestress nor adhesion. While the gap closes at 0.005 c, there must be no force in
any step before it is closed, and a force in the step in which it closes. The scenes are face to
face and edge to edge."""
import numpy as np
from _hard import Block, energy_change, lifted, mesh_of, turned

NAME = "H10"
TITLE = "gap below the tolerance"
DECK = "h10_gap.toml"
SECONDS = 15
ELEMENT, SPEED = 0.25, 0.005


def pairs():
    edge = turned(("x", 45), ("z", 90))
    return {"faces": (Block("low"), Block("high", (0.13, 0.07, 0))),
            "edges": (Block("low", turn=turned(("x", 45))), Block("high", edge @ (0.125, 0, 0) + (0.125, 0, 0), edge))}


def evaluate(lab):
    untouched, late, energies, rows = [], [], [], []
    for name, (low, high) in pairs().items():
        for gap in (1e-3, 0.09) if lab.quick else (1e-3, 1e-2, 0.05, 0.09):
            mesh = mesh_of(low, lifted(low, high, -gap * ELEMENT))
            for how, velocity in (("rest", [0, 0, 0]), ("apart", [SPEED, 0, SPEED]), ("along", [SPEED, 0, 0])):
                run = lab.run(f"{name}_{gap}_{how}", {"initial.velocity[0].velocity": velocity, "time.steps": 100}, mesh=mesh)
                impulse = np.abs(run.vector("momentum") - velocity).max()
                untouched.append(run.history["contacts"].max() + run.history["internal_energy"].max() + impulse)
            history = lab.run(f"{name}_{gap}_closing", {"initial.velocity[0].velocity": [0, 0, -SPEED]}, mesh=mesh).history
            pressed = np.flatnonzero(history["contacts"] > 0)
            first = pressed[0] if len(pressed) else -1
            closed = np.flatnonzero(SPEED * history["time"] > gap * ELEMENT)[0]
            late.append(first - closed)
            energies.append(np.abs(energy_change(history)).max())
            rows.append([name, gap, int(closed), int(first), history["kinetic_energy"][:max(first, 1)].min()
                         / history["kinetic_energy"][0], energies[-1]])
    # The rounding of momenta and velocities of a free flight.
    lab.check(max(untouched), 0, 1e-14)
    lab.check(np.abs(late).max(), 0, 0, "steps_from_closing_to_force")
    lab.check(max(energies), 0, 5e-3, "energy_of_closing")
    lab.table("Closing the gap:", ["pair", "gap / h", "closed in step", "first force in step", "least K/K_0 before", "energy error"],
              rows)
