"""The gain of the path for congruent bricks: the same wall from a mesh file, unchanged and with an
inner node of each brick shifted by 1e-10 of an edge. The program takes the general path for the
latter, and the motion is the same to about that accuracy."""
import re

import netCDF4
import numpy as np
from brickwall_study.process import execute
from framework.exodus import Results
from framework.meshes import bodies
from framework.program import ProgramError
from walls import StruckWall, mesh_name

SHIFT = 1e-10


class MeshedWall(StruckWall):
    """The struck wall from a mesh file."""

    def __init__(self, name, bench, count, shift):
        self.name, self.count = name, count
        folder = bench.folder / name.replace(" ", "_")
        self.deck = folder / "wall.toml"
        write_mesh(bench.program, folder, count)
        shift_inner_nodes(folder / "wall.exo", shift * 0.2 / count)
        text = re.sub(r"\[wall\].*?\n\n", '[mesh]\nfile = "wall.exo"\n\n', StruckWall.deck.read_text(), flags=re.DOTALL)
        material = re.search(r"\[material.brick\].*?\n\n", text, flags=re.DOTALL).group()
        self.deck.write_text(text + "\n" + material.replace(".brick]", ".half_brick]"))

    def settings(self, mesh):
        return {"contact.self": "never"}

    def measure(self, bench):
        return bench.needed(self, mesh_name(self.count), mesh_name(self.count), {})


def write_mesh(program, folder, count):
    folder.mkdir(parents=True, exist_ok=True)
    command = [program.run_sh, "mesh", StruckWall.deck, "--program", program.binary, "-o", folder, "--set",
               f"wall.elements=[{count},{count // 2},{count // 2}]"]
    state, message, _ = execute([str(word) for word in command], folder / "mesh.txt", 600)
    if state != "ok":
        raise ProgramError(f"{folder.name}: {message}")


def shift_inner_nodes(path, distance):
    """Shifts the first interior node of each brick along x."""
    mesh = Results(path)
    mesh.file.close()
    inner = []
    for nodes in bodies(len(mesh.nodes), mesh.hexes):
        places = mesh.nodes[nodes]
        inside = ((places > places.min(axis=0) + 1e-6) & (places < places.max(axis=0) - 1e-6)).all(axis=1)
        inner.append(nodes[np.flatnonzero(inside)[0]])
    with netCDF4.Dataset(path, "r+") as file:
        x = file.variables["coordx"][:]
        x[inner] += distance
        file.variables["coordx"][:] = x


def compare(bench, count):
    """The general path relative to the congruent one: {"elements": ratio of the times of the
    elements' forces, "loop": that of the whole loop, "difference": that of the displacements, over
    their size}."""
    congruent, general = (MeshedWall(f"wall, {name}", bench, count, shift).measure(bench)
                          for name, shift in (("congruent", 0), ("general", SHIFT)))
    first, second = (np.array(record["observed"]["displacement"]) for record in (congruent, general))
    ratio = {name: cost(general) / cost(congruent) for name, cost in (
        ("elements", lambda record: record["phases"]["step::internal force"]),
        ("loop", lambda record: min(record["seconds"])))}
    return {**ratio, "difference": float(np.abs(first - second).max() / np.abs(first).max()),
            "steps": (congruent["element_steps"], general["element_steps"])}
