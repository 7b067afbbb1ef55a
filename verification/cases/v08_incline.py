"""V8: A block on a plane inclined by theta = 20 degrees, tan(theta) = 0.364. With mu < tan(theta)
it slides with the acceleration g (sin theta - mu cos theta), once the oscillation from the sudden
weight has decayed; friction dissipates mu N times the distance. With mu = 0.4 it comes to rest and
creeps no further. With mu so large that the sudden weight does not make it slip, its lower face has
moved by the extension of the tangential springs: these are as stiff as the normal ones, whose
penetration is P, so T/k_t = tan(theta) P."""
import numpy as np
from framework.figures import EXACT
from framework.meshes import box, nodal_masses, rotation, together

NAME = "V8"
TITLE = "block on an incline"
DECK = "v08_incline.toml"
THETA = np.radians(20)
TURN = rotation((0, 1, 0), THETA)  # x runs down the slope


def incline():
    block = box((1, 1, 0.5), (4, 4, 2), name="block")
    plane = box((6, 3, 1), (6, 3, 1), (-1.5, -1, -1), "plane")
    plane.node_sets = {"plane.all": np.arange(len(plane.nodes))}
    return together(block, plane).mapped(lambda nodes: nodes @ TURN.T)


class Motion:
    """Motion of the block's centre of mass down the slope by time, and of its lower face at the
    end."""

    def __init__(self, run):
        results = run.results
        block = results.nodes_of_block(0)
        masses = nodal_masses(results.nodes, results.hexes)[block]
        self.mass, self.times, self.history = masses.sum(), results.times, run.history
        down, up = TURN[:, 0], TURN[:, 2]
        self.distance, self.velocity = (
            np.array([masses @ (results.nodal(name, step)[block] @ down) for step in range(len(self.times))]) / self.mass
            for name in ("displacement", "velocity"))
        lower = block[results.nodes[block] @ up < 1e-9]
        self.slip, self.depth = ([sign * (results.nodal("displacement", step)[lower] @ along).mean() for step in (-2, -1)]
                                 for sign, along in ((1, down), (-1, up)))


def evaluate(lab):
    gravity = -lab.deck["gravity"]["acceleration"][2]
    coefficients = (0.1, 0.3) if lab.quick else (0.1, 0.2, 0.3)
    sliding = {mu: Motion(lab.run(f"slide_{mu}", {"contact.friction": mu}, mesh=incline())) for mu in coefficients}
    rows = []
    for mu, motion in sliding.items():
        exact = gravity * (np.sin(THETA) - mu * np.cos(THETA))
        late = motion.times > 0.5 * motion.times[-1]
        computed = np.polyfit(motion.times[late], motion.velocity[late], 1)[0]
        lab.check(computed, exact, 0.005, f"slides_{mu}" if rows else "")
        loss = mu * motion.mass * gravity * np.cos(THETA) * motion.distance[-1]
        rows.append([mu, computed / gravity, exact / gravity, computed / exact - 1,
                     motion.history["dissipated_energy"][-1] / loss])
    lab.table("Sliding, accelerations over g:", ["mu", "computed", "exact", "error", "dissipated over mu N s"], rows)

    stuck, held = (Motion(lab.run(f"stick_{mu}", {"contact.friction": mu, "contact.damping": 0.2, "damping.mass": 1.0}, mesh=incline()))
                   for mu in (0.4, 4.0))
    creep = abs(stuck.slip[-1] - stuck.slip[-2]) / stuck.depth[-1]
    lab.check(creep, 0, 1e-6, "creep_after_sticking")
    # The penetration contains a part without pressure, the fall of the first step, 1 % here.
    lab.check(held.slip[-1], np.tan(THETA) * held.depth[-1], 0.03, "extension_of_tangential_springs")
    lab.note(f"With mu = 0.4 the sudden weight makes the block slip by {stuck.slip[-1]:.2g} of its length before it sticks; "
             f"then it creeps by {creep:.1g} of the penetration in a time of {stuck.times[-1] - stuck.times[-2]:g}.")
    with lab.figure("Velocity down the slope by time") as axes:
        for mu, motion in sliding.items():
            exact = gravity * (np.sin(THETA) - mu * np.cos(THETA))
            axes.plot(motion.times, exact * motion.times, label="exact" if mu == coefficients[0] else None, **EXACT)
            axes.plot(motion.times, motion.velocity, label=f"mu = {mu}", linewidth=1)
        axes.plot(stuck.times, stuck.velocity, label="mu = 0.4, sticks", linewidth=1)
        axes.set(xlabel="t c/length", ylabel="v/c")
