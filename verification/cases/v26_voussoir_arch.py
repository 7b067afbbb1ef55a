"""V26: A semicircular arch of voussoirs with radial joints that carry no tension and do not slide
stands under its weight if a line of thrust fits into its thickness t: above t/R = 0.1075 of the mean
radius R (Milankovitch 1907; Heyman 1969 has 0.106 with the weight on the mean radius). With few
voussoirs the line must fit at their joints only. For a symmetric arch this asks whether two unknowns,
the thrust at the crown and its moment, satisfy the linear inequalities of all joints. Below the least
thickness it falls, with hinges at the crown, the haunches and the springings."""
import itertools

import numpy as np
from framework.meshes import box, together

NAME = "V26"
TITLE = "voussoir arch"
DECK = "v26_voussoir_arch.toml"
SECONDS = 15
COUNT = 16  # voussoirs


def stands(thickness, count):
    """Whether a line of thrust fits."""
    at = np.pi / count * np.arange(count // 2 + 1)  # joints from the crown to the springing
    inner, outer = 1 - thickness / 2, 1 + thickness / 2
    weight, moment = (outer**2 - inner**2) / 2 * at, (outer**3 - inner**3) / 3 * (1 - np.cos(at))  # between crown and joint
    # Thrust H and its moment M about the centre: M - H y <= weight x - moment at the extrados, >= at
    # the intrados, with the point (x, y) of the joint.
    rows = np.concatenate([sign * np.column_stack([-r * np.cos(at), np.ones(len(at))]) for r, sign in ((outer, 1), (inner, -1))])
    bounds = np.concatenate([sign * (weight * r * np.sin(at) - moment) for r, sign in ((outer, 1), (inner, -1))])
    pairs = np.array(list(itertools.combinations(range(len(rows)), 2)))
    pairs = pairs[np.abs(np.linalg.det(rows[pairs])) > 1e-12]
    corners = np.linalg.solve(rows[pairs], bounds[pairs][..., None])[..., 0]
    return bool((corners @ rows.T <= bounds + 1e-12).all(axis=1).any())


def least_thickness(count):
    low, high = 0.05, 0.2
    while high - low > 1e-7:
        middle = (low + high) / 2
        low, high = (low, middle) if stands(middle, count) else (middle, high)
    return high


def arch(thickness):
    """Voussoirs between radial joints about the mean radius 1, on the ground z = 0."""
    angle, stones = np.pi / COUNT, []
    for k in range(COUNT):
        stone = box((angle, 0.1, thickness), (1, 1, 2), (k * angle, 0, 1 - thickness / 2), "voussoir", f"voussoir{k}")
        stones.append(stone.mapped(lambda x: np.stack([-x[:, 2] * np.cos(x[:, 0]), x[:, 1], x[:, 2] * np.sin(x[:, 0])], axis=1)))
    ground = box((2.6, 0.3, 0.1), (1, 1, 1), (-1.3, -0.1, -0.1), "ground")
    ground.node_sets = {"ground.all": np.arange(8)}
    return together(*stones, ground)


def evaluate(lab):
    least, curves = least_thickness(COUNT), {}
    for share in (1.07, 0.93):
        results = lab.run(f"share_{share}", mesh=arch(share * least)).results
        crown = np.argmax(results.nodes[:, 2])
        curves[share] = results.times, np.array([results.nodal("displacement_z", step)[crown] for step in range(len(results.times))])
    # The crown of a standing arch sinks by the elastic shortening under its sudden weight and springs
    # back: strains of some g R rho/E, on a thickness of a tenth of the radius.
    lab.check(np.abs(curves[1.07][1]).max() / least, 0, 0.05)
    lab.require(curves[0.93][1][-1] < -least, "falls")
    lab.check(least_thickness(100), 0.1075, 1e-3, "least_thickness")
    lab.note(f"The least thickness of {COUNT} voussoirs is {least:.5f}, of 100 {least_thickness(100):.5f}.")
    with lab.figure("Drop of the crown over the least thickness") as axes:
        for share, (times, drop) in curves.items():
            axes.plot(times, drop / least, label=f"{share} of the least thickness", linewidth=1)
        axes.set(xlabel="t c/R", ylabel="drop / t")
