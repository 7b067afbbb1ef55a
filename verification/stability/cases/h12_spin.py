"""H12: Two free bricks of 2 x 1 x 1 spin side by side for 100,000 steps, with a gap of 0.16 where
their corners pass and with search and contact on. Central differences do not conserve the energy
exactly in finite rotation, but conserve an energy within O(dt^2) of it: its mean must not drift.
Momenta are exact, the bricks must not grow, and there must be no contact."""
import numpy as np
from framework.meshes import box, together

NAME = "H12"
TITLE = "spinning bricks, tips at 0.1 c, 100,000 steps"
DECK = "h12_spin.toml"
SECONDS = 60


def evaluate(lab):
    size, elements = (2, 1, 1), (4, 2, 2)
    mesh = together(box(size, elements, (-1, -0.5, -0.5), "left"), box(size, elements, (1.4, -0.5, -0.5), "right"))
    run = lab.run("spin", {"time.steps": 10000} if lab.quick else {}, mesh=mesh)
    history = run.history
    energy = history["total_energy"][1:]
    window = len(energy) // 10
    drift = energy[-window:].mean() / energy[:window].mean() - 1
    # The mean varies by 1e-5 over a hundred revolutions, and returns.
    lab.check(1 + drift, 1, 1e-5)
    lab.check(np.ptp(energy) / energy[0], 0, 2e-3, "energy_spread")
    angular = run.vector("angular_momentum")
    spin = 2 * 2 * (4 + 1) / 12 * 0.0894427
    # Forces are rounded to 2^-54 of the largest: torques are random walks over elements and steps.
    lab.check(np.abs(angular - angular[0]).max() / spin, 0, 1e-12, "angular_momentum")
    lab.check(np.abs(run.vector("momentum")).max(), 0, 1e-13 * spin, "momentum")
    lab.check(history["ledger_residual"].max(), 0, 1e-12, "ledger")
    lab.check(history["contacts"].max(), 0, 0, "no_contact")
    lengths = np.array([length(run, step) for step in range(len(run.results.times))])
    # The static extension by rotation is rho w^2 L^2/(12 E); the vibration multiplies it by up to
    # 4.
    stretch = 0.0894427**2 * 4 / 12
    lab.check(lengths[1:].max() / 2 - 1, 0, 4 * stretch, "growth", error=abs(lengths[1:] / 2 - 1).max())
    turns = 0.0894427 * history["time"][-1] / (2 * np.pi)
    lab.note(f"{turns:.0f} revolutions; the mean energy of the last tenth differs from that of the first by {drift:+.2g}.")
    with lab.figure("Relative change of the energy by time") as axes:
        axes.plot(history["time"][1:], energy / energy[0] - 1, linewidth=0.3)
        axes.set(xlabel="t c/width", ylabel="E/E_0 - 1")


def length(run, step):
    """The length of the left brick between the centres of its ends."""
    results = run.results
    x = results.nodes + results.nodal("displacement", step)
    left = results.nodes_of_block(0)
    ends = [left[np.isclose(results.nodes[left, 0], end)] for end in (-1, 1)]
    return np.linalg.norm(x[ends[1]].mean(axis=0) - x[ends[0]].mean(axis=0))
