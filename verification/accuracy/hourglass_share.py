#!/usr/bin/python3
"""The hourglass share of the default wall beside that of finer solutions on the same mesh:
`/usr/bin/python3 verification/accuracy/hourglass_share.py [--fine N]` (1 minute; 6 with --fine 32).

The default wall runs with 4, 8, ... N elements along a brick (16) until 1.5 ms. The displacements of
each finer run at the nodes of a coarser mesh are a nearly exact solution on that mesh; the elements'
energy of the mean gradient and that of the hourglass modes, equations (10) and (11) of
mechanics/theory.md, give the share that it has there. Beside it, the part of the finer run's energy
that the variation of the strain within each coarse element holds, from averages over its elements.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE.parent), str(ROOT / "miniapp/plot"), str(ROOT / "miniapp/study")]
from framework.exodus import HEX_CORNERS
from framework.meshes import bodies
from framework.program import Program

DECK = ROOT / "inputs/brick_wall.toml"
YOUNGS, NU = 20e9, 0.2  # of the deck
SIGN = 2.0 * HEX_CORNERS - 1


def material_energy(gradient):
    """Neo-Hookean energy of each element's gradient, per volume."""
    lame, mu = YOUNGS * NU / ((1 + NU) * (1 - 2 * NU)), YOUNGS / (2 * (1 + NU))
    log = np.log(np.linalg.det(np.eye(3) + gradient))
    stretch = 2 * np.einsum("eii->e", gradient) + np.einsum("eij,eij->e", gradient, gradient)
    return mu / 2 * stretch - mu * log + lame / 2 * log**2


def hourglass_energy(displacement, gradient, edges):
    """Of boxes along the axes, per volume, by equation (11)."""
    xi, eta, zeta = SIGN.T
    q1, q2, q3, q4 = (np.einsum("eij,ei->ej", np.eye(3) + gradient, np.einsum("c,eci->ei", mode, displacement) / 8) / (edges / 2)
                      for mode in (eta * zeta, zeta * xi, xi * eta, xi * eta * zeta))
    bending = sum(p**2 + r**2 + 2 * NU * p * r
                  for p, r in ((q3[:, 0], q1[:, 2]), (q2[:, 0], q1[:, 1]), (q3[:, 1], q2[:, 2])))
    torsion = (q1[:, 0] + q2[:, 1])**2 + (q2[:, 1] + q3[:, 2])**2 + (q3[:, 2] + q1[:, 0])**2
    return YOUNGS / (6 * (1 - NU**2)) * bending + YOUNGS / (12 * (1 + NU)) * torsion + YOUNGS / 18 * (q4**2).sum(axis=1)


class Lattice:
    """The elements of a run's bricks by place, and those of meshes coarser by a factor."""

    def __init__(self, results):
        self.nodes, self.hexes = results.nodes, results.hexes
        self.edges = np.ptp(self.nodes[self.hexes[0]], axis=0)
        body, origin = np.empty(len(self.nodes), int), np.empty((len(self.nodes), 3))
        for number, members in enumerate(bodies(len(self.nodes), self.hexes)):
            body[members], origin[members] = number, self.nodes[members].min(axis=0)
        self.body = body
        self.place = np.rint((self.nodes - origin) / self.edges).astype(int)

    def code(self, body, place):
        return np.ravel_multi_index((body, *np.moveaxis(place, -1, 0)), (self.body.max() + 1, *(self.place.max(axis=0) + 1)))

    def coarse(self, factor):
        """(nodes of the coarse elements [coarse][corner], the coarse element of each element)."""
        first = self.hexes[:, np.argmin(HEX_CORNERS.sum(axis=1))]
        whole = self.code(self.body[first], self.place[first] // factor * factor)
        corners, group = np.unique(whole, return_inverse=True)
        codes = self.code(self.body, self.place)
        order = np.argsort(codes)
        low = order[np.searchsorted(codes[order], corners)]
        wanted = self.code(self.body[low][:, None], self.place[low][:, None] + factor * HEX_CORNERS)
        return order[np.searchsorted(codes[order], wanted)], group


def shares(results, factor):
    """(hourglass share on the coarse mesh, part of the strain's variation), peak over peak."""
    lattice = Lattice(results)
    elements, group = lattice.coarse(factor)
    edges, volume = factor * lattice.edges, factor**3 * lattice.edges.prod()
    slopes = SIGN / 4  # of the shape functions' mean, times the edges
    energies = []
    for step in range(1, len(results.times)):
        displacement = results.nodal("displacement", step)
        sampled = displacement[elements]
        gradient = np.einsum("eci,cj->eij", sampled, slopes / edges)
        fine = np.einsum("eci,cj->eij", displacement[lattice.hexes], slopes / lattice.edges)
        mean = np.zeros_like(gradient)
        np.add.at(mean, group, fine / factor**3)
        hourglass = volume * hourglass_energy(sampled, gradient, edges).sum()
        energies.append([hourglass, volume * material_energy(gradient).sum() + hourglass, results.element("strain_energy", step).sum(),
                         volume * material_energy(mean).sum()])
    hourglass, total, exact, of_means = np.array(energies).T
    return hourglass.max() / total.max(), (exact - of_means).max() / exact.max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fine", type=int, default=16, choices=(8, 16, 32), help="elements along a brick of the finest mesh")
    parser.add_argument("--program", type=Path, default=ROOT / "build/miniapp/brickwall")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "out/hourglass_share")
    arguments = parser.parse_args()
    program = Program(ROOT / "run.sh", arguments.program)
    meshes = [n for n in (4, 8, 16, 32) if n <= arguments.fine]
    runs = {n: program.run(DECK, arguments.output / str(n), {"wall.elements": [n, n // 2, n // 2], "time.end": 1.5e-3, "output.interval": 1e-4,
                                                             "output.history_interval": 1e-5, "output.fields": ["displacement", "strain_energy"]})
            for n in meshes}
    print("| elements along a brick | share of the run | on its mesh: " + " | ".join(f"run with {n}" for n in meshes[1:]) + " |")
    print("|---|---|" + "---|" * (len(meshes) - 1))
    for n in meshes[:-1]:
        finer = [shares(runs[fine].results, fine // n) if fine > n else None for fine in meshes[1:]]
        history = runs[n].history
        print(f"| {n} | {100 * history['hourglass_energy'].max() / history['internal_energy'].max():.1f} % | "
              + " | ".join(f"{100 * pair[0]:.1f} % (all variation {100 * pair[1]:.1f} %)" if pair else "" for pair in finer) + " |")


if __name__ == "__main__":
    main()
