"""Bodies of a run: masses, mean values, interpolation in time."""
import numpy as np
from framework.meshes import bodies, nodal_masses


def bodies_of(results, density=1.0):
    """(nodes of each body, their masses [body][node of it])."""
    masses = nodal_masses(results.nodes, results.hexes, density)
    members = bodies(len(results.nodes), results.hexes)
    return members, [masses[nodes] for nodes in members]


def means_of_bodies(results, name, step=-1, parts=None):
    """Mass-weighted means of a nodal vector over each body [body][xyz]; for "displacement", those
    of the centres of mass."""
    members, masses = parts or bodies_of(results)
    values = results.nodal(name, step)
    return np.array([mass @ values[nodes] / mass.sum() for nodes, mass in zip(members, masses)])


def at_times(times, values, rates, at):
    """Values [time][...] at `at`, by cubic Hermite interpolation of the values and their rates."""
    i = np.clip(np.searchsorted(times, at) - 1, 0, len(times) - 2)
    shape = (-1,) + (1,) * (values.ndim - 1)
    step = (times[i + 1] - times[i]).reshape(shape)
    s = (at.reshape(shape) - times[i].reshape(shape)) / step
    return (values[i] * (1 + 2 * s) * (1 - s)**2 + values[i + 1] * s**2 * (3 - 2 * s)
            + step * s * (1 - s) * (rates[i] * (1 - s) - rates[i + 1] * s))
