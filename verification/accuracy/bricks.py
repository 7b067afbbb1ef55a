"""Bodies of a run: masses, mean values, courses in time."""
import numpy as np
from framework.meshes import bodies, nodal_masses


def bodies_of(results, density=1.0):
    """(nodes of each body, their masses [body][node of it])."""
    masses = nodal_masses(results.nodes, results.hexes, density)
    members = bodies(len(results.nodes), results.hexes)
    return members, [masses[nodes] for nodes in members]


def means_of_bodies(results, name, step=-1, parts=None):
    """Of a nodal vector over each body by mass [body][xyz]; of "displacement": that of the centre of mass."""
    members, masses = parts or bodies_of(results)
    values = results.nodal(name, step)
    return np.array([mass @ values[nodes] / mass.sum() for nodes, mass in zip(members, masses)])


def at_times(times, values, rates, wanted):
    """Values [time][...] at the wanted times, by cubics through the values and their rates."""
    i = np.clip(np.searchsorted(times, wanted) - 1, 0, len(times) - 2)
    shape = (-1,) + (1,) * (values.ndim - 1)
    step = (times[i + 1] - times[i]).reshape(shape)
    s = (wanted.reshape(shape) - times[i].reshape(shape)) / step
    return (values[i] * (1 + 2 * s) * (1 - s)**2 + values[i + 1] * s**2 * (3 - 2 * s)
            + step * s * (1 - s) * (rates[i] * (1 - s) - rates[i + 1] * s))
