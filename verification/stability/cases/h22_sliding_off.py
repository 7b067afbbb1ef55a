"""H22: A prescribed top course squeezes frictionless walls until bricks slip out, and slides a
pressed brick off the one below, along an edge and over its corner. Contacts fade beyond one true
edge or two and end there, under forces that grow meanwhile; what they store must come back."""
import numpy as np

NAME = "H22"
TITLE = "bricks that slide off others"
DECK = "h22_sliding_off.toml"
SECONDS = 30
WALLS = {"2 x 2": (2, 1, 2), "2 x 3": (2, 1, 3), "3 x 2 x 4": (3, 2, 4)}
ACROSS = (0.0, 0.05, 0.1, 0.2)


def row_of(name, run):
    history = run.history
    return [name, np.abs(history["energy_error"]).max(), int(history["contacts"].max()), history["max_penetration"].max()]


def squeeze(lab, name, bricks, poisson):
    settings = {"wall.bricks": bricks, "material.brick.poissons_ratio": poisson, "damping.mass": 200.0, "time.end": 0.1,
                "boundary.velocity[0].velocity": (0, 0, -0.5), "boundary.velocity[0].duration": 0.08}
    return row_of(f"{name}, nu = {poisson}", lab.run(f"squeezed_{name.replace(' ', '')}_{poisson}", settings))


def slide(lab, across):
    deck = lab.deck_path.with_name("h22_sliding_brick.toml")
    run = lab.run(f"slides_{across}", {"boundary.velocity[1].velocity": (0.3, across, 0)}, deck=deck)
    return row_of(f"0.3 m/s along, {across} m/s across", run)


def evaluate(lab):
    walls = list(WALLS.items())[:1] if lab.quick else WALLS.items()
    squeezed = [squeeze(lab, name, bricks, poisson) for name, bricks in walls for poisson in ((0.0,) if lab.quick else (0.0, 0.2))]
    sliding = [slide(lab, across) for across in ((0.1,) if lab.quick else ACROSS)]
    lab.check(max(row[1] for row in squeezed), 0, 3e-2)
    lab.check(max(row[1] for row in sliding), 0, 5e-4, "a_brick_that_slides_off")
    lab.table("Walls that are squeezed, and a brick that slides off another:",
              ["scene", "energy, largest", "most contacts", "deepest / face"], squeezed + sliding)
