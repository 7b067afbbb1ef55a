"""V23: A block slides on a rigid plane with the velocity v0. Friction mu stops it after the distance
v0^2/(2 mu g), since the contact forces carry its weight in the mean. Friction excites the vibration
of the sliding face; if contacts chatter, friction is not mu F_n where they begin. Sliding contacts
that return settle (contact/theory.md, section 8), so that the distance is exact."""
import numpy as np
from framework.figures import EXACT
from framework.meshes import box, nodal_masses, together

NAME = "V23"
TITLE = "stopping block"
DECK = "v23_stopping_block.toml"


def scene(n):
    """A block of n x n x n/2 elements on a plane."""
    block = box((1, 1, 0.5), (n, n, n // 2), name="block")
    plane = box((4, 3, 1), (4, 3, 1), (-1.5, -1, -1), "plane")
    plane.node_sets = {"plane.all": np.arange(len(plane.nodes))}
    return together(block, plane)


def distances(run):
    """Times; distance of the block's centre of mass by time."""
    results = run.results
    block = results.nodes_of_block(0)
    masses = nodal_masses(results.nodes, results.hexes)[block]
    steps = range(len(results.times))
    return results.times, np.array([masses @ results.nodal("displacement_x", step)[block] for step in steps]) / masses.sum()


def evaluate(lab):
    v0 = lab.deck["initial"]["velocity"][0]["velocity"][0]
    gravity = -lab.deck["gravity"]["acceleration"][2]
    rows, curves = [], {}
    for mu in (0.8, 0.3):
        exact, duration = v0**2 / (2 * mu * gravity), v0 / (mu * gravity)
        for n in (4, 8) if lab.quick else (4, 8, 16):
            run = lab.run(f"mu{mu}_n{n}", {"contact.friction": mu, "time.end": 1.2 * duration}, mesh=scene(n))
            times, distance = distances(run)
            lab.check(distance.max(), exact, 0.005, f"mu{mu}_n{n}" if rows else "")
            contacts = run.history["contacts"][run.history["time"] > 0.1 * duration]
            rows.append([mu, n, distance.max() / exact - 1, np.mean(contacts), (n + 1)**2,
                         run.history["dissipated_energy"][-1] / run.history["total_energy"][0], run.history["energy_error"].max()])
            curves[mu, n] = times / duration, distance / exact
    lab.check(max(row[-1] for row in rows), 0, 1e-5, "energy")
    lab.table("Distance; contacts in the mean; dissipated energy over the initial one:",
              ["mu", "elements", "error of the distance", "contacts", "nodes of the face", "dissipated", "energy error"], rows)
    with lab.figure("Distance by time") as axes:
        time = np.linspace(0, 1, 50)
        axes.plot(time, 2 * time - time**2, label="exact", **EXACT)
        for (mu, n), (times, distance) in curves.items():
            axes.plot(times, distance, label=f"mu = {mu}, n = {n}", linewidth=1)
        axes.set(xlabel="t mu g/v0", ylabel="x 2 mu g/v0^2")
