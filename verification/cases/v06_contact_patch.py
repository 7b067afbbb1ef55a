"""V6: The contact patch test: two unit cubes at rest, the lower one on rollers, the upper one under
a uniform pressure p. The exact stress is sigma_zz = -p everywhere, which matching meshes reproduce.
With 3:4 (6:8, 9:12) elements at the joint, node-to-face contact transfers the pressure at nodes, so
the stress next to the joint is not uniform; refinement does not help."""
import numpy as np
from framework.meshes import box, together

NAME = "V6"
TITLE = "contact patch test"
DECK = "v06_contact_patch.toml"


def two_cubes(lower, upper):
    return together(box((1, 1, 1), (lower,) * 3, name="lower"), box((1, 1, 1), (upper,) * 3, (0, 0, 1), "upper"))


def press(lab, lower, upper, settings=None):
    """(heights of the elements, errors of their stress over p, largest final speed over p/(rho
    c))."""
    results = lab.run(f"{lower}to{upper}{'_nu0' if settings else ''}", settings, mesh=two_cubes(lower, upper)).results
    pressure = lab.deck["load"]["pressure"][0]["peak"]
    return (results.centroids()[:, 2], results.element("stress_zz") / pressure + 1,
            np.abs(results.nodal("velocity")).max() / pressure)


def evaluate(lab):
    pairs = [(3, 3), (3, 4), (4, 3)] if lab.quick else [(6, 6), (3, 4), (6, 8), (9, 12), (4, 3), (8, 6)]
    pressed = {pair: press(lab, *pair) for pair in pairs}
    # With nu = 0 and row sums, whose ratio to the stiffness is the same at all nodes of a layer, the
    # motion is one-dimensional.
    straight = press(lab, *pairs[0], {"material.lower.poissons_ratio": 0.0, "material.upper.poissons_ratio": 0.0,
                                      "element.mass": "row_sum"})
    largest = {pair: np.abs(error).max() for pair, (_, error, _) in pressed.items()}
    root_mean_square = {pair: np.sqrt(np.mean(error**2)) for pair, (_, error, _) in pressed.items()}
    worst = max(largest[pair] for pair in pairs[1:])
    lab.check(worst, 0, 0.06)
    lab.check(np.abs(straight[1]).max(), 0, 1e-9, "matching_nu_0")  # the motion that remains after damping
    # While the blocks oscillate, contacts transfer between faces that differ by the strain p/E;
    # offsets of that order remain.
    lab.check(largest[pairs[0]], 0, lab.deck["load"]["pressure"][0]["peak"], "matching")
    lab.check(max(speed for _, _, speed in pressed.values()), 0, 1e-4, "at_rest")
    lab.table("Error of sigma_zz over p:", ["elements, lower : upper", "largest", "root mean square", "final speed"],
              [[f"{lower}:{upper}", largest[lower, upper], root_mean_square[lower, upper], speed]
               for (lower, upper), (_, _, speed) in pressed.items()])
    lab.weak_spot("node-to-face contact fails the contact patch test on non-matching meshes (Zavarise and De Lorenzis 2009): with "
                  f"3:4 elements the error of the stress next to the joint is up to {100 * worst:.1f} %, at any element size")
    with lab.figure("Error of sigma_zz in each element by height; the joint is at z = 1") as axes:
        for (lower, upper), (z, error, _) in pressed.items():
            axes.plot(z, error, ".", label=f"{lower}:{upper}", markersize=4)
        axes.set(xlabel="z", ylabel="sigma_zz / p + 1")
