"""H13: A light block between heavy ones of a thousand times its mass: it is smaller (elements a
tenth as long, or a single element on the middle of a face) or less dense. When a heavy block hits
it, it must leave at no more than 2 V, apart from its vibration. When two heavy blocks squeeze it
until they come to rest, a friction of 0.3 must hold it. (Without friction it may leave sideways:
the dent in faces of coarse elements has a slope of half a percent, enough for a thousandth of the
mass.)"""
import numpy as np
from _hard import energy_change
from framework.meshes import box, nodal_masses, together

NAME = "H13"
TITLE = "mass ratio of 1000"
DECK = "h13_mass_ratio.toml"
SECONDS = 30
HIT, SQUEEZE = 0.01, 0.002


def scene(kind):
    """(mesh, settings, density of the light block). Heavy cubes of 4^3 elements, a gap of 0.001 on
    either side."""
    edge, elements, settings = {"a tenth of the size": (0.1, (4, 4, 4), {}),
                                "a tenth of the size, one element": (0.1, (1, 1, 1), {}),
                                "a thousandth of the density": (1.0, (4, 4, 4), {"material.light.density": 1e-3})}[kind]
    beside = 0.5 - edge / 2 + 0.03  # not on the nodes of the heavy blocks
    light = box((edge,) * 3, elements, (beside, beside, 1.001), "light")
    mesh = together(box((1, 1, 1), (4, 4, 4), name="low"), light, box((1, 1, 1), (4, 4, 4), (0, 0, 1.002 + edge), "high"))
    return mesh, settings, settings.get("material.light.density", 1.0)


def light_speeds(run, density):
    """Velocities of the centre of mass of the light block [step][xyz]."""
    results = run.results
    nodes = results.nodes_of_block(1)
    masses = nodal_masses(results.nodes, results.hexes_of_block[1], density)[nodes]
    return np.array([masses @ results.nodal("velocity", step)[nodes] for step in range(len(results.times))]) / masses.sum()


def evaluate(lab):
    rows = []
    for kind in ("a tenth of the size", "a tenth of the size, one element", "a thousandth of the density"):
        for what, speed, low_speed, friction in (("hit", HIT, -0.1, 0.0), ("squeezed", SQUEEZE, SQUEEZE, 0.3),
                                                 ("squeezed, no friction", SQUEEZE, SQUEEZE, 0.0)):
            mesh, settings, density = scene(kind)
            # "hit": the lower heavy block moves away.
            settings = {**settings, "initial.velocity[0].velocity": [0, 0, -speed],
                        "initial.velocity[1].velocity": [0, 0, low_speed], "output.interval": 0.001 / speed, "contact.friction": friction}
            run = lab.run(f"{kind}_{what}".replace(" ", "_").replace(",", ""), settings, mesh=mesh)
            speeds = light_speeds(run, density)
            energy = energy_change(run.history)
            rows.append([kind, what, np.linalg.norm(speeds, axis=1).max() / speed, np.abs(speeds[:, :2]).max() / speed,
                         energy[-1], np.abs(energy).max(), run.history["max_penetration"].max(),
                         int(run.history["contacts"].max()), int(run.history["lost_contacts"][-1])])
    hit, squeezed = ([row for row in rows if row[1] == what] for what in ("hit", "squeezed"))
    lab.check(max(row[2] for row in hit), 2, 0.1, "", error=max(0, max(row[2] for row in hit) / 2 - 1))
    lab.check(min(row[2] for row in hit), 1, 0, "light_block_is_hit", error=max(0, 1 - min(row[2] for row in hit)))
    # Between two faces that approach at V each it moves to and fro until the gap is closed.
    lab.check(max(row[2] for row in squeezed), 4, 0, "not_ejected", error=max(0, max(row[2] for row in squeezed) / 4 - 1))
    lab.check(max(row[3] for row in squeezed), 0, 0.5, "held_by_friction")
    lab.check(max(row[5] for row in rows), 0, 5e-3, "energy")
    lab.check(max(row[8] for row in rows), 0, 0, "contacts_lost")
    worst = max(rows, key=lambda row: row[5])
    if worst[5] > 5e-3:
        lab.weak_spot(f"{worst[0]}, {worst[1]}: an energy error of {worst[5]:.2g}: the light block leaves sideways at {worst[3]:.0f} V, and its "
                      "loaded nodes cross the zone beyond an edge, where their force fades out, in a few steps")
    lab.table("The light block:", ["lighter by", "", "largest speed / V", "sideways / V", "energy, final", "energy, largest",
                                   "deepest / face", "most contacts", "contacts lost"], rows)
