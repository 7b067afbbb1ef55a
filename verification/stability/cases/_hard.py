"""Common to the hard cases: free blocks and their overlap, energies of a run, runs that must
stop."""
from dataclasses import dataclass, field

import numpy as np
from framework.meshes import box, rotation, together

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def turned(*turns):
    """The matrix of successive rotations ("x" | "y" | "z" or a vector, degrees)."""
    matrix = np.eye(3)
    for axis, degrees in turns:
        matrix = rotation(AXES.get(axis, axis) if isinstance(axis, str) else axis, np.radians(degrees)) @ matrix
    return matrix


# A cube that stands on a corner: the rotation of (1, 1, 1) to z.
ON_A_CORNER = rotation(np.cross((1, 1, 1), (0, 0, 1)), np.arccos(1 / np.sqrt(3)))


@dataclass
class Block:
    """A box of elements, rotated about its centre."""

    name: str  # the name of its element block
    center: np.ndarray = (0, 0, 0)
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    size: np.ndarray = (1, 1, 1)
    elements: tuple = (4, 4, 4)

    def mesh(self):
        size = np.asarray(self.size, dtype=float)
        return box(size, self.elements, -size / 2, self.name).mapped(lambda x: x @ self.turn.T + self.center)

    def corners(self):
        signs = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(-1, 3)
        return (signs * self.size) @ self.turn.T + self.center

    def moved(self, shift):
        return Block(self.name, np.asarray(self.center) + shift, self.turn, self.size, self.elements)


def depth(a, b):
    """The overlap of two boxes: the shortest distance that separates them, negative if they are
    apart (separating axes: normals of faces and cross products of edges)."""
    axes = [*a.turn.T, *b.turn.T] + [np.cross(p, q) for p in a.turn.T for q in b.turn.T]
    corners_a, corners_b = a.corners(), b.corners()
    depths = []
    for axis in axes:
        if np.linalg.norm(axis) < 1e-6:
            continue
        on_a, on_b = (corners @ axis / np.linalg.norm(axis) for corners in (corners_a, corners_b))
        depths.append(min(on_a.max() - on_b.min(), on_b.max() - on_a.min()))
    return min(depths)


def lifted(low, high, target_depth):
    """`high` moved along z until its overlap with `low` is `target_depth`; a negative value is a
    gap."""
    down, up = -10.0, 10.0  # deeper at `down`
    up_block = high.moved((0, 0, up))
    assert depth(low, up_block) < target_depth
    down = -high.center[2] + low.center[2]
    for _ in range(80):
        middle = 0.5 * (down + up)
        if depth(low, high.moved((0, 0, middle))) > target_depth:
            down = middle
        else:
            up = middle
    return high.moved((0, 0, up))


def mesh_of(*blocks):
    return together(*(block.mesh() for block in blocks))


def energy_change(history):
    """For each row of a history of all steps: the change since the first full step of the energy at
    the half step before it, less the external work up to there, over the largest kinetic + internal
    energy."""
    energy = history["total_energy"][1:] - history["external_work"][:-1]
    peak = np.max(history["kinetic_energy"] + history["internal_energy"])
    return np.concatenate([[0.0], (energy - energy[0]) / peak])


def largest_jump(history):
    """(largest change of energy_change within a step, its step)."""
    jumps = np.abs(np.diff(energy_change(history)))
    return jumps.max(), int(history["step"][1 + jumps.argmax()])


def check_stop(lab, run, words, name):
    """Checks that the run ended with exit code 3 and a message that contains `words`, and left
    readable results without NaN."""
    explained = all(word in run.message for word in words)
    clean = run.code == 3 and explained and not run.report["pass"] and all(
        np.isfinite(column).all() for column in run.history.values())
    lab.check(run.code, 3, 0, name, error=0 if clean else 1)
    lab.note(f"{name.replace('_', ' ')}: exit code {run.code}, “{run.message}”")
