"""V25: A block of width b and height h leans by theta0 on one edge and is let go (Housner 1963). With
tan(alpha) = b/h, 2 R the diagonal and p^2 = 3 g/(4 R), it follows theta'' = -p^2 sin(alpha - theta) and
reaches the vertical after acosh(1/(1 - theta0/alpha))/p, for small alpha. There the other edge B hits
the plane. All impulse acts at B, as the first edge lifts, so that the angular momentum about B stays:
it is 1 - 3/2 sin^2(alpha) of that of the block turning with the same velocity about B. If B does not
rebound, the energy falls to the square of it, the least energy with this angular momentum. Elastic
bodies rebound and keep more energy, also with damped contacts. A base that touches with its whole
face takes impulse between the edges, and keeps more angular momentum (Ther and Kollar 2017); here the
plane supports the edges only."""
import numpy as np
from framework.meshes import box, rotation, together
from v24_tipping_block import motion

NAME = "V25"
TITLE = "rocking block"
DECK = "v25_rocking_block.toml"
WIDTH = 1 / 3  # over the height
ALPHA, RADIUS = np.arctan(WIDTH), np.hypot(WIDTH, 1) / 2
SPIN = 1e-5  # at the impact without gravity


def scene(lean, whole=False):
    """A block of height 1 that leans by `lean` on its edge A at x = 0, on planes below both edges."""
    block = box((WIDTH, 0.25, 1), (4, 1, 8)).mapped(lambda x: x @ rotation((0, 1, 0), -lean).T)
    parts = [(-1, 1.5)] if whole else [(-1, WIDTH / 8), (7 / 8 * WIDTH, 1.5)]
    planes = [box((b - a, 0.75, 0.25), (1, 1, 1), (a, -0.25, -0.25), "plane", f"plane{a}") for a, b in parts]
    mesh = together(block, *planes)
    mesh.node_sets["plane.all"] = np.arange(len(block.nodes), len(mesh.nodes))
    return mesh


def quarter_period(p, start):
    """The time from the angle `start` at rest to the vertical, by Gauss quadrature in theta = start (1 - x^2)."""
    x, weights = np.polynomial.legendre.leggauss(40)
    x, weights = (x + 1) / 2, weights / 2
    energy = np.cos(ALPHA - start) - np.cos(ALPHA - start * (1 - x**2))
    return weights @ (2 * start * x / np.sqrt(2 * energy)) / p


def fall(lab, start, p):
    """[linear, exact, computed time to the vertical]."""
    exact = quarter_period(p, start)
    times, angle, _ = motion(lab.run(f"fall_{start / ALPHA:.1f}", {"time.end": 1.02 * exact}, mesh=scene(start)))
    lean = start - angle
    after = np.flatnonzero(lean < 0)[0]
    upright = times[after] - lean[after] / (lean[after] - lean[after - 1]) * (times[after] - times[after - 1])
    return [np.arccosh(1 / (1 - start / ALPHA)) / p, exact, upright]


def impact(lab, label, settings, whole=False):
    """[angular momentum about B, kinetic energy, after over before, of a block that turns about A]."""
    settings = {"gravity.acceleration": [0, 0, 0], "time.end": 100.0, "initial.velocity[0].angular_velocity": [0, SPIN, 0], **settings}
    history = lab.run(label, settings, mesh=scene(1e-9, whole)).history
    about_b = history["angular_momentum_y"] + WIDTH * history["momentum_z"]
    # Relative to the angular momentum I_A SPIN about A.
    return [about_b[-1] / history["angular_momentum_y"][0], history["kinetic_energy"][-1] / history["kinetic_energy"][0]]


def evaluate(lab):
    gravity = -lab.deck["gravity"]["acceleration"][2]
    p = np.sqrt(3 * gravity / (4 * RADIUS))
    falls = {share: fall(lab, share * ALPHA, p) for share in ((0.5,) if lab.quick else (0.5, 0.3, 0.8))}
    for share, (_, exact, computed) in falls.items():
        # The sudden weight is carried in the mean over a vibration on the edge. Its period of about 10
        # is a hundredth of the fall: an error of the square of that, with a margin of 5.
        lab.check(computed, exact, 5e-4, f"fall_{share}" if share != 0.5 else "")
    lab.table("Time from theta0 at rest to the vertical:", ["theta0 / alpha", "Housner, small alpha", "exact", "computed", "error"],
              [[share, *row, row[2] / row[1] - 1] for share, row in falls.items()])
    impacts = {"default": impact(lab, "default", {}),
               "penalty 0.1, damping 0.5": impact(lab, "damped", {"contact.penalty": 0.1, "contact.damping": 0.5}),
               "penalty 0.01, damping 3": impact(lab, "soft", {"contact.penalty": 0.01, "contact.damping": 3.0}),
               "default, whole base": impact(lab, "whole", {}, whole=True)}
    kept = 1 - 1.5 * np.sin(ALPHA)**2
    for name, (momentum, energy) in impacts.items():
        if "whole" not in name:
            # The first edge lifts only when the wave from B has reached it, and takes a little.
            lab.check(momentum, kept, 2e-3, "angular_momentum_" + name.replace(",", "").replace(" ", "_"))
            lab.require(energy > kept**2, "energy_above_the_least_" + name.replace(",", "").replace(" ", "_"))
    lab.table(f"At the impact without gravity: angular momentum about B over that before about A, rigid {kept}; kinetic energy over "
              f"that before, {kept**2:.4f} without rebound:", ["contact", "angular momentum", "energy"],
              [[name, *row] for name, row in impacts.items()])
    lab.weak_spot(f"an elastic block rebounds where Housner's rocks on: it keeps {impacts['default'][1]:.2f} of its energy at the impact, his "
                  f"{kept**2:.2f}; contact.damping acts on nodes, not on the whole block")
