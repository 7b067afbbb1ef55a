"""H6: Two cubes of 4 x 4 x 4 elements meet edge to edge at 0.02 c. The edges cross in the middle of
an element of both, where node-to-face contact acts only half an element later. A force must act
before they overlap by 0.1 elements, and the energy must not jump. At small angles a node penetrates
early, and node-to-face contact takes over from the edges."""
from _first_force import HEADER, check_all, draw, meet, row
from _hard import Block, turned

NAME = "H6"
TITLE = "edge on edge"
DECK = "h06_edge_on_edge.toml"
SECONDS = 15
MIDDLE = 0.125  # middle of the element next to the middle of the edge, which is a node


def crossed(degrees):
    """A cube with an edge up along x, and one above it with an edge down, rotated by `degrees`; the
    edges cross in the middle of an element of both."""
    turn = turned(("x", 45), ("z", degrees))
    return Block("low", turn=turned(("x", 45))), Block("high", turn @ (MIDDLE, 0, 0) + (MIDDLE, 0, 0), turn)


def evaluate(lab):
    angles = (90, 20) if lab.quick else (90, 60, 45, 30, 20, 10, 5)
    found = {f"{angle} degrees": meet(lab, f"at{angle}", *crossed(angle)) for angle in angles}
    check_all(lab, found)
    without = {f"{angle} degrees": meet(lab, f"at{angle}_without", *crossed(angle), {"contact.edges": False})
               for angle in angles}
    # The case must need edge-to-edge contact: node-to-face contact alone acts late.
    lab.check(without["90 degrees"].depth, 0.5, 0.2, "late_without_edges")
    lab.table("By angle:", HEADER, [row(*item) for item in found.items()])
    lab.table("With `contact.edges = false`:", HEADER, [row(*item) for item in without.items()])
    draw(lab, found)
