"""V2b: A bar with velocity v hits a bar at rest (c = rho = 1, nu = 0). With lengths L1 = 1/2 and L2
= 1 and equal materials, the contact lasts T = 2 L1/c; then the short bar rests and the long one
leaves with v L1/L2, so the restitution is e = L1/L2 and the remaining energy is vibration. With
impedances Z = rho c of 1 and 2 (E2 = 4 E1), the stress is Z1 Z2 v/(Z1 + Z2) until the first wave
returns."""
import numpy as np
from _bars import crossings, histories, mean_between
from framework.figures import EXACT
from framework.meshes import box, together

NAME = "V2b"
TITLE = "bars of unlike length and impedance"
DECK = "v02b_unlike_bars.toml"
AREA = 0.01


def two_bars(left_length, left_elements, right_length, right_elements):
    """Bars that touch at x = 0."""
    width = np.sqrt(AREA)
    return together(box((left_length, width, width), (left_elements, 1, 1), (-left_length, 0, 0), "left"),
                    box((right_length, width, width), (right_elements, 1, 1), name="right"))


def evaluate(lab):
    v = lab.deck["initial"]["velocity"][0]["velocity"][0]
    meshes = (20, 40, 80) if lab.quick else (20, 40, 80, 160)  # elements in the short bar
    lengths = {n: histories(lab.run(f"length_n{n}", mesh=two_bars(0.5, n, 1.0, 2 * n)).results) for n in meshes}
    # Waves of equal amplitude run into both bars, so the plateau is that of two bars at half the
    # velocity each.
    half_plateau, exact_time = 0.25 * v * AREA, 1.0
    durations = {n: np.ptp(crossings(bars.times, bars.force[1], half_plateau)) for n, bars in lengths.items()}
    after = {n: bars.velocity[:, -1] / v for n, bars in lengths.items()}

    lab.check(durations[80], exact_time, 0.02)
    lab.check_order([1 / n for n in meshes], [time - exact_time for time in durations.values()], 0.6, "duration_order", 1)
    restitution = after[80][1] - after[80][0]
    lab.check(restitution, 0.5, 0.02, "restitution", error=abs(restitution - 0.5))
    lab.check_order([1 / n for n in meshes], [v1 for v1, _ in after.values()], 0.9, "restitution_order", 1)
    lab.table("Unequal lengths:", ["elements in the short bar", "T c/(2 L1), exact 1", "v1/v, exact 0", "e, exact 0.5"],
              [[n, durations[n], v1, v2 - v1] for n, (v1, v2) in after.items()])
    lab.weak_spot("contact oscillates with the frequency of its springs and cannot pull, so the short bar gets too much "
                  f"impulse: {100 * abs(after[meshes[0]][0]):.1f} % with {meshes[0]} elements, of first order in their size")

    n = 80  # bars of lengths 1 and 2 with wave speeds 1 and 2 have the same stable step; waves return at t = 2
    run = lab.run("impedance", {"material.right.youngs_modulus": 4.0}, mesh=two_bars(1.0, n, 2.0, n))
    impedance = histories(run.results)
    stress = mean_between(impedance.times, impedance.force[1], 0.5, 1.5) / AREA
    lab.check(stress, 2 / 3 * v, 1e-3, "impedance_stress")
    finest = lengths[meshes[-1]]
    momentum = max(abs(bars.mass @ bars.velocity - bars.mass[0] * v).max() for bars in (finest, impedance))
    lab.check(momentum / (v * AREA), 0, 1e-12, "momentum")

    with lab.figure("Contact force by time: unequal lengths, unequal impedance", panels=2) as (left, right):
        left.step([0, 0, 1, 1, 2], [0, 0.5, 0.5, 0, 0], label="exact", **EXACT)
        left.plot(finest.times, finest.force[1] / (v * AREA), label=f"N = {meshes[-1]}", linewidth=1)
        right.plot([0, 0, 2], [0, 2 / 3, 2 / 3], label="exact", **EXACT)
        right.plot(impedance.times, impedance.force[1] / (v * AREA), label=f"N = {n}", linewidth=1)
        for axes in (left, right):
            axes.set(xlabel="t", ylabel="F / (Z1 v A)")
