"""V1s: A smooth pressure pulse p sin^2(pi t/0.3) on the end of a bar (nu = 0, linear material, c =
1) travels through it unchanged: sigma_xx(x, t) = -p sin^2(pi (t - x)/0.3) where 0 < t - x < 0.3,
otherwise 0. Elements and central differences are of second order. The error is the root mean square
over that of the exact stress."""
import numpy as np
from framework.figures import EXACT, draw_slope

NAME = "V1s"
TITLE = "smooth wave in a bar"
DECK = "v01s_smooth_wave.toml"


def exact_stress(x, t, duration):
    """The stress over p."""
    phase = (t - x) / duration
    return np.where((phase > 0) & (phase < 1), -np.sin(np.pi * phase)**2, 0.0)


def evaluate(lab):
    pulse = lab.deck["load"]["pressure"][0]
    meshes = (50, 100, 200, 400)
    waves, errors = {}, []
    for n in meshes:
        results = lab.run(f"n{n}", {"wall.elements": [n, 1, 1]}).results
        x = results.centroids()[:, 0]
        sigma = results.element("stress_xx") / pulse["peak"]
        exact = exact_stress(x, results.times[-1], pulse["duration"])
        waves[n] = x, sigma
        errors.append(np.linalg.norm(sigma - exact) / np.linalg.norm(exact))

    # Two independent codes have 2.0e-2, 4.9e-3, 1.3e-3, 3.7e-4; a margin of a tenth.
    lab.check(errors[-1], 0, 1.1 * 3.7e-4)
    for n, error, threshold in zip(meshes, errors, (2.0e-2, 4.9e-3, 1.3e-3)):
        lab.check(error, 0, 1.1 * threshold, f"n{n}")
    lab.check_order([1 / n for n in meshes], errors, least=1.8, exact=2)
    with lab.figure("Stress at t = 0.5; error by element length", panels=2) as (stress, error):
        x = np.linspace(0, 1, 1000)
        stress.plot(x, exact_stress(x, 0.5, pulse["duration"]), label="exact", **EXACT)
        stress.plot(*waves[meshes[0]], ".", label=f"N = {meshes[0]}")
        stress.set(xlabel="x", ylabel="stress / p")
        sizes = [1 / n for n in meshes]
        error.loglog(sizes, errors, "o-", label="error")
        draw_slope(error, sizes, errors, 2)
        error.set(xlabel="h/L")
