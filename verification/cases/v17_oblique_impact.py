"""V17: Two free elastic blocks of random sizes, orientations, velocities (.01 to .03 c each) and spins run into each other, 40
times. Nothing acts from outside and nothing dissipates: momentum, angular momentum and energy stay. The first two are exact by
construction; the energy shows the error of contact at births, switches of faces and slips off edges. The gauge is that of the
half step, which central differences conserve to rounding for linear springs."""
import numpy as np
from framework.meshes import box, rotation, together

NAME = "V17"
TITLE = "40 oblique impacts of two blocks"
DECK = "v17_oblique_impact.toml"
SECONDS = 60


def random_turn(random):
    return rotation(random.normal(size=3), random.uniform(0, np.pi))


def random_impact(seed):
    """(mesh, settings) of two blocks that just do not touch: spheres about them do."""
    random = np.random.default_rng(seed)
    blocks, settings, reach = [], {}, 0.0
    for i, name in enumerate(("left", "right")):
        size = random.uniform(0.6, 1.4, 3)
        block = box(size, np.ceil(4 * size).astype(int), -size / 2, name)
        radius = np.linalg.norm(size) / 2
        center = np.array([(-radius, radius)[i], *random.uniform(-0.25, 0.25, 2) * i])
        turn = random_turn(random)
        blocks.append(block.mapped(lambda nodes, turn=turn, center=center: nodes @ turn.T + center))
        reach = max(reach, np.linalg.norm(center) + radius)
        velocity = random.uniform(0.01, 0.03) * np.array([(1, -1)[i], *random.uniform(-0.2, 0.2, 2)])
        settings[f"initial.velocity[{i}].velocity"] = velocity
        settings[f"initial.velocity[{i}].angular_velocity"] = random.normal(size=3) * 0.01
        settings[f"initial.velocity[{i}].center"] = center
    return together(*blocks), settings


def vector(history, name):
    return np.stack([history[f"{name}_{axis}"] for axis in "xyz"], axis=1)


def evaluate(lab):
    seeds = range(4 if lab.quick else 40)
    rows, histories = [], {}
    for seed in seeds:
        mesh, settings = random_impact(seed)
        history = histories[seed] = lab.run(f"seed{seed}", settings, mesh=mesh).history
        energy = history["total_energy"][1:] / history["total_energy"][1] - 1
        # Momenta of the parts may cancel in the sum: sqrt(2 K M) bounds them, with M below 6 and all within 3 of the origin.
        scale = np.sqrt(2 * history["kinetic_energy"][0] * 6)
        momentum, angular = (np.linalg.norm(vector(history, name) - vector(history, name)[0], axis=1).max() / scale
                             for name in ("momentum", "angular_momentum"))
        rows.append([seed, history["contacts"].max(), history["contacts"][-1], energy[-1], np.abs(energy).max(), momentum,
                     angular / 3])
    final, largest = (np.abs([row[i] for row in rows]) for i in (3, 4))
    lab.check(final.max(), 0, 1e-3)
    lab.check(largest.max(), 0, 5e-3, "energy_over_time")
    lab.check(max(row[5] for row in rows), 0, 1e-13, "momentum")
    lab.check(max(row[6] for row in rows), 0, 1e-13, "angular_momentum")
    lab.check(min(row[1] for row in rows) > 0, 1, 0, "all_have_met")
    lab.check(max(row[2] for row in rows), 0, 0, "all_have_parted")
    lab.note(f"Energy over {len(rows)} impacts: root mean square {np.sqrt(np.mean(final**2)):.2g} in the end, worst "
             f"{final.max():.2g} (seed {final.argmax()}); at any time worst {largest.max():.2g} (seed {largest.argmax()}).")
    lab.table("Relative changes:", ["seed", "most contacts", "contacts in the end", "energy, final", "energy, largest",
                                    "momentum", "angular momentum"], rows)
    with lab.figure("Energy by time, over that of the start") as axes:
        for history in histories.values():
            axes.plot(history["time"][1:], history["total_energy"][1:] / history["total_energy"][1] - 1, linewidth=0.6)
        axes.set(xlabel="t", ylabel="E/E_0 - 1")
