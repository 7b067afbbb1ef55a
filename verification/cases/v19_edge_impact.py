"""V19: A tilted block hits a smooth rigid plane with an edge, with the velocity v and without spin.
A rigid block without loss takes the impulse P = 2 m v/(1 + m r^2/J), with r the horizontal distance
of its centre from the edge and J its moment of inertia (Routh), and the angular momentum r P about
its initial centre, whatever the restitution is. The block comes near to a rigid one where contact
is soft, since the time of contact is then long compared with its vibrations: with a penalty of 0.1.
At the default penalty the block keeps a vibration. It tests the angular momentum in impacts, as one
of the benchmarks of Di Stasio, Dureisseix, Gravouil, Georges and Homolle (Adv. Model. Simul. Eng. Sci.
6:2, 2019) does; it is in their spirit and has this code's own definition."""
import numpy as np
from framework.meshes import box, rotation, together

NAME = "V19"
TITLE = "impact on an edge"
DECK = "v19_edge_impact.toml"
SIZE = np.array([1.0, 0.5, 0.5])


def scene(tilt):
    """The block about the origin, and a plane that its lowest edge almost touches."""
    block = box(SIZE, (4, 2, 2), -SIZE / 2, "block").mapped(lambda x: x @ rotation((0, 1, 0), -tilt).T)
    low = block.nodes[:, 2].min() - 1e-9
    plane = box((3, 2, 0.5), (3, 2, 1), (-1.5, -1, low - 0.5), "plane")
    plane.node_sets = {"plane.all": np.arange(len(plane.nodes))}
    return together(block, plane)


def evaluate(lab):
    v, mass, inertia = -lab.deck["initial"]["velocity"][0]["velocity"][2], SIZE.prod(), (SIZE[0]**2 + SIZE[2]**2) / 12
    rows = []
    for degrees in (20, 45, 60, 70):
        tilt = np.radians(degrees)
        arm = SIZE[0] / 2 * np.cos(tilt) - SIZE[2] / 2 * np.sin(tilt)
        effective = 1 + arm**2 / inertia
        exact = 2 * mass * v / effective
        for penalty in (0.1, 0.9):
            history = lab.run(f"tilt_{degrees}_penalty_{penalty}", {"contact.penalty": penalty}, mesh=scene(tilt)).history
            impulse, moment = np.ptp(history["momentum_z"][[0, -1]]), np.ptp(history["angular_momentum_y"][[0, -1]])
            times = history["time"][history["contacts"] > 0]
            duration = np.ptp(times)
            vibration = history["internal_energy"][history["time"] > times[-1]].mean() / history["kinetic_energy"][0]
            if penalty == 0.1:
                # With restitution e, the error (1 - e)/2 is effective/4 times the share of the
                # energy that vibrates, twice the mean internal energy; a margin of 2.
                lab.check(impulse, exact, vibration * effective, f"impulse_{degrees}" if rows else "")
            # The edge moves by v times the duration at most.
            lab.check(moment, abs(arm) * impulse, v * duration / abs(arm), f"moment_{degrees}_{penalty}")
            rows.append([degrees, penalty, arm, impulse / exact - 1, moment / (abs(arm) * impulse) - 1, vibration, duration,
                         history["energy_error"].max()])
    lab.check(max(row[-1] for row in rows), 0, 1e-6, "energy")
    lab.table("Impulse over that of a rigid block; moment over arm times impulse; mean internal energy afterwards over the initial energy:",
              ["degrees", "penalty", "arm", "error of the impulse", "error of the moment", "internal energy", "time of contact c/length", "energy error"],
              rows)
