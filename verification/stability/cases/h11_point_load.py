"""H11: A clamped block of 12 x 12 x 8 elements is displaced at one node by a tenth of an element.
This is the worst load for one-point elements, which have twelve zero-energy modes. The share of the
hourglass energy is reported, and the fields are compared with those of elements of 2x2x2 points:
there must be no checkerboard, a displacement that alternates along the surface and does not decay
away from the load, and away from the load the shape of the dent must be the same."""
import numpy as np
from _hard import energy_change
from framework.meshes import box

NAME = "H11"
TITLE = "point load"
DECK = "h11_point_load.toml"
SECONDS = 20
SIZE = (12, 12, 8)


def pushed(lab, label, element, where):
    mesh = box(SIZE, SIZE, name="block")
    node = np.flatnonzero(np.all(mesh.nodes == where, axis=1))
    mesh.node_sets["pushed"] = node
    return lab.run(label, {"element.formulation": element}, mesh=mesh)


def top(run):
    """u_z of the top face [y][x]."""
    nodes = run.results.nodes
    order = np.lexsort((nodes[:, 0], nodes[:, 1]))
    order = order[nodes[order, 2] == SIZE[2]]
    return run.results.nodal("displacement_z")[order].reshape(SIZE[1] + 1, SIZE[0] + 1)


def checkerboard(surface):
    """The part that alternates from node to node along both directions [cell]: (u00 - u10 - u01 +
    u11)/4."""
    return (surface[:-1, :-1] - surface[1:, :-1] - surface[:-1, 1:] + surface[1:, 1:]) / 4


def evaluate(lab):
    rows, profiles = [], {}
    for name, where in {"middle": (6, 6, 8), "edge": (0, 6, 8), "corner": (0, 0, 8)}.items():
        runs = {element: pushed(lab, f"{name}_{element}", element, where) for element in ("one_point", "full")}
        surfaces = {element: top(run) for element, run in runs.items()}
        depth = abs(surfaces["one_point"][where[1], where[0]])
        share = runs["one_point"].history["hourglass_energy"][-1] / runs["one_point"].history["internal_energy"][-1]
        work = {element: run.history["internal_energy"][-1] for element, run in runs.items()}
        x, y = np.meshgrid(*[np.arange(n + 1) for n in SIZE[:2]])
        away = np.hypot(x - where[0], y - where[1]) >= 3
        far, reference = surfaces["one_point"][away], surfaces["full"][away]
        # The node moves by a tenth of an element under forces that differ; away from it the fields
        # differ by the ratio of these.
        force = (far @ reference) / (reference @ reference)
        shape = np.abs(far - force * reference).max() / np.abs(far).max()
        cells = np.hypot(x[:-1, :-1] + 0.5 - where[0], y[:-1, :-1] + 0.5 - where[1]) >= 3
        boards = {element: np.abs(checkerboard(surface))[cells].max() / depth for element, surface in surfaces.items()}
        rows.append([name, depth, share, work["one_point"] / work["full"] - 1, force, shape, boards["one_point"], boards["full"],
                     np.abs(energy_change(runs["one_point"].history)).max()])
        profiles[name] = (surfaces, where)
    lab.check(max(row[6] for row in rows), max(row[7] for row in rows), 5e-3, error=max(row[6] - row[7] for row in rows))
    # A load at one node has a width of h: at a distance of r = 3 h its field is determined to
    # (h/r)^2.
    lab.check(max(row[5] for row in rows), 0, 1 / 9, "shape_away_from_the_load")
    lab.check(max(row[8] for row in rows), 0, 1e-3, "energy")
    lab.check(max(row[2] for row in rows), 0, 0.5, "hourglass_share")
    lab.table("A node displaced by 0.1 elements, compared with elements of 2x2x2 points:",
              ["where", "depth / h", "hourglass share", "stored energy, difference", "displacements 3 elements and more away, ratio",
               "their shape, difference", "checkerboard there / depth", "the same, 2x2x2 points", "energy error"], rows)
    lab.weak_spot(f"at a point load up to {100 * max(row[2] for row in rows):.0f} % of the stored energy is in hourglass modes, and the "
                  f"block is more compliant: it stores {100 * max(abs(row[3]) for row in rows):.0f} % less energy than with 2x2x2 points")
    with lab.figure("Deflection of the top face along the line through the load") as axes:
        for name, (surfaces, where) in profiles.items():
            for element, line in (("one_point", "-"), ("full", ":")):
                axes.plot(surfaces[element][where[1]], line, label=f"{name}, {element}")
        axes.set(xlabel="x / h", ylabel="u_z / h")
