"""V11: Newton's cradle of five equal blocks (L = c = 1, nu = 0), an extension of V3. If one block
arrives with v0, a compression of a block's length runs through the row, block 1 stops at 2 L/c, and
block 5 leaves with v0 at 5 L/c, without vibration. If two arrive, two leave, the last at 5 L/c and
the one before at 6 L/c. The blocks between rest."""
import numpy as np
from _bars import histories

NAME = "V11"
TITLE = "cradle of five blocks"
DECK = "v11_cradle.toml"


def evaluate(lab):
    v0 = lab.deck["initial"]["velocity"][0]["velocity"][0]
    elements = lab.deck["wall"]["elements"]
    meshes = (10, 20, 40) if lab.quick else (20, 40, 80)
    rows, errors, blocks_by_time = [], {}, {}
    for incoming, exact in ((1, [0, 0, 0, 0, 1]), (2, [0, 0, 0, 1, 1])):
        for n in meshes:
            second = [v0 if incoming == 2 else 0.0, 0.0, 0.0]
            run = lab.run(f"{incoming}_in_n{n}", {"wall.elements": [n, *elements[1:]], "initial.velocity[1].velocity": second})
            blocks = blocks_by_time[incoming] = histories(run.results)
            after = blocks.velocity[:, -1] / v0
            errors[incoming, n] = np.abs(after - exact).max()
            rows.append([incoming, n, *after, run.history["energy_error"][-1]])
        if incoming == 1:
            lab.check(after[4], 1, 0.02)
        lab.check(errors[incoming, meshes[-1]], 0, 0.02, f"{incoming}_in_largest_error")
        lab.check_order([1 / n for n in meshes], [errors[incoming, n] for n in meshes], 0.6, f"{incoming}_in_order", 1)
    lab.table("Final velocities over v0:",
              ["arrive", "elements a block", *(f"v{b}" for b in range(1, 6)), "energy error"], rows)
    with lab.figure("Mean velocities of the blocks by time: one arrives, two arrive", panels=2) as panels:
        for axes, blocks in zip(panels, blocks_by_time.values()):
            for bar, velocity in enumerate(blocks.velocity):
                axes.plot(blocks.times, velocity / v0, label=f"block {bar + 1}", linewidth=1)
            axes.set(xlabel="t c/L", ylabel="v / v0")
