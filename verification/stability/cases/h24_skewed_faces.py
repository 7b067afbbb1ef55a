"""H24: Under gravity small blocks stand all over a floor whose top is one face: a trapezoid, or a kite
as in meshes made from tetrahedra. Thin curved bricks of one element, whose upper and lower faces are
slender trapezoids, stand on each other. Every point of a face must be in contact. The energy of stacks
of straight bricks of one element that fall likewise errs by 0.12 (cubes) to 0.24 % (19af0d97, Zen 3)."""
import math

import numpy as np
from framework.meshes import box, together

NAME = "H24"
TITLE = "trapezoids, kites and thin curved bricks"
DECK = "h24_skewed_faces.toml"
SECONDS = 15
DROP = 1e-4  # height above the body below at the start
FLOORS = {  # corners, edge of the blocks
    "trapezoid 1:4": ([(0, 0), (4, 0), (2.5, 1), (1.5, 1)], 0.06),
    "trapezoid 1:2": ([(0, 0), (2, 0), (1.5, 1), (0.5, 1)], 0.06),
    "kite of a triangle 30-30-120": ([(0, 0), (0.866, 0), (0.866, 0.1667), (0.433, 0.25)], 0.02),
    "kite of a right triangle": ([(0, 0), (0.5, 0), (1 / 3, 1 / 3), (0, 0.5)], 0.02),
}
ARCS = {"bricks of 60 degrees, thickness 0.1 R": (60, 0.1), "bricks of 30 degrees, thickness 0.02 R": (30, 0.02)}


def bilinear(corners, xi, eta):
    weights = np.array([(1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta)]) / 4
    return weights.T @ np.array(corners, float)


def blocks_on_floor(corners, edge):
    low = box((1, 1, 0.5), (1, 1, 1), (0, 0, -0.5), "low").mapped(
        lambda x: np.column_stack([bilinear(corners, 2 * x[:, 0] - 1, 2 * x[:, 1] - 1), x[:, 2]]))
    places = []
    for xi in np.linspace(-0.9, 0.9, 7):
        for eta in np.linspace(-0.9, 0.9, 7):
            place = bilinear(corners, xi, eta)
            inner = min(np.cross(np.subtract(corners[(j + 1) % 4], corners[j]), place - corners[j])
                        / np.linalg.norm(np.subtract(corners[(j + 1) % 4], corners[j])) for j in range(4))
            if inner > edge and all(abs(place - other).max() > 1.5 * edge for other in places):
                places.append(place)
    blocks = [box((edge, edge, edge), (1, 1, 1), (*(place - edge / 2), DROP), "high") for place in places]
    mesh = together(low, *blocks)
    mesh.node_sets = {"base": np.arange(4)}
    return mesh, edge


def curved_bricks(degrees, thickness):
    def bend(x):  # sines of NumPy depend on the processor
        return np.array([[(1 + thickness * y) * math.cos(math.radians(-degrees * a)), (1 + thickness * y) * math.sin(math.radians(-degrees * a)), z]
                         for a, y, z in x])
    height = 0.2
    bricks = [box((1, 1, height), (1, 1, 1), (-0.5, -0.5, n * (height + DROP)), "high" if n else "low").mapped(bend)
              for n in range(4)]
    mesh = together(*bricks)
    mesh.node_sets = {"base": np.arange(8)}
    return mesh, height


def scenes(quick):
    all_scenes = {f"blocks on a {name}": lambda floor=floor: blocks_on_floor(*floor) for name, floor in FLOORS.items()}
    all_scenes |= {name: lambda arc=arc: curved_bricks(*arc) for name, arc in ARCS.items()}
    chosen = ("blocks on a trapezoid 1:4", "bricks of 60 degrees, thickness 0.1 R") if quick else all_scenes
    return {name: all_scenes[name] for name in chosen}


def evaluate(lab):
    rows = []
    for number, (name, scene) in enumerate(scenes(lab.quick).items()):
        mesh, length = scene()
        run = lab.run(f"scene{number}", {"time.end": 150 * length, "output.interval": 75 * length}, mesh=mesh)
        sunk = (-run.results.nodal("displacement_z", -1).min() - DROP) / length
        rows.append([name, len(mesh.hexes) - 1, sunk, np.abs(run.history["energy_error"]).max()])
    lab.check(max(row[2] for row in rows), 0, 0.02)
    lab.check(max(row[3] for row in rows), 0, 5e-3, "energy")
    lab.table("Depth by which a body sinks, in edges of a block or heights of a brick, and relative errors of the energy:",
              ["scene", "bodies that may move", "depth", "energy, largest"], rows)
