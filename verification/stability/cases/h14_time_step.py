"""H14: The time step at 0.95 to 1.01 of the true bound. A plate of one element (a << b, nu = 0,
St.Venant-Kirchhoff) is held in its thickness, so its fastest mode is the shear across it, omega^2 =
(8/rho) G_1 (mu + S), G_1 = 1/(2 a^2). Under a stretch F of the thickness S = mu (F^2 - 1), so chi =
omega dt/2 = F/sqrt(2) at the step a/c of the unstretched plate. The stretch is applied within the
first step, so that chi is set exactly, also beyond 1, before the first check of the step. Central
differences from x = 0 at the speed v0 then give v^{n+1/2} = v0 cos((n + 1/2) theta)/cos(theta/2),
cos theta = 1 - 2 chi^2: the kinetic energy stays below K_0/(1 - chi^2) for chi < 1, is (2 n + 1)^2
K_0 at 1, and beyond grows by 4 arcosh(chi) in the exponent each step. A scheme with hidden damping
has no such sharp limit. With checks the program must detect the stretch and shorten its step."""
import numpy as np
from _hard import check_stop
from framework.meshes import box

NAME = "H14"
TITLE = "time step at 0.95 to 1.01 of the bound"
DECK = "h14_time_step.toml"
SECONDS = 5
THICKNESS, WIDTH = 0.01, 1.0
BELOW, ABOVE = (0.95, 0.99, 0.999), (1.001, 1.01)


def run_at(lab, label, chi, steps, settings=None, expect=0):
    stretch = np.sqrt(2) * chi
    step = THICKNESS  # c = 1: the bound of the plate at rest, h/c
    speed = (stretch - 1) * THICKNESS / step
    return lab.run(label, {"boundary.velocity[0].velocity": [speed, 0, 0], "boundary.velocity[0].duration": step,
                           "time.steps": steps, **(settings or {})},
                   mesh=box((THICKNESS, WIDTH, WIDTH), (1, 1, 1), name="plate"), expect=expect)


def energies(run, kinetic_0):
    """K^{n+1/2} over K_0 of the shear mode from n = 1 on, after the prescribed motion."""
    return run.history["kinetic_energy"][1:] / kinetic_0


def evaluate(lab):
    steps = 400
    rate = lab.deck["initial"]["velocity"][0]["angular_velocity"][2]
    # v_y = w x from the middle plane: +-w a/2 at all eight nodes.
    kinetic_0 = 0.5 * THICKNESS * WIDTH**2 * (rate * THICKNESS / 2)**2
    n = np.arange(1, steps + 1)
    curves = {}
    for chi in BELOW:
        kinetic = energies(run_at(lab, f"chi_{chi}", chi, steps), kinetic_0)
        theta = np.arccos(1 - 2 * chi**2)
        exact = (np.cos((n + 0.5) * theta) / np.cos(theta / 2))**2
        curves[chi] = kinetic
        lab.check(kinetic.max(), exact.max(), 1e-3, f"largest_at_{chi}" if chi != BELOW[0] else "")
        lab.check(kinetic.max() * (1 - chi**2), 1, 1e-9, f"bounded_at_{chi}", error=max(0.0, kinetic.max() * (1 - chi**2) - 1))
    curves[1.0] = energies(run_at(lab, "chi_1", 1.0, steps), kinetic_0)
    lab.check(curves[1.0][-1], (2 * steps + 1)**2, 1e-3, "linear_growth_at_1")
    for chi in ABOVE:
        curves[chi] = energies(run_at(lab, f"chi_{chi}", chi, round(3 / np.arccosh(chi))), kinetic_0)
        # After the decaying part of the start, and long before other modes.
        growth = np.log(curves[chi][-1] / curves[chi][-11]) / 10
        lab.check(growth, 4 * np.arccosh(chi), 0.02, f"growth_at_{chi}")
    stop(lab)
    with lab.figure("Kinetic energy of the shear over the initial one by step") as axes:
        for chi, kinetic in curves.items():
            axes.semilogy(np.arange(1, len(kinetic) + 1), kinetic, label=f"dt / bound = {chi}", linewidth=0.8)
        axes.set(xlabel="step", ylim=(1e-4, 1e7))


def stop(lab):
    """Beyond the bound the run must stop with the reason; checks of the step must keep it below the
    bound."""
    # The stretch of 43 % in one step is itself an energy error of this order.
    beyond = run_at(lab, "stopped", 1.01, 4000, {"limits.energy_error": 0.5}, expect=None)
    check_stop(lab, beyond, ["in step"], "stops_beyond_the_bound")
    checked = run_at(lab, "checked", 1.01, 4000, {"time.check_interval": 5})
    steps = checked.history["timestep"]
    # The bound does not depend on held nodes: the stiffness against stretching is E (3 F^2 - 1)/2.
    # A shortened step has a reserve of a tenth.
    lab.check(steps[-1] / THICKNESS, 0.9 / np.sqrt((6 * 1.01**2 - 1) / 2), 1e-3, "checks_shorten_the_step")
    lab.check(checked.history["kinetic_energy"][10:].max() < 1e3 * checked.history["kinetic_energy"][10], 1, 0, "checks_keep_it_stable")
