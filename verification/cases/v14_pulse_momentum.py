"""V14: A wall under a pressure pulse. The impulse of all external forces, load and reactions of the
fixed course, is the change of momentum: contact and internal forces sum to exactly zero, as
integers. The impulse of the load is that of a half sine on the front face, A p (2 T/pi): each kick
has the mean pressure over its time, so the impulse of a pulse of a tenth of a step is as exact."""
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
    # Means have rounding errors, and steps those of the clock: 2^-53 of some hundred steps.
    exact = 2 / np.pi * area * pulse["peak"] * pulse["duration"]
    lab.check(abs(load[-1]).max(), exact, 1e-12, "impulse_of_the_load")
    step, share = history["timestep"][0], 0.1
    short = lab.run("short_pulse", {**settings, "load.pressure[0].start": 2.3 * step, "time.end": 4 * step,
                                    "load.pressure[0].duration": share * step}).vector("impulse_load")
    # Each corner load of that one kick, 2/pi share p h^2/4, errs by at most half a quantum, 2^-55 E
    # h^2.
    rounding = 2**-55 * lab.deck["material"]["brick"]["youngs_modulus"] / (share / np.pi / 2 * pulse["peak"])
    lab.check(abs(short[-1]).max() / (share * step), exact / pulse["duration"], rounding,
              "impulse_of_a_tenth_of_a_step")
    lab.check(history["ledger_residual"].max(), 0, 1e-12, "ledger")
    lab.require(history["contacts"].max() > 0, "there_are_contacts")
    # Before the pulse the flush faces must rest, bit by bit.
    waiting = lab.run("before_the_pulse", {**settings, "load.pressure[0].start": 1.0, "time.end": 5e-4}).results
    lab.check(abs(waiting.nodal("displacement")).max(), 0, 0, "rest_without_load")
    with lab.figure("Impulses and momentum across the wall by time") as axes:
        direction = int(abs(load[-1]).argmax())
        for name, values in (("load", load), ("reaction of the fixed course", reaction), ("momentum", momentum)):
            axes.plot(history["time"], values[:, direction], label=name, linewidth=1)
        axes.set(xlabel="t (s)", ylabel="N s")
