"""V22: The first nine natural frequencies of a free brick of 2 x 1 x 1 (nu = 0.3): torsion, two of
bending, a longitudinal one and five of shear and higher bending. The reference is the Rayleigh-Ritz
method with products of Legendre polynomials of total degree 12 at most, converged to 1e-4 (Leissa
and Zhang 1983 solved the cantilevered brick so). The brick is struck at three corners, and each
frequency is fitted to the motion projected on the mode of the reference: modes are followed, not
sorted by frequency."""
from itertools import product

import numpy as np
from framework.figures import draw_slope
from framework.meshes import box, lumped_masses, nodal_masses
from framework.signals import fit_frequency

NAME = "V22"
TITLE = "natural frequencies of a free brick"
DECK = "v22_free_brick.toml"
SECONDS = 20
SIZE = np.array([2.0, 1.0, 1.0])
COUNT = 9


class Ritz:
    """Natural frequencies and modes of the free brick about the origin, for unit density."""

    def __init__(self, youngs, poisson, degree=10, size=SIZE):
        lame, mu = youngs * poisson / ((1 + poisson) * (1 - 2 * poisson)), youngs / (2 * (1 + poisson))
        self.degree, self.size = degree, np.asarray(size)
        self.powers = np.array([p for p in product(range(degree + 1), repeat=3) if sum(p) <= degree + 2])
        points, weights = np.polynomial.legendre.leggauss(degree + 2)
        values, slopes = self.polynomials(points), self.polynomials(points, derivative=True)
        self.omega, self.modes = [], []
        n = len(self.powers)
        for parity in product((0, 1), repeat=3):  # symmetry classes, of phi_k with d_i phi_k of this parity
            chosen = [(i, k) for i in range(3) for k in range(n)
                      if all((self.powers[k] + (np.arange(3) == i)) % 2 == parity)]
            axis, number = np.array(chosen).T
            tables = {}
            for d, e in product(range(3), repeat=2):  # integrals of d_d phi_k d_e phi_l
                table = 1
                for j in range(3):
                    a, b = (slopes if d == j else values), (slopes if e == j else values)
                    p = self.powers[number, j]
                    scale = size[j] / 2 / (size[j] / 2) ** ((d == j) + (e == j))
                    table = table * scale * ((a * weights) @ b.T)[np.ix_(p, p)]
                tables[d, e] = table
            same = axis[:, None] == axis
            stiffness = mu * same * sum(tables[d, d] for d in range(3))
            for d, e in product(range(3), repeat=2):
                here = (axis[:, None] == d) & (axis == e)
                stiffness = stiffness + here * (lame * tables[d, e] + mu * tables[e, d])
            square, shapes = np.linalg.eigh(stiffness / np.prod(self.size / 2))  # the mass matrix is diagonal
            for value, shape in zip(square[:COUNT + 6], shapes.T):
                self.omega.append(np.sqrt(max(value, 0)))
                self.modes.append((axis, number, shape))
        order = np.argsort(self.omega)[6:6 + COUNT]  # without the six rigid motions
        self.omega, self.modes = np.array(self.omega)[order], [self.modes[k] for k in order]

    def polynomials(self, x, derivative=False):
        """Legendre polynomials, of norm 1 on [-1, 1] [power][point]."""
        legendre = np.polynomial.legendre
        rows = []
        for k in range(self.degree + 1):
            series = np.sqrt(k + 0.5) * np.eye(self.degree + 1)[k]
            rows.append(legendre.legval(x, legendre.legder(series) if derivative else series))
        return np.array(rows)

    def mode(self, k, nodes):
        """Mode k at the nodes [node][xyz]."""
        axis, number, shape = self.modes[k]
        values = np.prod([self.polynomials(2 * nodes[:, j] / self.size[j])[self.powers[:, j]] for j in range(3)], axis=0)
        mode = np.zeros(nodes.shape)
        np.add.at(mode.T, axis, shape[:, None] * values[number])
        return mode


def struck_brick(elements):
    mesh = box(SIZE, elements, -SIZE / 2, "brick")
    centres = mesh.nodes[mesh.hexes].mean(axis=1)
    for i, axis in enumerate("xyz"):
        sides = mesh.side_sets[f"brick.{axis}1"]
        others = [j for j in range(3) if j != i]
        mesh.side_sets[axis] = sides[(centres[sides[:, 0]][:, others] > 0).all(axis=1)]
    return mesh


def frequencies(lab, ritz, elements, mass):
    """(the nine frequencies, the stable step over element edge and wave speed)."""
    mesh = struck_brick(elements)
    run = lab.run(f"{'x'.join(map(str, elements))}_{mass}", {"element.mass": mass}, mesh=mesh)
    results, free = run.results, run.results.times > 2
    times = results.times[free]
    displacement = np.array([results.nodal("displacement", step) for step in np.flatnonzero(free)])
    masses = (nodal_masses if mass == "inertia" else lumped_masses)(mesh.nodes, mesh.hexes)
    found = []
    for k in range(COUNT):
        signal = np.einsum("tni,ni->t", displacement, masses[:, None] * ritz.mode(k, mesh.nodes))
        guesses = ritz.omega[k] * np.linspace(0.6, 1.1, 501)
        window = np.hanning(len(times)) * (signal - signal.mean())
        power = [abs(window @ np.exp(1j * guess * times)) for guess in guesses]
        found.append(fit_frequency(times, signal, guesses[np.argmax(power)], 0.01))
    return np.array(found)


def evaluate(lab):
    material = lab.deck["material"]["brick"]
    ritz = Ritz(material["youngs_modulus"], material["poissons_ratio"])
    meshes = [(4, 2, 2), (8, 4, 4)] + ([] if lab.quick else [(16, 8, 8)])
    errors = {(mesh, mass): frequencies(lab, ritz, mesh, mass) / ritz.omega - 1
              for mesh in meshes for mass in ("row_sum", "inertia")}
    rms = {key: np.sqrt(np.mean(error**2)) for key, error in errors.items()}
    # Wider than the wanted 1.2 and 7 %: masses without error would leave 1.40 and 9.7 %, by the stiffness (theory.md of mechanics;
    # accuracy/other_elements.py). Eigenvalues of 8 x 4 x 4 elements give 1.6 % with the masses in use; torsion errs most, by 2.6 %.
    lab.check(rms[(8, 4, 4), "inertia"], 0, 0.018)
    lab.check(rms[(4, 2, 2), "inertia"], 0, 0.1, "4x2x2")
    lab.check(np.abs(errors[(8, 4, 4), "inertia"][:3]).max(), 0, 0.03, "torsion_and_bending")
    if not lab.quick:
        sizes = [1 / mesh[2] for mesh in meshes[1:]]
        lab.check_order(sizes, [rms[mesh, "inertia"] for mesh in meshes[1:]], least=1.8, exact=2)
    lab.table("Relative errors of the frequencies:",
              ["elements", "mass", "rms", *(f"{omega:.4f}" for omega in ritz.omega)],
              [["x".join(map(str, mesh)), mass, rms[mesh, mass], *errors[mesh, mass]] for mesh, mass in errors])
    with lab.figure("Root mean square of the errors of nine frequencies") as axes:
        sizes = [1 / mesh[2] for mesh in meshes]
        for mass in ("row_sum", "inertia"):
            axes.loglog(sizes, [rms[mesh, mass] for mesh in meshes], "o-", label=mass)
        draw_slope(axes, sizes, [rms[mesh, "inertia"] for mesh in meshes], 2)
        axes.set(xlabel="element size / thickness", ylabel="relative error")
