"""H2: Poisson's ratio 0.499. A cantilever of 10 x 1 x 1 with two elements through the depth must
bend: its first frequency is 0.01019(1) by converged meshes (E = rho = 1), while elements of 2x2x2
points lock. The stable step of a cube of one element is 0.578 h/c_d = sqrt((1 - nu)/(1 + nu)) h/c_d
in closed form. Then two such blocks collide obliquely."""
import numpy as np
from _hard import energy_change
from _impact import impact
from framework.meshes import box
from framework.signals import fit_frequency, tip_deflection
from h01_aspect_ratio import critical_step

NAME = "H2"
TITLE = "Poisson's ratio 0.499"
DECK = "h02_nearly_incompressible.toml"
SECONDS = 60
CONVERGED = 0.01019  # to 1e-5
POISSON = 0.499


def frequency(lab, element):
    run = lab.run(element, {"element.formulation": element}, mesh=box((10, 1, 1), (20, 2, 2), name="beam"))
    results = run.results
    deflection = tip_deflection(results)
    return fit_frequency(results.times, deflection, CONVERGED, width=0.8), run, results.times, deflection


def evaluate(lab):
    found, run, times, deflection = frequency(lab, "one_point")
    lab.check(found, CONVERGED, 0.02)
    modulus = (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    # The program's step is that of the whole beam; `gain` is its ratio to the step of the worst
    # element. The exact steps are those of row sums.
    steps = lab.run("row_sum", {"element.mass": "row_sum", "time.steps": 1}, mesh=box((10, 1, 1), (20, 2, 2), name="beam"))
    gain = steps.report["time_step"]["gain"]
    computed = steps.history["timestep"][0] / gain / lab.deck["time"]["safety"] / (0.5 / np.sqrt(modulus))
    lab.check(computed, critical_step((1, 1, 1), POISSON), 1e-3, "step")
    lab.check(np.sqrt((1 - POISSON) / (1 + POISSON)), critical_step((1, 1, 1), POISSON), 1e-12, "step_in_closed_form")
    # 0.817 h/c_d is the dense solution of 2 x 2 x 2 free elements.
    lab.check(gain * computed, 0.817, 5e-3, "step_of_the_beam")
    lab.check(run.history["energy_error"][-1], 0, 1e-3, "energy_of_the_beam")
    full = frequency(lab, "full")[0]
    lab.table("First frequency of the beam, 20 x 2 x 2 elements:", ["element", "frequency", "error"],
              [["one_point", found, found / CONVERGED - 1], ["full (2x2x2 points)", full, full / CONVERGED - 1]])
    blocks(lab)
    with lab.figure("Deflection of the free end") as axes:
        axes.plot(times, deflection)
        axes.set(xlabel="t", ylabel="u_z")


def blocks(lab):
    rows = []
    for seed in range(3):
        run = impact(lab, f"impact_{seed}", seed, lab.deck_path.with_name("h02_impact.toml"))
        energy = energy_change(run.history)
        share = run.history["hourglass_energy"].max() / run.history["internal_energy"].max()
        rows.append([seed, energy[-1], np.abs(energy).max(), share, run.history["contacts"].max(),
                     run.history["lost_contacts"][-1]])
    lab.check(max(abs(row[2]) for row in rows), 0, 5e-3, "energy_of_impacts")
    lab.check(min(row[4] for row in rows) > 0, 1, 0, "blocks_have_met")
    lab.table("Impacts of two blocks:", ["seed", "energy, final", "energy, largest", "hourglass share", "most contacts",
                                         "contacts lost"], rows)
