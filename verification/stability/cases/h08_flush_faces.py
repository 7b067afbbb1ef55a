"""H8: Bricks in running bond, all faces flush and coplanar, without gap and friction. A whole
course hits another at 0.01 c: the pressure is uniform, so with nu = 0 it is the impact of two bars,
and no brick may be pushed along its course, least of all at the joints. Then a course of two
bricks, shifted by half a brick, hits the other (the overhanging brick tilts), slides along it,
presses and slides at once, and leaves it."""
import numpy as np
from _hard import energy_change
from framework.meshes import bodies, nodal_masses

NAME = "H8"
TITLE = "flush coplanar faces"
DECK = "h08_flush_faces.toml"
SECONDS = 20
SCENES = {"impact": (0, 0, -0.01), "sliding": (0.01, 0, 0), "oblique": (0.01, 0.004, -0.004),
          "apart": (0.002, 0, 0.01)}


def side_momentum(run):
    """Largest final velocity of a brick along its course."""
    results = run.results
    masses = nodal_masses(results.nodes, results.hexes)
    velocity = results.nodal("velocity")
    return max(np.abs(masses[body] @ velocity[body][:, :2]).max() / masses[body].sum()
               for body in bodies(len(results.nodes), results.hexes))


def evaluate(lab):
    rows, curves = [], {}
    for name, velocity in list(SCENES.items())[:2 if lab.quick else None]:
        for poisson in (0.0, 0.3):
            settings = {f"initial.velocity[{i}].velocity": velocity for i in (0, 1)}
            run = lab.run(f"{name.replace(' ', '_')}_{poisson}", {**settings, "material.brick.poissons_ratio": poisson})
            history = run.history
            energy = curves[f"{name}, nu = {poisson}"] = energy_change(history)
            rows.append([name, poisson, energy[-1], np.abs(energy).max(), side_momentum(run) / 0.01, int(history["contacts"].max()),
                         history["max_penetration"].max(), int(history["lost_contacts"][-1])])
    lab.check(max(row[3] for row in rows), 0, 5e-3)  # the threshold of impacts at any time (V17)
    level(lab)
    lab.check(min(row[5] for row in rows[:2]) > 0, 1, 0, "they_have_met")
    lab.check(max(row[7] for row in rows), 0, 0, "contacts_lost")
    lab.table("By scene:", ["scene", "nu", "energy, final", "energy, largest", "sideways velocity / 0.01", "most contacts",
                            "deepest / face", "contacts lost"], rows)
    draw(lab, curves)


def level(lab):
    """Impact of a course of a half, a whole and a half brick on two whole bricks."""
    run = lab.run("level", deck=lab.deck_path.with_name("h08_level_course.toml"))
    history = run.history
    # Faces bend at joints; a node in contact with a side face would leave at the speed of the
    # impact.
    lab.check(side_momentum(run) / 0.01, 0, 1e-4, "no_brick_leaves_sideways")
    lab.check(np.abs(energy_change(history)).max(), 0, 2e-3, "energy_of_the_level_impact")
    # Waves through bricks of height 1 and back, and the spring of the penalty, as in V2 with 4
    # elements.
    pressed = history["time"][history["contacts"] > 100]
    lab.check(np.ptp(pressed), 2.0, 0.3, "contact_time")


def draw(lab, curves):
    with lab.figure("Relative change of the energy by time") as axes:
        for name, energy in curves.items():
            axes.plot(np.arange(len(energy)), energy, label=name, linewidth=0.8)
        axes.set(xlabel="step", ylabel="E/E_0 - 1")
