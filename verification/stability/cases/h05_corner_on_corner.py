"""H5: Two cubes of 4 x 4 x 4 elements meet corner to corner at 0.02 c: both upright, both on a
corner, and twisted relative to each other, each with the axes nearly in line and shifted. A force
must act before they overlap by 0.1 elements, and the energy must not jump as corners slide over
faces, over edges and past each other."""
from _first_force import HEADER, check_all, draw, meet, row
from _hard import ON_A_CORNER, Block, turned

NAME = "H5"
TITLE = "corner on corner"
DECK = "h05_corner_on_corner.toml"
SECONDS = 10


def evaluate(lab):
    twists = (0, 60) if lab.quick else (0, 30, 60)
    scenes = {"upright": (Block("low"), Block("high", (0.98, 0.97, 0)))}
    for twist in twists:
        for name, shift in (("in line", (0.003, 0.002, 0)), ("shifted", (0.06, 0.03, 0))):
            scenes[f"on corners, twist {twist}, {name}"] = (
                Block("low", turn=ON_A_CORNER), Block("high", shift, turned(("z", twist)) @ ON_A_CORNER))
    found = {name: meet(lab, name.replace(" ", "_").replace(",", ""), *blocks) for name, blocks in scenes.items()}
    check_all(lab, found)
    lab.table("By scene:", HEADER, [row(*item) for item in found.items()])
    draw(lab, found)
