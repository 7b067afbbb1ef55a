"""V14: A wall under a pressure pulse. The impulse of all external forces, load and reactions of the fixed course, is
the change of momentum: contact and internal forces sum to exactly zero, as integers. The load's impulse is that of a
half sine on the front face, A p (2 T/pi), by the trapezoidal rule of the time steps: a factor (x/2) / tan(x/2) with x
= pi dt/T."""
import numpy as np

NAME = "V14"
TITLE = "momentum of a wall under a pulse"
DECK = "v14_pulsed_wall.toml"


def evaluate(lab):
    settings = {"wall.bricks": [2, 1, 3]} if lab.quick else {}
    run = lab.run("wall", settings)
    history = run.history
    momentum, load, reaction = (run.vector(name) for name in ("momentum", "impulse_load", "impulse_reaction"))
    gap = np.linalg.norm(load + reaction - momentum, axis=1).max()
    total = np.linalg.norm(load, axis=1).max()
    lab.check(gap / total, 0, 1e-12)

    pulse, wall = lab.deck["load"]["pressure"][0], lab.deck["wall"]
    bricks = settings.get("wall.bricks", wall["bricks"])
    area = bricks[0] * wall["brick"][0] * bricks[2] * wall["brick"][2]
    angle = np.pi * history["timestep"][0] / pulse["duration"]
    exact = 2 / np.pi * area * pulse["peak"] * pulse["duration"] * (angle / 2) / np.tan(angle / 2)
    # The trapezoidal sum is of whole steps; the pulse may end up to one step after the last that it meets: error
    # p (pi/T) dt^2/2 at most, over the whole impulse.
    lab.check(abs(load[-1]).max(), exact, 0.25 * angle**2, "impulse_of_the_load")
    lab.check(history["ledger_residual"].max(), 0, 1e-12, "ledger")
    lab.require(history["contacts"].max() > 0, "there_are_contacts")
    # Before the pulse nothing may stir among the flush faces: not one bit.
    waiting = lab.run("before_the_pulse", {**settings, "load.pressure[0].start": 1.0, "time.end": 5e-4}).results
    lab.check(abs(waiting.nodal("displacement")).max(), 0, 0, "rest_without_load")
    with lab.figure("Impulses and momentum across the wall by time") as axes:
        direction = int(abs(load[-1]).argmax())
        for name, values in (("load", load), ("reaction of the fixed course", reaction), ("momentum", momentum)):
            axes.plot(history["time"], values[:, direction], label=name, linewidth=1)
        axes.set(xlabel="t (s)", ylabel="N s")
