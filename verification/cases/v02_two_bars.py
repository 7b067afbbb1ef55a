"""V2: Two equal bars (L = c = rho = 1, nu = 0) meet at +v0 and -v0. The contact force is F = rho c
v0 A until the waves return from the free ends at T = 2 L/c; then the bars separate with exchanged
velocities and without vibration. The penalty acts as a spring between the bars with the compliance
of a part of an element, so T is too long by O(h)."""
import numpy as np
from _bars import histories, last_time, mean_between
from framework.figures import EXACT, draw_slope

NAME = "V2"
TITLE = "impact of two equal bars"
DECK = "v02_two_bars.toml"
# Relative errors of T of another code at the same settings, with a margin of a tenth; half a step
# is added, since T is the time of a step.
DURATION_ERRORS = {20: 0.064, 40: 0.039, 80: 0.02, 160: 0.011}


def evaluate(lab):
    v0 = lab.deck["initial"]["velocity"][0]["velocity"][0]
    area = np.prod(lab.deck["wall"]["brick"][1:])
    exact_force, exact_time = v0 * area, 2.0
    meshes = list(DURATION_ERRORS)[:3] if lab.quick else list(DURATION_ERRORS)
    runs = {n: lab.run(f"n{n}", {"wall.elements": [n, 1, 1]}) for n in meshes}
    impacts = {n: histories(run.results) for n, run in runs.items()}
    durations = {n: last_time(bars.times, bars.force[1] > 0) for n, bars in impacts.items()}
    errors = {n: abs(time / exact_time - 1) for n, time in durations.items()}
    plateaus = {n: mean_between(bars.times, bars.force[1], 0.5, 1.5) for n, bars in impacts.items()}
    finest = meshes[-1]

    allowed = {n: DURATION_ERRORS[n] + 0.5 * bars.times[1] / exact_time for n, bars in impacts.items()}
    lab.check(durations[finest], exact_time, allowed[finest])
    for n in meshes[:-1]:
        lab.check(durations[n], exact_time, allowed[n], f"duration_n{n}")
    # The order is 1 for the spring of the penalty and 2/3 for the smeared front that ends the
    # contact; T is known to one step.
    lab.check_order([1 / n for n in meshes], list(errors.values()), least=0.6, exact=1, name="duration_order")
    for n in (n for n in meshes if n >= 80):
        lab.check(plateaus[n], exact_force, 1e-3, f"force_n{n}")
    for n in meshes:
        lab.check(impacts[n].velocity[0, -1], -v0, 0.02, f"swap_n{n}")
    last_rows = {n: {name: column[-1] for name, column in run.history.items()} for n, run in runs.items()}
    lab.check(last_rows[meshes[0]]["energy_error"], 0, 0.013, f"energy_n{meshes[0]}")
    # Contact forces are integers of equal size and opposite sign: the momentum has the rounding
    # error of the kicks only.
    momentum = max(abs(run.history["momentum_x"]).max() for run in runs.values())
    lab.check(momentum, 0, 1e-13 * v0 * area, "momentum")
    lab.check(max(row["ledger_residual"] for row in last_rows.values()), 0, 1e-12, "ledger")

    lab.table("Relative errors; the energy error is the largest over time, relative to the initial kinetic energy.",
              ["elements a bar", "T c/L", "error of T", "force / exact", "energy error"],
              [[n, durations[n], errors[n], plateaus[n] / exact_force, last_rows[n]["energy_error"]] for n in meshes])
    lab.weak_spot(f"the penalty makes the impact of two bars longer by {100 * errors[meshes[0]]:.1f} % with {meshes[0]} "
                  f"elements a bar and {100 * errors[finest]:.1f} % with {finest}: the interface is compliant to first order "
                  "in the element size")
    times, force = impacts[finest].times, impacts[finest].force[1]
    oscillation = np.ptp(force[(times > 0.5) & (times < 1.5)]) / 2 / exact_force
    lab.weak_spot(f"the contact force oscillates from step to step by {100 * oscillation:.0f} % about its plateau, as undamped "
                  "springs do; contact.damping reduces it")
    with lab.figure("Contact force by time; error of the contact time by element length", panels=2) as (force, error):
        force.step([0, 0, 2, 2, 3], [0, 1, 1, 0, 0], label="exact", **EXACT)
        for n in (meshes[0], finest):
            force.plot(impacts[n].times, impacts[n].force[1] / exact_force, label=f"N = {n}", linewidth=1)
        force.set(xlabel="t c/L", ylabel="F / (rho c v0 A)")
        sizes = [1 / n for n in meshes]
        error.loglog(sizes, list(errors.values()), "o-", label="T / (2 L/c) - 1")
        draw_slope(error, sizes, list(errors.values()), 1)
        error.set(xlabel="h/L")
    if not lab.quick:
        compare_with_abaqus(lab)


def compare_with_abaqus(lab):
    """The truss impact of the Abaqus Benchmarks Guide, with its 10 elements and with 80."""
    for n in (10, 80):
        bars = histories(lab.run(f"truss_n{n}", {"wall.elements": [n, 1, 1]},
                                 deck=lab.deck_path.with_name("v02_truss_impact.toml")).results, density=7800.0)
        force = bars.force[1]
        pressed = bars.times[force > 0.5 * force.max()]
        step = bars.times[1]
        source = f"Abaqus Benchmarks Guide 1.3.15, analytical; here {n} elements"
        lab.publish("truss impact: contact time, s", float(np.ptp(pressed) + step), 7.9e-4, source)
        lab.publish("truss impact: contact force, N", float(mean_between(bars.times, force, 8e-4, 13e-4)), 11.8e6, source)
        lab.publish("truss impact: rebound velocity, m/s", float(bars.velocity[1, -1]), 1.5, source)
