#!/usr/bin/python3
"""Frequencies of the one-point element of this code beside those of other elements on meshes of
boxes, by dense eigenvalue solutions: `/usr/bin/python3 verification/accuracy/other_elements.py` (20 s). A second
table separates the error of the cantilever's mass from that of its stiffness, a third one those of the
free brick.

H8MSGSO is Krysl's mean-strain eight-node hexahedron with optimized energy-sampling stabilization
(2015, 2016), with the constants of its author's program FinEtools (FEMMDeforLinearMSH8):
K = K_1(C) + phi (K_8(C') - K_1(C')), with one and eight points, C' the moduli at Poisson's ratio nu
for nu < 0.3, otherwise 0.3 + (nu - 0.3)/2, phi = f/(1 + f), f = 2 (1 + nu') (shortest/longest edge)^2.
"""
import sys
from itertools import product
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "cases"), str(HERE.parents[1] / "miniapp/study")]
from framework.meshes import box, lumped_masses, nodal_masses
from v07_cantilever import CONVERGED
from v22_free_brick import COUNT, SIZE, Ritz

CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])


def moduli(poisson):
    """[6][6] at Young's modulus 1, for the engineering strains of strains()."""
    lame, mu = poisson / ((1 + poisson) * (1 - 2 * poisson)), 1 / (2 * (1 + poisson))
    C = np.diag([2 * mu] * 3 + [mu] * 3)
    C[:3, :3] += lame
    return C


def strains(xi, half):
    """[6][24] at the point xi of a box with these half-edges."""
    factors = 1 + CORNERS * xi
    slopes = np.stack([CORNERS[:, i] * np.delete(factors, i, axis=1).prod(axis=1) for i in range(3)], axis=1) / 8 / half
    B = np.zeros((6, 8, 3))
    for i in range(3):
        B[i, :, i] = slopes[:, i]
    for row, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        B[3 + row, :, i], B[3 + row, :, j] = slopes[:, j], slopes[:, i]
    return B.reshape(6, 24)


def integrated(C, half, points):
    root = 0 if points == 1 else 1 / np.sqrt(3)
    places = [np.zeros(3)] if points == 1 else [root * np.array(p) for p in product((-1, 1), repeat=3)]
    B = [strains(place, half) for place in places]
    return 8 * half.prod() / len(B) * sum(b.T @ C @ b for b in B)


def full(half, nu):
    return integrated(moduli(nu), half, 8)


def h8msgso(half, nu):
    other = nu if nu < 0.3 else 0.3 + (nu - 0.3) / 2
    f = 2 * (1 + other) * (half.min() / half.max())**2
    C = moduli(other)
    return integrated(moduli(nu), half, 1) + f / (1 + f) * (integrated(C, half, 8) - integrated(C, half, 1))


def one_point(half, nu):
    """mechanics/theory.md: bending pairs, torsion and the fourth mode of the hourglass energy."""
    volume, (x, y, z) = 8 * half.prod(), CORNERS.T
    patterns = np.stack([y * z, z * x, x * y, x * y * z]) / 8

    def q(mode, axis):
        row = np.zeros((8, 3))
        row[:, axis] = patterns[mode] / half[axis]
        return row.ravel()

    K = integrated(moduli(nu), half, 1)
    for p, r in ((q(2, 0), q(0, 2)), (q(1, 0), q(0, 1)), (q(2, 1), q(1, 2))):
        K += volume / (3 * (1 - nu**2)) * (np.outer(p, p) + np.outer(r, r) + nu * (np.outer(p, r) + np.outer(r, p)))
    for mode, other, (i, j) in ((0, 1, (0, 1)), (1, 2, (1, 2)), (2, 0, (2, 0))):
        t = half[i] * q(mode, i) / half[j] + half[j] * q(other, j) / half[i]
        K += volume / (6 * (1 + nu)) * np.outer(t, t)
    return K + volume / 9 * sum(np.outer(q(3, i), q(3, i)) for i in range(3))


def scaled_stiffness(element, mesh, masses, fixed=()):
    """M^(-1/2) K M^(-1/2) with these nodes fixed."""
    corners = mesh.nodes[mesh.hexes]
    half = (corners[0].max(axis=0) - corners[0].min(axis=0)) / 2
    places = np.sign(corners[0] - corners[0].mean(axis=0))
    assert (places == CORNERS).all()
    stiffness, K = element(half, 0.3), np.zeros((3 * len(mesh.nodes),) * 2)
    for nodes in mesh.hexes:
        numbers = (3 * nodes[:, None] + np.arange(3)).ravel()
        K[np.ix_(numbers, numbers)] += stiffness
    free = np.repeat(~np.isin(np.arange(len(mesh.nodes)), fixed), 3)
    root = np.sqrt(np.repeat(masses, 3)[free])
    return K[np.ix_(free, free)] / np.outer(root, root)


def frequencies(element, mesh, masses, fixed=()):
    """All angular frequencies, in order, with these nodes fixed."""
    return np.sqrt(np.maximum(np.linalg.eigvalsh(scaled_stiffness(element, mesh, masses, fixed)), 0))


