"""V2c: Two bars (nu = 0) of unlike length or impedance collide at the default settings. By wave
theory the restitution is e = 1 (equal bars), 1/2 (lengths 1 and 2), 7/9 (impedances 1 and 2).
Elements disperse the front of the wave, which changes e by O(h^(2/3)) whatever the contact is: also
if both end nodes are one while they press (no compliance at all). Contact adds less than 1 % to the
error of such a rigid joint on the same mesh and step."""
import numpy as np
from _bars import histories
from v02b_unlike_bars import two_bars

NAME = "V2c"
TITLE = "restitution of unlike bars"
DECK = "v02b_unlike_bars.toml"
# length and modulus of the right bar, restitution; the left bar has 1 and 1
BARS = {"equal": (1.0, 1.0, 1.0), "lengths": (2.0, 1.0, 0.5), "impedances": (1.0, 4.0, 7 / 9)}
DEFAULT_PENALTY = 0.9
END = 5.0


def rigid_joint(n, length, modulus, dt):
    """Restitution of lumped bars with n elements per unit of travel time, central differences; the
    end nodes have one velocity while they press, which loses the energy of half an element."""
    speed = np.sqrt(modulus)
    counts, sizes = (n, round(n * length / speed)), (1.0, length)
    stiffness = np.concatenate([np.full(counts[0], counts[0]), [0], np.full(counts[1], modulus * counts[1] / length)])
    mass = np.concatenate([np.full(c + 1, size / c) for c, size in zip(counts, sizes)])
    left, right = counts[0], counts[0] + 1
    mass[[0, left, right, -1]] /= 2
    reduced = 1 / (1 / mass[left] + 1 / mass[right])
    velocity, displacement = np.where(np.arange(len(mass)) <= left, 1.0, 0.0), np.zeros(len(mass))
    for step in range(round(END / dt)):
        tension = stiffness * np.diff(displacement)
        acceleration = (np.append(tension, 0) - np.insert(tension, 0, 0)) / mass
        if displacement[left] > displacement[right] + 1e-12:
            approach = (velocity[left] - velocity[right]) / dt + acceleration[left] - acceleration[right]
            force = max(reduced * approach, 0)
            acceleration[left] -= force / mass[left]
            acceleration[right] += force / mass[right]
        velocity += dt * (0.5 if step == 0 else 1) * acceleration
        displacement += dt * velocity
    mean = [np.average(velocity[part], weights=mass[part]) for part in (slice(0, right), slice(right, None))]
    return mean[1] - mean[0]


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
            rigid = rigid_joint(n, length, modulus, dt) / exact - 1
            error = (right - left) / exact - 1
            last = history["time"][np.flatnonzero(history["contacts"] > 0)[-1]]
            lab.check(right - left, exact, abs(rigid) + 0.01, f"{name}_n{n}" if rows else "")
            lab.check(history["energy_error"].max(), 0, 1e-10, f"energy_{name}_n{n}")
            rows.append([name, n, dt * n, right - left, exact, error, rigid, last, 2 + dt])
    lab.table("Restitution e; its errors with the contact and with a rigid joint; last contact:",
              ["bars", "elements", "dt c/h", "e", "exact", "error", "rigid joint", "last contact", "exact + dt"], rows)
    largest = max(rows, key=lambda row: abs(row[5]))
    lab.weak_spot(f"the restitution of unlike bars errs by up to {100 * abs(largest[5]):.1f} % with {largest[1]} elements, mainly "
                  "since elements disperse the front of the wave and contact cannot pull: a joint without compliance errs by "
                  f"{100 * abs(largest[6]):.1f} % there")
