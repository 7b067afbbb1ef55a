"""V6: The contact patch test: two unit cubes at rest, the lower one on rollers, the upper one under
a uniform pressure p. The exact stress is sigma_zz = -p everywhere, for any meshes that meet at the
joint, also if the upper cube stands on a fixed plate of elements that are turned about the vertical
axis. Elements inside the joint that are no parallelograms have no exact areas of contact."""
import numpy as np
from framework.meshes import box, together

NAME = "V6"
TITLE = "contact patch test"
DECK = "v06_contact_patch.toml"
SECONDS = 10


def two_cubes(lower, upper):
    return together(box((1, 1, 1), (lower,) * 3, name="lower"), box((1, 1, 1), (upper,) * 3, (0, 0, 1), "upper"))


def turned_plate(lower, upper, degrees):
    """A cube off the centre of a plate with `lower` elements a unit, turned by `degrees`."""
    angle, centre = np.radians(degrees), np.array([0.513, 0.493, 0])
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    plate = box((2, 2, 1 / lower), (2 * lower, 2 * lower, 1), (-1, -1, 1 - 1 / lower), "lower")
    plate = plate.mapped(lambda nodes: nodes @ turn.T + centre)
    plate.node_sets["plate"] = np.arange(len(plate.nodes))
    return together(plate, box((1, 1, 1), (upper,) * 3, (0, 0, 1), "upper"))


def bent(mesh, bend):
    """Moves nodes within the cubes sideways, against each other in the joint, by up to `bend`."""
    def image(nodes):
        x, y, z = nodes.T
        shape = bend * np.sin(np.pi * x) * np.sin(np.pi * y)
        side = np.where(np.arange(len(nodes)) < mesh.hexes[:mesh.blocks["lower"]].max() + 1, 1, -1)
        return np.stack([x + side * shape, y - side * shape / 2, z], axis=1)
    return mesh.mapped(image)


def press(lab, label, mesh, settings=None):
    """(heights of the upper block's elements, or of all; errors of their stress over p; largest
    final speed over p/(rho c))."""
    results = lab.run(label, settings, mesh=mesh).results
    pressure = lab.deck["load"]["pressure"][0]["peak"]
    return (results.centroids()[:, 2], results.element("stress_zz") / pressure + 1,
            np.abs(results.nodal("velocity")).max() / pressure)


def press_on_plate(lab, lower, upper, degrees):
    """As press(), of the upper block: the plate is fixed, and not under uniform stress."""
    z, error, speed = press(lab, f"{lower}to{upper}_at{degrees}", turned_plate(lower, upper, degrees),
                            {"boundary.fixed[0].node_set": "plate"})
    return z[-upper**3:], error[-upper**3:], speed


def evaluate(lab):
    pairs = [(3, 3), (3, 4), (2, 7)] if lab.quick else \
        [(6, 6), (2, 4), (3, 4), (6, 8), (9, 12), (4, 3), (8, 6), (1, 3), (2, 3), (3, 5), (5, 2), (3, 8), (2, 7)]
    turns = [(3, 4, 30)] if lab.quick else [(3, 3, 20), (3, 4, 0), (3, 4, 10), (3, 4, 30), (4, 4, 45), (2, 5, 25), (3, 8, 17)]
    pressed = {f"{lower}:{upper}": press(lab, f"{lower}to{upper}", two_cubes(lower, upper)) for lower, upper in pairs}
    turned = {f"{lower}:{upper}, {degrees} degrees": press_on_plate(lab, lower, upper, degrees)
              for lower, upper, degrees in turns}
    no_parallelograms = press(lab, "bent", bent(two_cubes(3, 4), 0.1))
    # With nu = 0 and row sums, whose ratio to the stiffness is the same at all nodes of a layer, the
    # motion is one-dimensional.
    straight = press(lab, "nu0", two_cubes(*pairs[0]),
                     {"material.lower.poissons_ratio": 0.0, "material.upper.poissons_ratio": 0.0,
                      "element.mass": "row_sum"})
    largest = {name: np.abs(error).max() for name, (_, error, _) in (pressed | turned).items()}
    matching = next(iter(pressed))
    # Nodal forces are exact to 1e-3 (find_joint_areas.cpp).
    lab.check(max(largest[name] for name in pressed if name != matching), 0, 0.001)
    lab.check(max(largest[name] for name in turned), 0, 0.002, "turned")
    lab.check(np.abs(no_parallelograms[1]).max(), 0, 0.02, "no_parallelograms")
    lab.check(np.abs(straight[1]).max(), 0, 1e-9, "matching_nu_0")  # the motion that remains after damping
    # While the blocks oscillate, contacts transfer between faces that differ by the strain p/E;
    # offsets of that order remain.
    lab.check(largest[matching], 0, lab.deck["load"]["pressure"][0]["peak"], "matching")
    lab.check(max(speed for _, _, speed in (pressed | turned).values()), 0, 1e-4, "at_rest")
    everything = {**pressed, **turned, "3:4, bent elements": no_parallelograms}
    lab.table("Error of sigma_zz over p:", ["elements, lower : upper", "largest", "root mean square", "final speed"],
              [[name, np.abs(error).max(), np.sqrt(np.mean(error**2)), speed]
               for name, (_, error, speed) in everything.items()])
    with lab.figure("Error of sigma_zz in each element by height; the joint is at z = 1") as axes:
        for name, (z, error, _) in pressed.items():
            axes.plot(z, error, ".", label=name, markersize=4)
        axes.set(xlabel="z", ylabel="sigma_zz / p + 1")
