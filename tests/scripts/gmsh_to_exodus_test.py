#!/usr/bin/python3
"""inputs/gmsh_to_exodus.py on a mesh of two hexahedra that share no node, and on meshes that Brickwall cannot read.

usage: gmsh_to_exodus_test.py BRICKWALL
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import netCDF4

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = sys.argv.pop(1)
CORNERS = [(0, 0), (1, 0), (1, 1), (0, 1)]
NODES = [f"{10 * body + 4 * level + c + 1} {x} {y} {body + level}" for body in (0, 1) for level in (0, 1) for c, (x, y) in enumerate(CORNERS)]
HEXAHEDRA = ["1 5 2 7 1 1 2 3 4 5 6 7 8", "2 5 2 7 2 11 12 13 14 15 16 17 18"]
TOP, LINE = "3 3 2 9 3 18 17 16 15", "4 1 2 0 4 1 2"  # the side z = 2, in the other direction; a line without a group
DECK = """
[mesh]
file = "part.exo"
[material.stone]
density = 1.0
youngs_modulus = 1.0
poissons_ratio = 0.0
[[load.pressure]]
side_set = "the top"
peak = 1e-3
duration = 0.5
[time]
end = 1.0
"""


def msh(elements, form="2.2 0 8", names=('3 7 "stone"', '2 9 "the top"')):
    blocks = {"MeshFormat": [form], "PhysicalNames": [len(names), *names], "Nodes": [len(NODES), *NODES], "Elements": [len(elements), *elements]}
    return "".join(f"${name}\n" + "".join(f"{line}\n" for line in lines) + f"$End{name}\n" for name, lines in blocks.items())


class GmshToExodus(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def convert(self, text):
        (self.folder / "part.msh").write_text(text)
        return subprocess.run([ROOT / "inputs/gmsh_to_exodus.py", self.folder / "part.msh", self.folder / "part.exo"], capture_output=True,
                              text=True)

    def test_writes_blocks_and_sets_that_brickwall_reads(self):
        result = self.convert(msh(HEXAHEDRA + [TOP, LINE]))
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        with netCDF4.Dataset(self.folder / "part.exo") as file:
            self.assertEqual((file["elem_ss1"][:].tolist(), file["side_ss1"][:].tolist()), ([2], [6]))
            self.assertEqual(file["connect1"][:].tolist(), [list(range(1, 9)), list(range(9, 17))])
            self.assertEqual(file["node_ns1"][:].tolist(), [13, 14, 15, 16])
        (self.folder / "part.toml").write_text(DECK)
        run = subprocess.run([PROGRAM, "run", self.folder / "part.toml", "-o", self.folder / "out"], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        # The pressure pushes down on an area of 1: peak 2 T/pi.
        rows = (self.folder / "out/history.csv").read_text().splitlines()
        impulse = float(rows[-1].split(",")[rows[0].split(",").index("impulse_load_z")])
        self.assertAlmostEqual(impulse / -3.183e-4, 1, delta=2e-3)  # the follower load on an area that strains of 1e-3 change

    def test_keeps_long_names(self):
        name = "a volume whose name has more than 32 characters"
        self.assertEqual(self.convert(msh(HEXAHEDRA, names=(f'3 7 "{name}"',))).returncode, 0)
        with netCDF4.Dataset(self.folder / "part.exo") as file:
            self.assertEqual(netCDF4.chartostring(file["eb_names"][:])[0], name)

    def test_refuses_meshes_that_brickwall_cannot_read(self):
        for text, words in ((msh(HEXAHEDRA, form="4.1 0 8"), "expected 2.2 ASCII"), (msh(["1 4 2 7 1 1 2 3 5"]), "gmsh's type 4"),
                            (msh([TOP]), "found no hexahedra"), (msh(HEXAHEDRA + ["3 3 2 9 3 1 2 3 7"]), "no side of a hexahedron"),
                            (msh(HEXAHEDRA).partition("2 5 2")[0], "too early"), (msh(["1 5 2 7 1 1 2 3"]), "found 8 numbers"), ("", "found no hexahedra"),
                            (msh(HEXAHEDRA[:1] + [HEXAHEDRA[1].rpartition(" ")[0] + " 99"]), "node 99, expected one of $Nodes"),
                            (msh(HEXAHEDRA).partition("1 5 2")[0] + "1\n", "too early")):
            result = self.convert(text)
            self.assertEqual(result.returncode, 2)
            self.assertIn(words, result.stderr)
            self.assertFalse((self.folder / "part.exo").exists())


if __name__ == "__main__":
    unittest.main()
