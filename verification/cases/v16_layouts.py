"""V16: The same deck on several numbers of ranks and threads gives the same bits, with friction,
viscosity and all damping: forces are summed as 64-bit integers, energies in limbs of integers,
decisions come from exact reductions and ties are broken by global id. The comparison covers all
bytes of history.csv and all bits of all variables of the joined Exodus files."""
from framework.bits import different_bits
from v17_oblique_impact import random_impact

NAME = "V16"
TITLE = "the same bits on any ranks and threads"
DECK = "v16_layouts.toml"
SECONDS = 60


def compare(lab, scene, layouts, settings, **how):
    """(differences, rows of the table, the run on one rank of one thread)."""
    alone = lab.run(f"{scene}_1x1", settings, ranks=1, threads=1, **how)
    rows, total = [], 0
    for ranks, threads in layouts:
        run = lab.run(f"{scene}_{ranks}x{threads}", settings, ranks=ranks, threads=threads, **how)
        count, differing = different_bits(alone.results, run.results)
        same_history = (alone.folder / "history.csv").read_bytes() == (run.folder / "history.csv").read_bytes()
        rows.append([scene, ranks, threads, count, differing, "yes" if same_history else "no"])
        total += differing + (not same_history)
    return total, rows, alone


def evaluate(lab):
    layouts = [(2, 1), (3, 2)] if lab.quick else [(1, 2), (1, 4), (2, 1), (2, 2), (2, 4), (4, 1), (4, 2), (8, 1)]
    differing, rows, wall = compare(lab, "wall", layouts, {"time.end": 5e-4} if lab.quick else {})
    lab.check(differing, 0, 0)
    # A wall at rest would be equal on any layout: there must be motion and contact.
    lab.require(wall.history["contacts"].max() > 100, "contacts_of_the_wall")
    mesh, scene = random_impact(0)
    differing, more, impact = compare(lab, "impact", layouts[-2:], {**scene, "time.end": 60.0}, mesh=mesh,
                                      deck=lab.deck_path.with_name("v17_oblique_impact.toml"))
    lab.check(differing, 0, 0, "impact_from_a_mesh")
    lab.require(impact.history["contacts"].max() > 0, "contacts_of_the_impact")
    lab.table("Compared with one rank and one thread:",
              ["scene", "ranks", "threads", "values compared", "different values", "same history.csv"], rows + more)
    with lab.figure("Energies of the wall by time, the same on every layout") as axes:
        for name in ("kinetic_energy", "internal_energy", "contact_energy"):
            axes.plot(wall.history["time"], wall.history[name], label=name.replace("_", " "))
        axes.set(xlabel="t (s)", ylabel="J")
