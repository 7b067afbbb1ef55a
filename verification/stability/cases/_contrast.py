"""Common to the contrasts of stiffness and density: a bar of unit impedance hits another, compared
with theory; oblique impacts."""
import numpy as np
from _hard import energy_change
from _impact import impact
from framework.meshes import box, nodal_masses, together

ELEMENT, WIDTH, SPEED = 0.05, 0.05, 1e-3
SEEDS = range(4)


def bars(lab, other_length):
    """A bar of unit length, density and modulus meets one of `other_length`; all elements are
    cubes."""
    mesh = together(box((1, WIDTH, WIDTH), (20, 1, 1), (-1, 0, 0), "low"),
                    box((other_length, WIDTH, WIDTH), (round(other_length / ELEMENT), 1, 1), name="high"))
    run = lab.run("bars", mesh=mesh)
    material = lab.deck["material"]["high"]
    impedance = np.sqrt(material["density"] * material["youngs_modulus"])
    stress = impedance / (1 + impedance) * SPEED
    results = run.results
    low = results.nodes_of_block(0)
    masses = nodal_masses(results.nodes, results.hexes_of_block[0])[low]
    momenta = [masses @ results.nodal("velocity_x", step)[low] for step in range(len(results.times))]
    one, two = (np.abs(results.times - time).argmin() for time in (0.5, 1.5))
    force = (momenta[one] - momenta[two]) / (results.times[two] - results.times[one])
    lab.check(force / WIDTH**2, stress, 2e-3)
    energy = energy_change(run.history)
    lab.check(np.abs(energy).max(), 0, 1e-3, "energy_of_bars")
    # The penetration relative to the distance of the impact.
    lab.check(run.history["max_penetration"].max() * ELEMENT / (SPEED * 2), 0, 0.1, "depth_over_distance")
    step = run.history["timestep"][0]
    fastest = max(1.0, np.sqrt(material["youngs_modulus"] / material["density"]))
    lab.note(f"The step is {step * fastest / ELEMENT:.3f} of the fastest element's h/c.")
    momentum = np.abs(run.history["momentum_x"] / run.history["momentum_x"][0] - 1).max()
    lab.check(momentum, 0, 1e-12, "momentum")
    return run


def impacts(lab, deck):
    rows = []
    for seed in SEEDS if not lab.quick else SEEDS[:1]:
        run = impact(lab, f"impact_{seed}", seed, lab.deck_path.with_name(deck))
        energy = energy_change(run.history)
        rows.append([seed, energy[-1], np.abs(energy).max(), run.history["max_penetration"].max(), run.history["contacts"].max(),
                     int(run.history["lost_contacts"][-1])])
    lab.check(max(row[2] for row in rows), 0, 5e-3, "energy_of_impacts")
    lab.check(min(row[4] for row in rows) > 0, 1, 0, "blocks_have_met")
    lab.table("Impacts of two blocks:", ["seed", "energy, final", "energy, largest", "deepest / face", "most contacts",
                                         "contacts lost"], rows)


def draw(lab, run):
    with lab.figure("Energies of the bars over the initial energy by time") as axes:
        history = run.history
        for name in ("kinetic_energy", "internal_energy", "contact_energy"):
            axes.plot(history["time"], history[name] / history["total_energy"][1], label=name.replace("_", " "))
        axes.set(xlabel="t c/L", ylabel="energy / E_0")
