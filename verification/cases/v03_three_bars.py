"""V3: A bar with velocity v0 hits the first of two equal bars (L = c = rho = 1, nu = 0) that rest
end to end. The compression front of velocity v0/2 passes the middle bar, followed by the relief
wave from the free end of the first. So the first bar stops at 2 L/c, and the last leaves with v0
and without vibration at 3 L/c, when its own relief wave returns."""
import numpy as np
from _bars import crossings, histories
from framework.figures import EXACT

NAME = "V3"
TITLE = "three equal bars"
DECK = "v03_three_bars.toml"


def evaluate(lab):
    v0 = lab.deck["initial"]["velocity"][0]["velocity"][0]
    meshes = (20, 40, 80)
    runs = {n: lab.run(f"n{n}", {"wall.elements": [n, 1, 1]}) for n in meshes}
    bars = {n: histories(run.results) for n, run in runs.items()}
    last = {n: b.velocity[:, -1] / v0 for n, b in bars.items()}
    lab.check(last[80][2], 1, 0.02)
    for bar, name in ((0, "first"), (1, "middle")):
        lab.check(last[80][bar], 0, 0.02, f"{name}_at_rest", error=abs(last[80][bar]))
    # The force on the last bar falls to half its plateau v0/2 when the relief wave returns.
    leaving = [crossings(b.times, b.force[2], 0.25 * v0 * b.mass[2])[-1] for b in bars.values()]
    stopping = [crossings(b.times, -b.force[0], 0.25 * v0 * b.mass[0])[-1] for b in bars.values()]
    lab.check(stopping[-1], 2, 0.02, "first_separates")
    lab.check(leaving[-1], 3, 0.02, "last_separates")
    lab.check_order([1 / n for n in meshes], np.array(leaving) - 3, 0.6, "order_of_last_separation", 1)
    # The rounding of kicks only: contact forces are integers of equal size and opposite sign.
    momentum = max(abs(run.history["momentum_x"] / (v0 * b.mass[0]) - 1).max() for run, b in zip(runs.values(), bars.values()))
    lab.check(momentum, 0, 1e-12, "momentum")

    lab.table("Final velocities over v0, times at which the outer bars separate:",
              ["elements a bar", "v1", "v2", "v3", "first separates, exact 2", "last separates, exact 3"],
              [[n, *last[n], stop, leave] for n, stop, leave in zip(meshes, stopping, leaving)])
    with lab.figure("Mean velocity of the bars by time") as axes:
        exact = {0: ([0, 2, 4], [1, 0, 0]), 1: ([0, 1, 2, 3, 4], [0, 0.5, 0.5, 0, 0]), 2: ([0, 1, 3, 4], [0, 0, 1, 1])}
        for bar, (times, values) in exact.items():
            axes.plot(times, values, label="exact" if bar == 0 else None, **EXACT)
            axes.plot(bars[80].times, bars[80].velocity[bar] / v0, label=f"bar {bar + 1}", linewidth=1)
        axes.set(xlabel="t c/L", ylabel="v / v0")
