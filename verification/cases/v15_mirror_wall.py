"""V15: A wall that is its own mirror image stays so under a uniform pulse: u_x changes its sign
under x -> L - x, u_y and u_z do not. Sums of floating-point numbers at mirrored places round
differently (1e-16 m here), so the symmetry holds until a contact is so marginal that rounding decides
it on one side only. From that step on, the contact status of mirrored nodes differs. Until then nodes
above a corner of four bent faces are in contact with one of them, chosen by number: a difference of
second order in the strains (V9). Nothing else breaks the symmetry by more than 1 % of this: the wall's mirror image, numbered as the wall, moves as the image
of the wall, but for rounding."""
import numpy as np
from framework.exodus import HEX_SIDES
from framework.meshes import Mesh

NAME = "V15"
TITLE = "mirror symmetry of a wall"
DECK = "v14_pulsed_wall.toml"
MIRROR = np.array([-1.0, 1.0, 1.0])


class Mirror:
    """Sums over the nodes at one place, of which touching bricks have several, and over those at
    the mirrored place."""

    def __init__(self, nodes, length):
        places = np.round(nodes / 1e-6).astype(np.int64)
        keys, self.place_of_node = np.unique(places, axis=0, return_inverse=True)
        mirrored = np.stack([round(length / 1e-6) - keys[:, 0], keys[:, 1], keys[:, 2]], axis=1)
        number = {tuple(key): place for place, key in enumerate(keys)}
        self.image = np.array([number[tuple(key)] for key in mirrored])

    def sums(self, values):
        sums = np.zeros((len(self.image), values.shape[1]))
        np.add.at(sums, self.place_of_node, values)
        return sums

    def difference(self, values, signs):
        sums = self.sums(values)
        return np.abs(sums - signs * sums[self.image]).max()


def mirror_image(results, length, course):
    """The mesh of the wall under x -> L - x: nodes and elements have the numbers of their originals."""
    nodes = (results.nodes - [length, 0, 0]) * MIRROR
    hexes = results.hexes[:, [1, 0, 3, 2, 5, 4, 7, 6]]  # volumes stay positive
    front = [(element, side) for side, corners in enumerate(HEX_SIDES)
             for element in np.flatnonzero((nodes[hexes[:, corners], 1] == nodes[:, 1].min()).all(axis=1))]
    lowest = hexes[nodes[hexes, 2].max(axis=1) < 1.001 * course]
    return Mesh(nodes, hexes, dict(zip(results.block_names, map(len, results.hexes_of_block))),
                {"base_course": np.unique(lowest)}, {"front": np.array(sorted(front))})


def run_image(lab, settings, mesh):
    """Runs the deck with a mesh in place of its wall."""
    before, after = lab.deck_path.read_text().split("[wall]")
    deck = lab.folder / "image.toml"
    deck.write_text(before + '[mesh]\nfile = "mesh.exo"\n\n' + after[after.index("[material"):])
    settings = {key: value for key, value in settings.items() if not key.startswith("wall.")}
    return lab.run("image", settings, deck=deck, mesh=mesh).results


def evaluate(lab):
    wall = lab.deck["wall"]
    settings = {"wall.bricks": [2, 1, 3]} if lab.quick else {"time.end": 5e-3}
    results = lab.run("wall", settings).results
    length = settings.get("wall.bricks", wall["bricks"])[0] * wall["brick"][0]
    mirror = Mirror(results.nodes, length)
    steps = range(len(results.times))
    gaps = np.array([mirror.difference(results.nodal("displacement", step), MIRROR) for step in steps]) / wall["brick"][0]
    same_contacts = [mirror.difference(results.nodal("contact_status", step)[:, None], 1) == 0 for step in steps]
    last_same = np.argmin(same_contacts) - 1 if not all(same_contacts) else len(gaps) - 1
    largest = np.abs(results.nodal("displacement", last_same)).max()
    lab.check(gaps[:last_same + 1].max(), 0, 1e-8)
    lab.check(results.times[last_same], 1.25e-3, 0, "symmetric_until", error=max(0, 1.25e-3 - results.times[last_same]))
    image = run_image(lab, settings, mirror_image(results, length, wall["brick"][2]))
    of_image = max(np.abs(results.nodal("displacement", step) - MIRROR * image.nodal("displacement", step)).max()
                   for step in range(last_same + 1))
    # Coordinates L - x are rounded, and the difference grows with the time, as any does in contact.
    lab.check(of_image / wall["brick"][0] / gaps[:last_same + 1].max(), 0, 0.01, "share_of_other_causes")
    lab.require(largest > 1e-3, "the_wall_has_moved")
    lab.note(f"The contacts of mirrored nodes are the same up to t = {results.times[last_same]:.3g} s of "
             f"{results.times[-1]:.3g} s; displacements are then {largest:.2g} m.")
    with lab.figure("Difference of mirrored displacements over a brick's length, by time") as axes:
        axes.semilogy(results.times, np.maximum(gaps, 1e-17))
        axes.axvline(results.times[last_same], color="#8a8a8a", linestyle=":", label="contacts are the same up to here")
        axes.set(xlabel="t (s)", ylabel="difference / brick length")
