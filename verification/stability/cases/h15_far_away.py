"""H15: Positions with the resolution of floats. The program computes in doubles only. The effect of
floats on contact shows far from the origin: at 2^29 edge lengths, doubles have the spacing of
floats near it (2^-23 for positions about 1). All coordinates are multiples of 2^-10, so the bodies
are equal bit by bit. Elements depend on displacements only: a free vibrating block must not differ
by a bit. Contact depends on positions X + u: an impact there and one at 2^10 edge lengths must
equal that at the origin to rounding, with penetrations of about 1e-3, and blocks at rest on each
other must not chatter."""
import numpy as np
from _hard import Block, energy_change, mesh_of

NAME = "H15"
TITLE = "positions with the resolution of floats"
DECK = "h15_far_away.toml"
SECONDS = 10
PLACES = {"origin": 0.0, "2^10": 2.0**10, "2^29": 2.0**29}


def at(lab, label, place, velocity, gap, settings=None):
    low, high = Block("low"), Block("high", (0.125, 0.0625, 1 + gap))
    mesh = mesh_of(low, high).mapped(lambda x: x + place * np.array([1.0, -1.0, 1.0]))
    return lab.run(f"{label}_{place:g}", {"initial.velocity[0].velocity": velocity, **(settings or {})}, mesh=mesh)


def difference(run, reference, name="displacement"):
    last = len(run.results.times) - 1
    fields = [found.results.nodal(name, last) for found in (run, reference)]
    return np.abs(fields[0] - fields[1]).max() / np.abs(fields[1]).max()


def evaluate(lab):
    gradient = [0.01, 0.02, 0, 0, -0.01, 0, 0, 0.03, 0]
    rows = []
    runs = {}
    for name, place in PLACES.items():
        # Without contact.
        swing = at(lab, "swing", place, [0, 0, 0], 0.5, {"initial.deformation[0].gradient": gradient, "initial.deformation[0].center":
                                                        place * np.array([1.0, -1.0, 1.0]), "initial.deformation[0].block": "low"})
        impact = at(lab, "impact", place, [0.004, 0.002, -0.01], 2.0**-10)
        rest = at(lab, "rest", place, [0, 0, 0], 0.0)
        runs[name] = swing, impact, rest
        energy = energy_change(impact.history)
        rows.append([name, 2.0**-52 * max(place, 1.0), difference(swing, runs["origin"][0]), difference(impact, runs["origin"][1]),
                     energy[-1], np.abs(energy).max(), int(impact.history["contacts"].max()),
                     rest.history["kinetic_energy"].max()])
    lab.check(rows[2][2], 0, 0)
    for row in rows[1:]:
        # Penetrations of about 1e-3 are rounded to the spacing of positions; forces are
        # proportional to them.
        lab.check(row[3], 0, max(1e3 * row[1], 1e-12), f"impact_at_{row[0].replace('^', '_')}")
    lab.check(max(row[5] for row in rows), 0, 5e-3, "energy_of_impacts")
    lab.check(max(row[7] for row in rows), 0, 0, "rest_stays_rest")
    lab.table("By distance from the origin in edge lengths; differences from the run at the origin over the largest displacement:",
              ["place", "spacing of positions", "vibrating block", "impact", "energy, final", "energy, largest", "most contacts",
               "kinetic energy of blocks at rest"], rows)
