"""V2c: Two bars (nu = 0) of unlike length or impedance collide at the default settings. By wave
theory the restitution is e = 1 (equal bars), 1/2 (lengths 1 and 2), 7/9 (impedances 1 and 2).
Elements disperse the front of the wave, which changes e by O(h^(2/3)) whatever the contact is: also
if both end nodes are one while they press (no compliance at all). Contact adds less than 1 % to the
error of such a rigid joint on the same mesh and step, and equal bars part no later than with it, but
for two steps. While the bars press, the force oscillates with
the frequency of the mode of the joint, eq. (43) of contact/theory.md. A model of lumped bars gives the restitution of
the program to 0.5 %, and the figures of other joints."""
import numpy as np
from _bars import histories
from _joints import END, Bars, Penalty, compare, rigid
from v02b_unlike_bars import two_bars

NAME = "V2c"
TITLE = "restitution of unlike bars"
DECK = "v02b_unlike_bars.toml"
# length and modulus of the right bar, restitution; the left bar has 1 and 1
BARS = {"equal": (1.0, 1.0, 1.0), "lengths": (2.0, 1.0, 0.5), "impedances": (1.0, 4.0, 7 / 9)}
DEFAULT_PENALTY = 0.9


def mode_of_joint(penalty, courant):
    """Frequency times the step of the mode at a joint of equal bars, eq. (43), by central differences."""
    ratio = penalty / (2 * courant**2)
    decay = np.sqrt(4 * ratio**2 + 1) - 2 * ratio  # 1/r - r = 4 ratio
    return 2 * np.arcsin(0.5 * courant * np.sqrt(2 + decay + 1 / decay))


def peak_of_spectrum(values):
    """The frequency, in radians a sample, with the largest share of the values' oscillation."""
    spectrum = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(len(values)), 64 * len(values)))
    return 2 * np.pi * np.argmax(spectrum) / (64 * len(values))


def check_mode(lab, n=80):
    run = lab.run(f"mode_n{n}", {"contact.penalty": DEFAULT_PENALTY, "time.end": 2.0, "output.interval": 1e-9},
                  mesh=two_bars(1.0, n, 1.0, n))
    bars = histories(run.results)
    pressed = bars.force[1][(bars.times > 0.5) & (bars.times < 1.7)]
    # The peak of a Hann window lies within a tenth of 2 pi/len(pressed).
    lab.check(peak_of_spectrum(pressed), mode_of_joint(DEFAULT_PENALTY, n * bars.times[1]), 0.01, "mode_of_joint")


def evaluate(lab):
    v = lab.deck["initial"]["velocity"][0]["velocity"][0]
    rows = []
    for name, (length, modulus, exact) in BARS.items():
        for n in (20, 40):
            run = lab.run(f"{name}_n{n}", {"material.right.youngs_modulus": modulus, "contact.penalty": DEFAULT_PENALTY,
                                           "time.end": END, "output.interval": END, "output.history_interval": 0.0},
                          mesh=two_bars(1.0, n, length, round(n * length / np.sqrt(modulus))))
            bars, history = histories(run.results), run.history
            left, right = bars.velocity[:, -1] / v
            dt = history["timestep"][1]
            of_rigid, times, forces, _ = Bars(n, length, modulus, n * dt).collide(rigid)
            rigid_error, rigid_last = of_rigid / exact - 1, times[forces > 0][-1]
            error = (right - left) / exact - 1
            last = history["time"][np.flatnonzero(history["contacts"] > 0)[-1]]
            lab.check(right - left, exact, abs(rigid_error) + 0.01, f"{name}_n{n}" if rows else "")
            model = Bars(n, length, modulus, n * dt).collide(Penalty(DEFAULT_PENALTY))[0]
            lab.check(model, right - left, 0.005 * exact, f"model_{name}_n{n}")
            lab.check(history["energy_error"].max(), 0, 1e-10, f"energy_{name}_n{n}")
            if name == "equal":  # its oscillation ends the contact some steps sooner or later
                lab.check(last, 2.0, (abs(rigid_last - 2) + 2 * dt) / 2, f"time_n{n}")
            rows.append([name, n, dt * n, right - left, exact, error, rigid_error, last, rigid_last if name == "equal" else "", 2 + dt])
    check_mode(lab)
    lab.table("Restitution e; its errors with the contact and with a rigid joint; last contact, and that of a rigid joint:",
              ["bars", "elements", "dt c/h", "e", "exact", "error", "rigid joint", "last contact", "rigid joint", "exact + dt"], rows)
    if not lab.quick:
        lab.table("Errors with other joints in %, by a model of lumped bars, N = 20 / 40 / 80 (contact/theory.md, section 7):", *compare(BARS))
    largest = max(rows, key=lambda row: abs(row[5]))
    lab.weak_spot(f"the restitution of unlike bars errs by up to {100 * abs(largest[5]):.1f} % with {largest[1]} elements, mainly "
                  "since elements disperse the front of the wave and contact cannot pull: a joint without compliance errs by "
                  f"{100 * abs(largest[6]):.1f} % there")