def brick_errors(ritz, mesh, masses):
    """[2][mode]: the errors of the free brick's frequencies, each of the mode most like that of the
    reference, and their part by the nodal masses alone: minus half the error of the kinetic energy of
    the reference's mode."""
    square, shapes = np.linalg.eigh(scaled_stiffness(one_point, mesh, masses))
    errors = np.empty((2, COUNT))
    for k, omega in enumerate(ritz.omega):
        mode = np.sqrt(np.repeat(masses, 3)) * ritz.mode(k, mesh.nodes).ravel()
        found = 6 + np.argmax(np.abs(mode @ shapes[:, 6:]))
        errors[:, k] = np.sqrt(square[found]) / omega - 1, -0.5 * (mode @ mode / np.prod(SIZE / 2) - 1)
    return errors


def share_of_mass(mesh, masses, length=10):
    """The error of the cantilever's first frequency by its nodal masses alone: minus half the error of
    the kinetic energy of the beam's mode, w along z and -(z - 1/2) w' along x."""
    k = 1.8751040687 / length
    ratio = (np.cosh(k * length) + np.cos(k * length)) / (np.sinh(k * length) + np.sin(k * length))

    def energy(x, z_squared):
        w = np.cosh(k * x) - np.cos(k * x) - ratio * (np.sinh(k * x) - np.sin(k * x))
        slope = k * (np.sinh(k * x) + np.sin(k * x) - ratio * (np.cosh(k * x) - np.cos(k * x)))
        return w**2 + z_squared * slope**2

    points, weights = np.polynomial.legendre.leggauss(40)
    exact = length / 2 * weights @ energy(length / 2 * (1 + points), 1 / 12)
    return -0.5 * (masses @ energy(mesh.nodes[:, 0], (mesh.nodes[:, 2] - 0.5)**2) / exact - 1)


def main():
    reference, free_beam = Ritz(1.0, 0.3, 12), Ritz(1.0, 0.3, 12, (10, 1, 1)).omega[0]
    beams, brick = [(10, 1, 1), (10, 2, 2), (20, 2, 2)], (8, 4, 4)
    print("| element, mass | " + " | ".join("clamped, free beam " + "x".join(map(str, n)) for n in beams) + " | brick 8x4x4, rms | step c_d/h |\n|---|" + "---|" * 5)
    for element in (one_point, h8msgso, full):
        for name, lumped in (("row sums", lumped_masses), ("inertia", nodal_masses)):
            cells = []
            for elements in beams:
                mesh = box((10, 1, 1), elements, name="beam")
                masses, root = lumped(mesh.nodes, mesh.hexes), np.flatnonzero(mesh.nodes[:, 0] == 0)
                clamped, free = frequencies(element, mesh, masses, root)[0], frequencies(element, mesh, masses)[6]
                cells.append(f"{100 * (clamped / CONVERGED - 1):+.2f}, {100 * (free / free_beam - 1):+.2f} %")
            mesh = box(SIZE, brick, -SIZE / 2)
            found = frequencies(element, mesh, lumped(mesh.nodes, mesh.hexes))
            error = np.sqrt(np.mean((found[6:6 + COUNT] / reference.omega - 1)**2))
            wave = np.sqrt(0.7 / (1.3 * 0.4))  # c_d at E = rho = 1, nu = 0.3
            cells += [f"{100 * error:.2f} %", f"{2 / found[-1] * wave * brick[2]:.3f}"]
            print(f"| {element.__name__}, {name} | " + " | ".join(cells) + " |")
    print("\n| cantilever, one-point | mass: row sums | mass: inertia | stiffness with row sums, inertia |\n|---|---|---|---|")
    for elements in beams:
        mesh = box((10, 1, 1), elements, name="beam")
        pair, root = [lumped(mesh.nodes, mesh.hexes) for lumped in (lumped_masses, nodal_masses)], np.flatnonzero(mesh.nodes[:, 0] == 0)
        by_mass = [100 * share_of_mass(mesh, masses) for masses in pair]
        rest = [100 * (frequencies(one_point, mesh, masses, root)[0] / CONVERGED - 1) - part for masses, part in zip(pair, by_mass)]
        print(f"| {'x'.join(map(str, elements))} | {by_mass[0]:+.2f} % | {by_mass[1]:+.2f} % | {rest[0]:+.2f}, {rest[1]:+.2f} % |")
    print("\n| brick, one-point, rms | all | mass | rest |\n|---|---|---|---|")
    for elements in ((4, 2, 2), brick, (12, 6, 6)):
        mesh = box(SIZE, elements, -SIZE / 2)
        for name, lumped in (("row sums", lumped_masses), ("inertia", nodal_masses)):
            total, by_mass = brick_errors(reference, mesh, lumped(mesh.nodes, mesh.hexes))
            parts = [100 * np.sqrt(np.mean(part**2)) for part in (total, by_mass, total - by_mass)]
            print(f"| {'x'.join(map(str, elements))}, {name} | " + " | ".join(f"{part:.2f} %" for part in parts) + " |")


if __name__ == "__main__":
    main()
