"""H1: Elements of aspect ratio 16 to 64, rods and plates. The stable step of a body of one such
element has a closed form: with G_i = 1/(2 l_i^2), omega^2 = (8/rho) lambda_max[(lambda + 2 mu
delta_ij) sqrt(G_i G_j)], dt = 2/omega. For a rod it is 0.836 l_min/c_d, where volume over largest
face gives the unstable value 1. At 0.99 of the bound a free body that vibrates in all its modes
must keep its energy. Then two piles of such plates collide."""
import numpy as np
from framework.meshes import box

NAME = "H1"
TITLE = "aspect ratio 16 to 64"
DECK = "h01_aspect_ratio.toml"
SECONDS = 10
SHAPES = {"cube": (1, 1, 1), "rod 16": (16, 1, 1), "rod 32": (32, 1, 1), "rod 64": (64, 1, 1), "plate 16": (16, 16, 1),
          "plate 32": (32, 32, 1), "plate 64": (64, 64, 1)}


def critical_step(shape, poisson=0.3):
    """dt c_d / l_min."""
    lam, mu = poisson / ((1 + poisson) * (1 - 2 * poisson)), 1 / (2 * (1 + poisson))
    root = np.sqrt(0.5) / np.array(shape)
    omega = np.sqrt(8 * np.linalg.eigvalsh((lam + 2 * mu * np.eye(3)) * np.outer(root, root)).max())
    return 2 / omega * np.sqrt(lam + 2 * mu) / min(shape)


def evaluate(lab):
    rows, steps, drifts = [], [], []
    # A random gradient excites all stretches and shears; on a box they do not excite hourglass
    # modes.
    gradient = 1e-4 * np.random.default_rng(1).normal(size=9)
    for name, shape in SHAPES.items():
        run = lab.run(name.replace(" ", "_"), {"initial.deformation[0].gradient": gradient},
                      mesh=box(shape, (1, 1, 1), name="body"))
        history = run.history
        exact = critical_step(shape)
        unit = np.sqrt(1.3 * 0.4 / 0.7)  # l_min/c_d; E = rho = 1
        computed = history["timestep"][0] / lab.deck["time"]["safety"] / unit
        steps.append(abs(computed / exact - 1))
        drifts.append(history["energy_error"][-1])
        rows.append([name, computed, exact, float(volume_over_face(shape)), history["energy_error"][-1],
                     history["kinetic_energy"].max() / history["total_energy"][1]])
    # Rounding, and the deformation of 1e-4, which changes the stiffness by as much.
    lab.check(max(steps), 0, 1e-3)
    # A change of the stiffness by 1e-4 changes the energy by the same share, once.
    lab.check(max(drifts), 0, 1e-3, "energy_at_0.99")
    lab.table("One element; dt c_d/l_min of the program, exact, and by volume over largest face; energy error and largest kinetic "
              "energy over the initial energy, after 5000 steps at 0.99 of the bound:",
              ["shape", "program", "exact", "V/A_max", "energy error", "largest kinetic energy"], rows)
    plates(lab)


def volume_over_face(shape):
    return np.prod(shape) / np.prod(sorted(shape)[1:])


def plates(lab):
    """Two piles of 3 plates, one element thick and 16 or 64 times as wide, collide with an
    offset."""
    rows = []
    for aspect in (16, 64):
        run = lab.run(f"piles_{aspect}", deck=lab.deck_path.with_name("h01_piles.toml"),
                      settings={"wall.brick": [2 * aspect * 0.1, 2 * aspect * 0.1, 0.1]})
        history = run.history
        rows.append([aspect, history["energy_error"][-1], history["momentum_error"][-1], history["contacts"].max(),
                     history["max_penetration"].max()])
    lab.check(max(row[1] for row in rows), 0, 2e-3, "energy_of_piles")
    lab.check(min(row[3] for row in rows) > 0, 1, 0, "piles_have_met")
    if max(row[1] for row in rows) > 2e-3:
        lab.weak_spot(f"an energy error of {max(row[1] for row in rows):.2g} in piles of "
                      "thin plates, whose light nodes slide over edges within a few steps")
    lab.table("Piles of plates, 2 x 2 x 1 elements each:", ["aspect of the plates", "energy error", "momentum error", "contacts",
                                                       "deepest / face"], rows)
