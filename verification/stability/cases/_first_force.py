"""Common to corner-to-corner and edge-to-edge impacts: two approaching blocks, and their overlap at
the first force."""
from types import SimpleNamespace

import numpy as np
from _hard import depth, energy_change, largest_jump, lifted, mesh_of

SPEED = 0.02
GAP = 0.005  # initial gap, edge lengths


def meet(lab, label, low, high, settings=None):
    """Runs the impact of `high` on `low`. Depths are relative to the element, energies to the
    initial energy."""
    high = lifted(low, high, -GAP)
    element = low.size[0] / low.elements[0]
    run = lab.run(label, {"initial.velocity[0].velocity": [0, 0, -SPEED], **(settings or {})}, mesh=mesh_of(low, high))
    history = run.history
    # Until the first force both blocks are undeformed, so the depth of the boxes is exact.
    pressed = np.flatnonzero(history["contacts"] > 0)
    first = pressed[0] if len(pressed) else len(history["time"]) - 1
    deep = depth(low, high.moved((0, 0, -SPEED * history["time"][first]))) / element
    energy = energy_change(history)
    jump, step = largest_jump(history)
    jump /= run.report["time_step"]["gain"]  # as in a step of the worst element alone
    return SimpleNamespace(history=history, depth=deep if len(pressed) else np.inf, final=energy[-1], energy=energy,
                           largest=np.abs(energy).max(), jump=jump, jump_step=step, deepest=history["max_penetration"].max(),
                           lost=history["lost_contacts"][-1], rebounds=history["momentum_z"][-1] / history["momentum_z"][0])


HEADER = ["scene", "depth at the first force / h", "deepest / h", "energy, final", "energy, largest", "largest in one step",
          "at step", "contacts lost"]


def row(name, found):
    return [name, float(found.depth), found.deepest, found.final, found.largest, found.jump, found.jump_step, int(found.lost)]


def check_all(lab, found):
    """`found`: {name: result of meet}."""
    # They approach by 0.5 % of an element a step; without a force they would overlap by half an
    # element.
    lab.check(max(result.depth for result in found.values()), 0, 0.1)
    # The final threshold is that of oblique impacts (V17) at a tenth of the speed; at any time it
    # is twice that, since corners overlap by half an element where their forces fade out.
    lab.check(max(abs(result.final) for result in found.values()), 0, 5e-3, "final_energy")
    lab.check(max(result.largest for result in found.values()), 0, 1e-2, "energy_over_time")
    lab.check(max(result.lost for result in found.values()), 0, 0, "contacts_lost")
    for name, result in found.items():
        if result.largest > 1e-2:
            lab.weak_spot(f"{name}: {100 * result.jump:.2g} % of the energy is lost in step {result.jump_step}, where a loaded contact ends")


def draw(lab, found):
    with lab.figure("Relative change of the energy by time") as axes:
        for name, result in found.items():
            axes.plot(result.history["time"], result.energy, label=name, linewidth=0.8)
        axes.set(xlabel="t c/edge", ylabel="E/E_0 - 1")
