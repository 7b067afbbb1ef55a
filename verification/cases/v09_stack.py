"""V9: Five blocks stand on each other under their weight and come to rest by damping. Joint i
carries the weight above it, (5 - i) m g, whatever the stress in the blocks is. Exact frictionless
blocks do not move sideways. But the weight bends their faces with the curvature nu rho g/E, and a
node above the corner of four faces is in contact with one of them, chosen by number, whose normal
is inclined by the curvature times half an element. A sideways force of that share of the weight is
expected, and creep."""
import numpy as np
from framework.meshes import bodies, box, nodal_masses, together

NAME = "V9"
TITLE = "stack of blocks"
DECK = "v09_stack.toml"


def evaluate(lab):
    count = 3 if lab.quick else 5
    mesh = together(*(box((1, 1, 1), (4, 4, 4), (0, 0, i), sets=str(i + 1)) for i in range(count)))
    run = lab.run("stack", {"time.end": 120.0} if lab.quick else {}, mesh=mesh)
    results = run.results
    masses = nodal_masses(results.nodes, results.hexes)
    blocks = sorted(bodies(len(results.nodes), results.hexes), key=lambda nodes: results.nodes[nodes, 2].mean())
    gravity, material = -lab.deck["gravity"]["acceleration"][2], lab.deck["material"]["block"]
    weight = masses.sum() / count * gravity
    # The contact forces on the blocks above a joint sum to the force in the joint.
    joints = np.array([[results.nodal("force_contact", step)[np.concatenate(blocks[joint:])].sum(axis=0)
                        for joint in range(1, count)] for step in range(len(results.times))])
    exact = weight * np.arange(count - 1, 0, -1)
    for joint, (force, expected) in enumerate(zip(joints[-1, :, 2], exact), 1):
        lab.check(force, expected, 1e-6, f"joint_{joint}" if joint > 1 else "")
    curvature = material["poissons_ratio"] * material["density"] * gravity / material["youngs_modulus"]
    sideways = np.linalg.norm(joints[-1, :, :2], axis=1) / exact
    lab.check(sideways.max(), 0, np.sqrt(2) * curvature / 8, "sideways_force")
    u = results.nodal("displacement")
    velocity = results.nodal("velocity")[:, :2]
    creep = max(np.linalg.norm(masses[nodes] @ velocity[nodes]) / masses[nodes].sum() for nodes in blocks)
    lab.weak_spot(f"frictionless blocks at rest creep sideways: a node above a corner of four bent faces is in contact "
                  f"with one of them. In the stack the force is {sideways.max():.1g} of the weight above and the speed {creep:.1g} c "
                  "with mass-proportional damping; the creep is of second order, strain times element size")
    lab.note(f"The lowest joint moves down by {np.abs(u[blocks[0], 2]).max():.2g} block heights; the deepest "
             f"penetration is {run.history['max_penetration'][-1]:.2g} element edges.")
    with lab.figure("Force in the joints by time, over the weight above") as axes:
        for joint, force in enumerate(joints[:, :, 2].T, 1):
            axes.plot(results.times, force / exact[joint - 1], label=f"joint {joint}", linewidth=1)
        axes.set(xlabel="t c/h", ylabel="force / weight")
