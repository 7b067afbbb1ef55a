"""H16: A wall of 4 x 5 bricks in running bond, friction 0.6, stands under its own weight for 20,000
steps; each brick touches up to six others, and joints open and close all the time. The weight acts
at once, and nothing but friction dissipates: the energy must not drift, bricks must not creep along
their joints, displacements must not ratchet. With mass-proportional damping the wall must come to
rest, and each course must carry exactly the weight above it. Runs without friction and with the
plain penalty scheme are for comparison."""
import numpy as np
from _hard import energy_change
from framework.meshes import bodies, nodal_masses

NAME = "H16"
TITLE = "standing wall over 20,000 steps"
DECK = "h16_standing_wall.toml"
SECONDS = 200
GRAVITY, DENSITY, MODULUS, HEIGHT = 9.81, 2000.0, 2e8, 0.1


class Wall:
    def __init__(self, run):
        self.run, results = run, run.results
        masses = nodal_masses(results.nodes, results.hexes, DENSITY)
        self.bricks = bodies(len(results.nodes), results.hexes)
        self.masses = [masses[brick] for brick in self.bricks]
        self.course = np.array([round(results.nodes[brick, 2].min() / HEIGHT) for brick in self.bricks])

    def places(self):
        """Displacements of the centres of mass [step][brick][xyz]."""
        moves = [self.run.results.nodal("displacement", step) for step in range(len(self.run.results.times))]
        return np.array([[mass @ move[brick] / mass.sum() for brick, mass in zip(self.bricks, self.masses)] for move in moves])


def evaluate(lab):
    steps = 3000 if lab.quick else 20000
    settings = {"wall.bricks": [2, 1, 3]} if lab.quick else {}
    variants = {"friction 0.6": {}, "damped": {"damping.mass": 400.0 if lab.quick else 50.0}}
    if not lab.quick:
        variants |= {"penalty scheme": {"contact.scheme": "penalty"}, "without edges": {"contact.edges": False},
                     "no friction": {"contact.friction": 0.0}}
    rows, curves, walls = [], {}, {}
    for name, more in variants.items():
        run = lab.run(name.replace(" ", "_"), {**settings, **more, "time.steps": steps})
        wall = walls[name] = Wall(run)
        energy = curves[name] = energy_change(run.history)
        places = wall.places()
        height = places[:, :, 2]
        sideways = np.linalg.norm(places[:, :, :2], axis=2)
        half, settled = len(energy) // 2, len(places) // 4
        creep = np.linalg.norm(places[settled:, :, :2] - places[settled, :, :2], axis=2).max()
        rows.append([name, np.abs(energy).max(), energy[-1] - energy[half], energy[-1], np.abs(height).max(),
                     sideways.max(), creep, run.history["kinetic_energy"][-1]
                     / np.max(run.history["kinetic_energy"]), int(run.history["lost_contacts"][-1])])
    by_name = {row[0]: row for row in rows}
    wall = by_name["friction 0.6"]
    lab.check(wall[1], 0, 3e-3)
    lab.check(wall[2], 0, 1e-3, "drift_of_the_second_half")
    # The first oscillation lifts the uppermost bricks, which land with an offset. From then on
    # friction must hold them: their motion must be a part of the settlement rho g H^2/(2 E), with
    # which the wall oscillates.
    courses = (settings.get("wall.bricks") or lab.deck["wall"]["bricks"])[2]
    settlement = DENSITY * GRAVITY * (HEIGHT * courses)**2 / (2 * MODULUS)
    lab.check(wall[6] / settlement, 0, 0.5, "creep_over_settlement")
    lab.check(max(row[8] for row in rows), 0, 0, "contacts_lost")
    check_rest(lab, walls["damped"], by_name["damped"])
    lab.table("Energies over the largest kinetic + internal energy; lengths in m:",
              ["wall", "energy error", "of which in the second half", "energy, final", "largest settlement", "largest sideways",
               "creep after a quarter of the time", "final / largest kinetic energy", "contacts lost"], rows)
    if "no friction" in by_name:
        lab.weak_spot("a wall without friction, whose joints keep opening and closing, changes its energy by "
                      f"{by_name['no friction'][3]:.1g} of the peak in {steps} steps; with friction {wall[3]:.1g}")
    with lab.figure("Energy less the work of gravity, over the largest, by time") as axes:
        for name, energy in curves.items():
            axes.plot(walls[name].run.history["time"], energy, label=name, linewidth=0.6)
        axes.set(xlabel="t (s)", ylabel="E / E_peak")


def check_rest(lab, wall, row):
    """At rest each joint carries the weight above it: the contact forces on the courses above sum
    to their weight."""
    results = wall.run.results
    forces = results.nodal("force_contact")
    errors = []
    for course in range(1, wall.course.max() + 1):
        above = np.concatenate([brick for brick, place in zip(wall.bricks, wall.course) if place >= course])
        weight = sum(mass.sum() for mass, place in zip(wall.masses, wall.course) if place >= course) * GRAVITY
        errors.append(abs(forces[above, 2].sum() / weight - 1))
    lab.check(max(errors), 0, 1e-6, "joints_carry_the_weight_above")
    lab.check(row[7], 0, 1e-12, "comes_to_rest")
    moves = wall.places()
    lab.check(np.abs(moves[-1] - moves[3 * len(moves) // 4]).max(), 0, 1e-12, "stays_at_rest")
