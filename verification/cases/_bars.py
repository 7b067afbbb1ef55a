"""Common to the cases of colliding bars: contact force and mean velocity of each bar by time."""
from types import SimpleNamespace

import numpy as np
from framework.meshes import bodies, nodal_masses


def histories(results, density=1.0):
    """times [step]; force [bar][step] of its neighbours along x; velocity [bar][step] of its centre
    of mass; mass [bar]. `density` is one number or one per element."""
    bars = bodies(len(results.nodes), results.hexes)
    masses = nodal_masses(results.nodes, results.hexes, density)
    steps = range(len(results.times))
    forces = np.array([results.nodal("force_contact_x", step) for step in steps])
    velocities = np.array([results.nodal("velocity_x", step) for step in steps])
    mass = np.array([masses[bar].sum() for bar in bars])
    return SimpleNamespace(
        times=results.times, mass=mass,
        force=np.array([forces[:, bar].sum(axis=1) for bar in bars]),
        velocity=np.array([velocities[:, bar] @ masses[bar] for bar in bars]) / mass[:, None])


def last_time(times, pressed):
    """The last time at which the condition holds."""
    return times[np.flatnonzero(pressed)[-1]]


def mean_between(times, values, begin, end):
    """The mean over steps of equal length with begin < t < end, under a Hann window: contact
    oscillates from step to step, and a plain mean would keep a part of the last oscillation."""
    inside = values[(times > begin) & (times < end)]
    return np.average(inside, weights=np.hanning(len(inside) + 2)[1:-1])


def crossings(times, values, level):
    """Times at which `values` cross `level`, interpolated linearly between steps."""
    steps = np.flatnonzero(np.diff(np.sign(values - level)))
    share = (level - values[steps]) / (values[steps + 1] - values[steps])
    return times[steps] + share * (times[steps + 1] - times[steps])
