"""Oblique impacts of two free blocks of random sizes and orientations."""
import numpy as np
from _hard import Block, lifted, mesh_of
from framework.meshes import rotation


def impact(lab, label, seed, deck, settings=None, speed=0.02, elements_per_length=(4, 4)):
    """Runs `deck`, whose blocks are "low" and "high"; "high" has the `speed` along -z, in units of
    the deck."""
    random = np.random.default_rng(seed)
    low, high = (Block(name, (0, 0, 0), rotation(random.normal(size=3), random.uniform(0, np.pi)), size,
                       tuple(np.ceil(count * size).astype(int)))
                 for name, count, size in zip(("low", "high"), elements_per_length, random.uniform(0.6, 1.2, (2, 3))))
    high = lifted(low, high.moved((*random.uniform(-0.2, 0.2, 2), 0)), -0.01)
    spin = random.normal(size=3) * speed / 3
    return lab.run(label, {"initial.velocity[0].velocity": [*random.uniform(-0.3, 0.3, 2) * speed, -speed],
                           "initial.velocity[0].angular_velocity": spin, "initial.velocity[0].center": high.center,
                           **(settings or {})}, mesh=mesh_of(low, high), deck=deck)
