"""V20: One square element with nu = 0, stretched by l = 1.3 in its plane, spins: a spring that turns.
Its displacements stay affine and its four corners have all mass, so that l'' = h^2/l^3 - k (l^2 - 1)
l/2 with h = l^2 theta' and k = 4 E/(rho a^2) for St. Venant-Kirchhoff material: a pseudo-rigid body
(Cohen and Muncaster 1988). In s = l^2 it reads s'^2 = k (s - s1) (s - s2) (s3 - s), and the period
of s and the rotation in it are elliptic integrals. Central differences conserve the angular
momentum to rounding, the energy in the mean, and give period and rotation with an error of second
order in the step. It tests non-linear behaviour, as one of the benchmarks of Di Stasio, Dureisseix,
Gravouil, Georges and Homolle (Adv. Model. Simul. Eng. Sci. 6:2, 2019) does; it is in their spirit and
has this code's own definition."""
import numpy as np
from framework.figures import EXACT, draw_slope
from framework.meshes import box

NAME = "V20"
TITLE = "spinning square of one element"
DECK = "v20_spinning_square.toml"


def period_and_rotation(stretch, spin, stiffness=4.0):
    """The period of the stretch and the rotation in it, for the initial velocity spin x X."""
    h, s0 = spin * stretch, stretch**2
    energy = h**2 / (2 * s0) + stiffness / 8 * (s0 - 1)**2
    low, middle, high = np.sort(np.roots([-stiffness, 2 * stiffness, 8 * energy - stiffness, -4 * h**2]).real)
    phase = np.pi * (np.arange(200) + 0.5) / 200  # Gauss-Chebyshev quadrature
    s = (high + middle) / 2 + (high - middle) / 2 * np.cos(phase)
    dt = 2 * np.pi / 200 / np.sqrt(stiffness * (s - low))
    return dt.sum(), (h / s * dt).sum()


def motion(run):
    """Times, l^2 and angle by step."""
    results = run.results
    corner = np.argmax(results.nodes.sum(axis=1))
    place = np.array([results.nodes[corner] + results.nodal("displacement", step)[corner] for step in range(len(results.times))])
    return results.times, 2 * (place[:, 0]**2 + place[:, 1]**2), np.unwrap(np.arctan2(place[:, 1], place[:, 0]))


def evaluate(lab):
    stretch = 1 + lab.deck["initial"]["deformation"][0]["gradient"][0]
    spin = lab.deck["initial"]["velocity"][0]["angular_velocity"][2]
    period, rotation = period_and_rotation(stretch, spin)
    rows = []
    for safety in (0.2, 0.1, 0.05):
        run = lab.run(f"safety_{safety}", {"time.safety": safety}, mesh=box((1, 1, 1), (1, 1, 1), (-0.5, -0.5, -0.5)))
        times, s, angle = motion(run)
        level = (s.max() + s.min()) / 2
        before = np.flatnonzero((s[:-1] < level) & (s[1:] >= level))
        passed = times[before] + (level - s[before]) / (s[before + 1] - s[before]) * times[1]
        turns = len(passed) - 1
        computed = np.ptp(passed) / turns, np.ptp(np.interp(passed, times, angle)) / turns
        momentum = run.vector("angular_momentum")[:, 2]
        energy = run.history["total_energy"][1:]
        rows.append([times[1], turns, computed[0] / period - 1, computed[1] / rotation - 1, np.abs(momentum / momentum[0] - 1).max(),
                     np.ptp(energy) / energy[0]])
    steps = [row[0] for row in rows]
    for column, name in ((2, "period"), (3, "rotation")):
        errors = [abs(row[column]) for row in rows]
        # Harmonic oscillation at w has the period 2 pi/w (1 - (w dt)^2/24); here it is faster where
        # it is stretched.
        lab.check(1 + rows[-1][column], 1, (2 * np.pi / period * steps[-1])**2 / 24, name if column > 2 else "")
        lab.check_order(steps, errors, least=1.9, exact=2, name=f"order_of_{name}")
    lab.check_order(steps, [row[5] for row in rows], least=1.9, exact=2, name="order_of_energy")
    # Torques are rounded to 2^-55 in each step (V13).
    lab.check(max(row[4] for row in rows), 0, 1e-13, "angular_momentum")
    lab.table(f"Mean period (exact {period:.6f}) and rotation in it (exact {rotation:.6f}):",
              ["dt", "periods", "error of the period", "error of the rotation", "angular momentum", "energy, largest less least"], rows)
    with lab.figure("Square of the stretch; errors by step", panels=2) as (by_time, error):
        by_time.plot(times[times < 4 * period], s[times < 4 * period], label=f"dt = {steps[-1]:.3f}", linewidth=1)
        for k in range(1, 5):
            by_time.axvline(k * period, label="exact period" if k == 1 else None, **EXACT)
        by_time.set(xlabel="t c/a", ylabel="l^2")
        error.loglog(steps, [abs(row[2]) for row in rows], "o-", label="period")
        error.loglog(steps, [abs(row[3]) for row in rows], "o-", label="rotation")
        draw_slope(error, steps, [abs(row[2]) for row in rows], 2)
        error.set(xlabel="dt c/a")
