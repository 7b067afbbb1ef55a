"""Common to the patch tests: a distorted block, closed forms of stress, nodal forces from the
motion of the first step."""
import numpy as np
from framework.meshes import box, nodal_masses

# Every kind of element with every material.
VARIANTS = [(element, model) for element in ("one_point", "full") for model in ("neo_hookean", "svk", "linear")]


def settings_of(element, model, gradient):
    return {"element.formulation": element, "material.block.model": model,
            "initial.deformation[0].gradient": np.asarray(gradient).reshape(-1)}


def distorted_block(edges):
    """The unit cube with `edges` elements along each edge; every node is displaced by up to a fifth
    of an element."""
    shift = np.random.default_rng(7).uniform(-0.2, 0.2, ((edges + 1)**3, 3)) / edges
    return box((1, 1, 1), (edges,) * 3).mapped(lambda nodes: nodes + shift)


def cauchy_stress(gradient, model, youngs=1.0, poisson=0.3):
    """Closed forms, F = I + H: neo-Hookean J sigma = mu (b - I) + lambda ln J I;
    St.Venant-Kirchhoff J sigma = F S F^T with S = lambda tr E I + 2 mu E; linear sigma = lambda tr
    e I + 2 mu e."""
    lam, mu = youngs * poisson / ((1 + poisson) * (1 - 2 * poisson)), youngs / (2 * (1 + poisson))
    identity, H = np.eye(3), np.asarray(gradient).reshape(3, 3)
    F, J = identity + H, np.linalg.det(identity + H)
    if model == "neo_hookean":
        return (mu * (F @ F.T - identity) + lam * np.log(J) * identity) / J
    if model == "svk":
        E = (F.T @ F - identity) / 2
        return F @ (lam * np.trace(E) * identity + 2 * mu * E) @ F.T / J
    e = (H + H.T) / 2
    return lam * np.trace(e) * identity + 2 * mu * e


def start_forces(run):
    """Nodal forces at the start, from the first step: u^1 - u^0 = (dt^2/2) f/m, from rest. The
    rounding is 1e-16 |u| m/dt^2."""
    results = run.results
    masses = nodal_masses(results.nodes, results.hexes)
    step = run.history["timestep"][0]
    return (results.nodal("displacement", 1) - results.nodal("displacement", 0)) * (2 * masses / step**2)[:, None]
