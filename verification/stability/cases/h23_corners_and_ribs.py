"""H23: Under gravity a wedge stands in a groove, a pyramid in a pit and a block in the corner of a
floor and a wall; a plank of one element lies on two ribs, and across a rib narrower than its element.
The lower body is one. A node must be held by all faces of a re-entrant corner, an edge by all edges
that it crosses."""
import numpy as np
from framework.meshes import Mesh, box, together

NAME = "H23"
TITLE = "re-entrant corners and narrow ribs"
DECK = "h23_corners_and_ribs.toml"
SECONDS = 15
SLOPES = (2.0, 1.0, 0.5, 0.3, 0.1, 0.05)
EDGE = 0.25
DROP = 1e-3  # height above the lower body at the start


def part_of(mesh, keeps):
    """The elements of a mesh of one block whose centres c satisfy keeps(c)."""
    hexes = mesh.hexes[keeps(mesh.nodes[mesh.hexes].mean(axis=1))]
    used, places = np.unique(hexes, return_inverse=True)
    return Mesh(mesh.nodes[used], places.reshape(hexes.shape), {name: len(hexes) for name in mesh.blocks})


def pair(low, high, base):
    mesh = together(low, high)
    fixed = np.flatnonzero(base(low.nodes))
    mesh.node_sets = {"base": fixed, "guide": fixed, "high": len(low.nodes) + np.arange(len(high.nodes))}
    return mesh


def wedge_in_groove(slope):
    """Flanks of the groove z = slope |x|, on which a wedge of slope + 1 stands by its edge."""
    low = box((2, 1, 0.5), (8, 3, 2), (-1, -0.5, -0.5), "low").mapped(lambda x: x + np.outer(slope * abs(x[:, 0]), [0, 0, 1]))
    height = 0.8
    high = box((0.5, 0.4, height), (2, 2, 4), (-0.25, -0.2, 0), "high").mapped(
        lambda x: x + np.outer((slope + 1) * abs(x[:, 0]) * (1 - x[:, 2] / height) + DROP, [0, 0, 1]))
    mesh = pair(low, high, lambda x: np.isclose(x[:, 2] - slope * abs(x[:, 0]), -0.5))
    mesh.node_sets["guide"] = mesh.node_sets["high"][np.isclose(high.nodes[:, 2], height + DROP)]
    return mesh, {}, np.isclose(high.nodes[:, 0], 0) & (high.nodes[:, 2] < 2 * DROP)


def pyramid_in_pit(slope):
    """Four flanks of the pit z = slope (|x| + |y|), in whose deepest point a pyramid of slope + 1 stands by its tip."""
    def distance(x):
        return abs(x[:, 0]) + abs(x[:, 1])
    low = box((2, 2, 0.5), (8, 8, 2), (-1, -1, -0.5), "low").mapped(lambda x: x + np.outer(slope * distance(x), [0, 0, 1]))
    height = 1.2
    high = box((0.3, 0.3, height), (2, 2, 4), (-0.15, -0.15, 0), "high").mapped(
        lambda x: x + np.outer((slope + 1) * distance(x) * (1 - x[:, 2] / height) + DROP, [0, 0, 1]))
    mesh = pair(low, high, lambda x: np.isclose(x[:, 2] - slope * distance(x), -0.5))
    mesh.node_sets["guide"] = mesh.node_sets["high"][np.isclose(high.nodes[:, 2], height + DROP)]
    return mesh, {}, np.isclose(distance(high.nodes), 0) & (high.nodes[:, 2] < 2 * DROP)


def block_in_corner(elements):
    low = part_of(box((1.5, 1, 1.5), (6, 4, 6), (-0.5, 0, -0.5), "low"), lambda c: (c[:, 0] < 0) | (c[:, 2] < 0))
    high = box((0.8, 0.6, 0.8), elements, (DROP, 0.2, DROP), "high")
    mesh = pair(low, high, lambda x: np.isclose(x[:, 2], -0.5) | np.isclose(x[:, 0], -0.5))
    return mesh, {"gravity.acceleration": (-2e-4, 0, -2e-4)}, np.isclose(high.nodes[:, 2], DROP)


def plank_on_ribs(places, width):
    """One element of length 1 across ribs along y at these x."""
    columns = np.unique(np.concatenate([[-0.75, 0.75], *[[x - width / 2, x + width / 2] for x in places]]))
    whole = box((1, 1.2, 0.6), (len(columns) - 1, 3, 2), (0, -0.6, -0.6), "low").mapped(
        lambda x: np.column_stack([columns[np.round(x[:, 0] * (len(columns) - 1)).astype(int)], x[:, 1], x[:, 2]]))
    low = part_of(whole, lambda c: (c[:, 2] < -0.3) | (abs(c[:, :1] - np.array(places)).min(axis=1) < width / 2))
    high = box((1, 0.3, 0.1), (1, 1, 1), (-0.5, -0.15, DROP), "high")
    return pair(low, high, lambda x: np.isclose(x[:, 2], -0.6)), {}, np.ones(len(high.nodes), bool)


def scenes(quick):
    all_scenes = {f"wedge, slope {slope}": lambda slope=slope: wedge_in_groove(slope) for slope in SLOPES}
    all_scenes |= {f"pyramid in a pit, slope {slope}": lambda slope=slope: pyramid_in_pit(slope) for slope in (2.0, 1.0)}
    all_scenes["block in a corner"] = lambda: block_in_corner((4, 3, 4))
    all_scenes["block of other elements"] = lambda: block_in_corner((3, 2, 3))
    all_scenes["plank on two ribs"] = lambda: plank_on_ribs((-0.3, 0.3), 0.1)
    all_scenes["plank across one rib"] = lambda: plank_on_ribs((0.0,), 0.15)
    chosen = ("wedge, slope 0.3", "block in a corner", "plank across one rib") if quick else all_scenes
    return {name: all_scenes[name] for name in chosen}


def evaluate(lab):
    rows = []
    for number, (name, scene) in enumerate(scenes(lab.quick).items()):
        mesh, settings, lowest = scene()
        run = lab.run(f"scene{number}", settings, mesh=mesh)
        moved = np.stack([run.results.nodal(f"displacement_{axis}", -1) for axis in "xyz"], axis=1)
        sunk = (-moved[mesh.node_sets["high"]][lowest] - DROP).max() / EDGE
        rows.append([name, sunk, np.abs(run.history["energy_error"]).max(), int(run.history["contacts"][-1])])
    lab.check(max(row[1] for row in rows), 0, 0.01)
    lab.check(max(row[2] for row in rows), 0, 1e-3, "energy")
    lab.table("Depth by which the upper body sinks, in edges of 0.25, and relative errors of the energy:",
              ["scene", "depth", "energy, largest", "contacts at the end"], rows)
