"""V10: An elastic block with a spherical bottom (radius R = 4, half-width and height B = 1) on a
rigid plane. For a contact of radius a, Hertz' half-space has the approach delta = a^2/R and the
force F = 4/3 E* sqrt(R delta^3); an impact with the velocity v that leads to this a lasts T = 2.868
(m^2/(R E*^2 v))^(1/5). The half-space is the limit a/B -> 0; elements are graded towards the
contact and have the length a/8 there. A quarter is computed. The penalty is one more spring between
block and plane: under a pressure p the penetration is 2 p (dt/h)^2 h/(rho s), so at 0.8 of the
stable step and penalty 0.5 it is a tenth of the compliance of a contact of eight elements. The case
therefore takes a shorter step and a larger penalty, and reports the effect of a softer contact."""
from dataclasses import dataclass

import numpy as np
from framework.figures import EXACT
from framework.meshes import box, graded_box, together, volumes

NAME = "V10"
TITLE = "Hertz contact, at rest and in impact"
DECK = "v10_hertz_impact.toml"
SECONDS = 300
RADIUS = 4.0
E_STAR = 1 / (1 - 0.3**2)  # the plane is rigid
SOFTER = {"time.safety": 0.8, "contact.penalty": 0.5}


def graded(step, even, end):
    """Points from 0 to `end`: steps of equal length up to `even`, then each 1.4 times the previous
    one."""
    points = list(np.arange(0, even + step / 2, step))
    while points[-1] < end:
        step *= 1.4
        points.append(points[-1] + step)
    points = np.array(points)
    last = np.searchsorted(points, even) + 1  # the points beyond are stretched to meet the end
    points[last:] = even + (points[last:] - even) * (end - even) / (points[-1] - even)
    return points


def quarter_ball(step, contact_radius):
    """The block [0, 1]^3 with its bottom on a sphere of RADIUS about (0, 0, RADIUS), and a plane at
    z = 0."""
    points = graded(step, 1.5 * contact_radius, 1.0)

    def onto_sphere(nodes):
        x, y, z = nodes.T
        return np.stack([x, y, z + (RADIUS - np.sqrt(RADIUS**2 - x**2 - y**2)) * (1 - z)], axis=1)

    ball = graded_box([points] * 3, "ball").mapped(onto_sphere)
    plane = box((2, 2, 1), (1, 1, 1), (-0.5, -0.5, -1), "plane")
    plane.node_sets = {"plane.all": np.arange(8)}
    return together(ball, plane)


def hertz_force(approach):
    return 4 / 3 * E_STAR * np.sqrt(RADIUS) * approach**1.5


@dataclass
class Impact:
    duration: float  # over Hertz' duration
    times: np.ndarray
    force: np.ndarray  # over Hertz' largest force, mean over 101 steps
    energy_error: float


def impact(lab, a, per_radius, settings=None):
    """An impact that leads to the contact radius `a`."""
    mesh = quarter_ball(a / per_radius, a)
    mass = 4 * volumes(mesh.nodes, mesh.hexes)[:-1].sum()  # all elements except that of the plane
    largest = hertz_force(a**2 / RADIUS)
    velocity = np.sqrt(2 * 0.4 * largest * a**2 / RADIUS / mass)  # m v^2/2 = 2/5 F delta
    exact = 2.868 * (mass**2 / (RADIUS * E_STAR**2 * velocity))**0.2
    run = lab.run(f"impact_{a:g}_{per_radius}{'_softer' if settings else ''}",
                  {"initial.velocity[0].velocity": [0, 0, -velocity], "time.end": 1.15 * exact, **(settings or {})},
                  mesh=mesh)
    history, window = run.history, 101
    force = 4 * np.diff(history["momentum_z"]) / np.diff(history["time"]) / largest
    return Impact(history["time"][np.flatnonzero(history["contacts"])[-1]] / exact, history["time"][1:],
                  np.convolve(force, np.ones(window) / window, "same"), history["energy_error"][-1])


def pressed(lab, a, per_radius, settings=None):
    """The force at rest over Hertz' force, at the approach that gives the contact radius `a`."""
    approach = a**2 / RADIUS
    run = lab.run(f"static_{a:g}_{per_radius}{'_softer' if settings else ''}",
                  {"boundary.velocity[0].velocity": [0, 0, -approach / 2], **(settings or {})},  # for a time of 4, sin^2
                  mesh=quarter_ball(a / per_radius, a), deck=lab.deck_path.with_name("v10_hertz_static.toml"))
    results = run.results
    return 4 * results.nodal("force_contact_z")[results.nodes_of_block(0)].sum() / hertz_force(approach)


def evaluate(lab):
    per_radius = 4 if lab.quick else 8
    ratios = (0.2, 0.1) if lab.quick else (0.2, 0.1, 0.05)  # a/B
    forces = [pressed(lab, a, per_radius) for a in ratios]
    impacts = [impact(lab, a, per_radius) for a in ratios]
    columns = {"contact time": [one.duration for one in impacts], "largest force": [one.force.max() for one in impacts],
               "force at rest": forces}
    limits = {name: np.polyval(np.polyfit(ratios[-2:], values[-2:], 1), 0) for name, values in columns.items()}
    for name, values in columns.items():
        label = name.replace(" ", "_")
        if name == "contact time" or not lab.quick:  # four elements at a/B = 0.1 resolve the forces too coarsely
            lab.check(values[-1], 1, 0.03, "" if name == "contact time" else label)
            lab.check(limits[name], 1, 0.03, label + "_of_small_contacts")
    lab.check(max(one.energy_error for one in impacts), 0, 1e-3, "energy")
    lab.table(f"Relative to Hertz' values, {per_radius} elements in a:", ["a/B", *columns],
              [*zip(ratios, *columns.values()), ["0 (by a line through the last two)", *limits.values()]])
    if not lab.quick:
        report_compliance(lab, ratios[1], columns["contact time"][1], forces[1])
    with lab.figure("Force by time of the impact with the smallest contact, mean over 101 steps") as axes:
        axes.plot(impacts[-1].times, impacts[-1].force, label="computed", linewidth=1)
        axes.axhline(1, label="largest force by Hertz", **EXACT)
        axes.set(xlabel="t c/B", ylabel="F / F_Hertz")


def report_compliance(lab, a, stiff_time, stiff_force):
    """The added duration of softer contact, by elements in the contact radius."""
    meshes = (4, 6, 8, 12)
    added = [impact(lab, a, n, SOFTER).duration - stiff_time for n in meshes]
    force = pressed(lab, a, 8, SOFTER)
    lab.check_order([1 / n for n in meshes], added, least=0.8, exact=1, name="order_of_compliance")
    lab.table(f"Added to the contact time by time.safety = 0.8 and contact.penalty = 0.5, softer than the defaults, a/B = {a}:",
              ["elements in a", "added"], zip(meshes, added))
    softer = 100 * (1 - force / stiff_force)
    lab.weak_spot(f"penalty 0.5 at 0.8 of the stable step makes a Hertz contact of 8 elements in its radius {softer:.0f} % softer and an "
                  f"impact {100 * added[2]:.1f} % longer, of first order in the element size; a shorter step and a larger "
                  "contact.penalty reduce it, at the cost of more steps")
