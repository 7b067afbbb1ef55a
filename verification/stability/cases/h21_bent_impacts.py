"""H21: Two free blocks, bent to arcs or straight, of random sizes, meshes, orientations and spins
collide with random speeds up to a tenth of that of waves. On bent surfaces contacts slide from face
to face and end beyond edges while normals rotate; whatever a contact stores must come back."""
import numpy as np
from _hard import energy_change
from framework.meshes import box, rotation, together

NAME = "H21"
TITLE = "impacts of bent blocks"
DECK = "h21_bent_impacts.toml"
SECONDS = 120
IMPACTS = 100
QUICK = (10, 143, 198, 419)


def bent(mesh, angle):
    """A block whose length along x becomes an arc of this angle, with its centre in place."""
    radius = np.ptp(mesh.nodes[:, 0]) / angle

    def image(x):
        turn, r = x[:, 0] / radius, radius + x[:, 1]
        return np.column_stack([r * np.sin(turn), r * np.cos(turn) - radius, x[:, 2]])
    return mesh.mapped(image)


def impact(seed):
    """(mesh, settings, speed): the blocks are 0.01 apart along z, and approach each other."""
    random = np.random.default_rng(seed)
    speed = 10 ** random.uniform(-2.5, -1.2)
    blocks, settings = [], {}
    for number, name in enumerate(("low", "high")):
        size = random.uniform(0.6, 2.0, 3)
        block = box(size, np.ceil(random.uniform(2, 5) * size).astype(int), -size / 2, name)
        if random.random() < 2 / 3:
            block = bent(block, random.uniform(0.3, 1.5) * min(1, size[0] / size[1]))
        turn = rotation(random.normal(size=3), random.uniform(0, np.pi))
        block = block.mapped(lambda x, turn=turn: x @ turn.T)
        side = (-1, 1)[number]
        center = np.array([*random.uniform(-0.2, 0.2, 2), side * (0.005 + (-side * block.nodes[:, 2]).max())])
        blocks.append(block.mapped(lambda x, center=center: x + center))
        settings[f"initial.velocity[{number}].velocity"] = 0.5 * speed * np.array([*random.uniform(-0.3, 0.3, 2), -side])
        settings[f"initial.velocity[{number}].angular_velocity"] = random.normal(size=3) * speed / 3
        settings[f"initial.velocity[{number}].center"] = center
    return together(*blocks), {**settings, "time.end": 5 + 0.5 / speed}, speed


def evaluate(lab):
    rows = []
    for seed in QUICK if lab.quick else range(IMPACTS):
        mesh, settings, speed = impact(seed)
        history = lab.run(f"seed{seed}", settings, mesh=mesh).history
        energy = energy_change(history)
        rows.append([seed, speed, int(history["contacts"].max()), history["max_penetration"].max(), energy[-1],
                     np.abs(energy).max(), int(history["lost_contacts"][-1])])
    final, largest = (np.abs([row[column] for row in rows]) for column in (4, 5))
    lab.check(final.max(), 0, 2e-3)
    if not lab.quick:
        lab.check(np.median(final), 0, 1e-5, "median")
    lab.table("Relative errors of the energy:", ["", "median", "90 %", "largest"],
              [[name, np.median(values), np.quantile(values, 0.9), values.max()]
               for name, values in (("at the end", final), ("at any time", largest))])
    rows.sort(key=lambda row: -abs(row[4]))
    lab.table("The ten impacts with the largest errors at the end:",
              ["seed", "speed", "most contacts", "deepest / face", "energy, final", "energy, largest", "contacts lost"], rows[:10])
