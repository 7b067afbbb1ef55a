"""V24: A rigid block of width b and height h under its weight on a plane inclined by theta = 20
degrees. With mu > tan(theta) it tips about its lower edge if b/h < tan(theta), and stands otherwise.
Its law of motion is phi'^2 = 3 g/(2 R) (cos(theta - beta) - cos(theta - beta + phi)) with tan(beta) =
b/h and 2 R the diagonal. With mu < tan(theta) it slides with g (sin(theta) - mu cos(theta)) if b/h >
mu, since the friction acts on its base, and tips while it slides otherwise. Its sudden weight bends
the elastic block, which gives it the energy of this bending."""
import numpy as np
from framework.meshes import box, nodal_masses, rotation, together

NAME = "V24"
TITLE = "tipping block"
DECK = "v24_tipping_block.toml"
THETA = np.radians(20)
TURN = rotation((0, 1, 0), THETA)  # x runs down the slope


def scene(width):
    block = box((width, 0.25, 1), (4, 1, 8), name="block")
    plane = box((4, 0.75, 0.25), (4, 1, 1), (-1.5, -0.25, -0.25), "plane")
    plane.node_sets = {"plane.all": np.arange(len(plane.nodes))}
    return together(block, plane).mapped(lambda x: x @ TURN.T)


def motion(run):
    """Times, rotation and distance down the slope of the block's centre by output step."""
    results = run.results
    block = results.nodes_of_block(0)
    X = results.nodes[block]
    m = nodal_masses(results.nodes, results.hexes)[block]
    m = m / m.sum()
    X = X - m @ X
    angle, slip = [], []
    for step in range(len(results.times)):
        u = results.nodal("displacement", step)[block]
        x = X + u - m @ u
        angle.append(np.arctan2(m @ (x[:, 0] * X[:, 2] - x[:, 2] * X[:, 0]), m @ (x[:, 0] * X[:, 0] + x[:, 2] * X[:, 2])))
        slip.append(m @ u @ TURN[:, 0])
    return results.times, np.array(angle), np.array(slip)


def evaluate(lab):
    gravity, steep = -lab.deck["gravity"]["acceleration"][2], np.tan(THETA)
    # width/height, friction
    runs = {"tips": (0.97 * steep, 1.0), "stands": (1.03 * steep, 1.0), "slides": (1.03 * 0.3, 0.3), "slides and tips": (0.8 * 0.3, 0.3)}
    rows, curves = [], {}
    for name, (width, mu) in runs.items():
        run = lab.run(name.replace(" ", "_"), {"contact.friction": mu}, mesh=scene(width))
        times, angle, slip = motion(run)
        lean = THETA - np.arctan(width)
        curves[name] = times, angle, slip
        late = times > times[-1] / 2
        acceleration = 2 * np.polyfit(times[late], slip[late], 2)[0] / gravity
        rows.append([name, width / steep, mu, np.degrees(lean), np.degrees(angle[-1]), np.degrees(np.abs(angle).max()), acceleration])
        if name == "tips":
            exact = np.sqrt(3 * gravity / np.hypot(width, 1) * (np.cos(lean) - np.cos(lean + angle)))
            history = run.history
            bent = history["internal_energy"][history["time"] < 50].max() / history["kinetic_energy"][-1]
            # The energy of bending may come on top: half of it in the velocity.
            lab.check(np.gradient(angle, times)[-2], exact[-2], bent, "")
            lab.require(angle[-1] > 3 * abs(lean), "tips")
        elif name == "stands":
            # At alpha = beta - theta the centre would stand above the edge.
            lab.check(np.abs(angle).max() / -lean, 0, 0.5, "stands")
        elif name == "slides":
            lab.check(acceleration, np.sin(THETA) - mu * np.cos(THETA), 0.005, "slides")  # as V8
            lab.check(np.abs(angle).max() / (np.arctan(width) - np.arctan(mu)), 0, 0.5, "slides_upright")
        else:
            lab.require(angle[-1] > np.radians(10) and acceleration > 0, "slides_and_tips")
    lab.table("Angles in degrees; acceleration down the slope over g:",
              ["", "width / (height tan theta)", "mu", "theta - beta", "rotation at the end", "largest rotation", "acceleration"], rows)
    with lab.figure("Rotation; distance down the slope", panels=2) as (rotations, distances):
        for name, (times, angle, slip) in curves.items():
            rotations.plot(times, np.degrees(angle), label=name, linewidth=1)
            distances.plot(times, slip, label=name, linewidth=1)
        rotations.set(xlabel="t c/height", ylabel="degrees", ylim=(-1, 10))
        distances.set(xlabel="t c/height", ylabel="distance / height", ylim=(-0.02, 0.15))
