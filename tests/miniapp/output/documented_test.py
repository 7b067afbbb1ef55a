#!/usr/bin/python3
"""Each key of report.json and search.json, column of history.csv and variable of the Exodus file stands in miniapp/output.md;
report.json and search.json have the form of their schemas.

usage: documented_test.py BRICKWALL
"""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import netCDF4

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tests" / "support"))
from json_schema import faults_of  # noqa: E402
PROGRAM = sys.argv.pop(1)
# Every optional column, variable and key: friction, damping, edges, viscosity, audits, a step that is cut.
ALL_OUTPUT = ["output.interval=1e-3", "contact.damping=0.3",
              "output.fields=['displacement','velocity','force_contact','contact_status','contact_gap','contact_pressure','slip_velocity','slip_distance',"
              "'stress','pressure','energy_density','von_mises','principal_stress','strain_energy','candidate_pairs','search_time','brick_id','processor_id']", "damping.mass=1.0", "viscosity.linear=0.06",
              "search.audit=10", "wall.gap=0.05", "gravity.acceleration=[0,0,-2000]", "time.end=0.02"]


def words(section):
    """The names between backticks of a section of the page; `a_x, _y` are a_x and a_y."""
    text = re.search(rf"^## {section}.*?(?=^## |\Z)", (ROOT / "miniapp/output.md").read_text(), re.MULTILINE | re.DOTALL)[0]
    found = set()
    for quoted in re.findall(r"`([^`]+)`", text):
        names = quoted.split(", ")
        stem = names[0][:names[0].rfind("_")]
        found.update(stem + name if name.startswith("_") else name for name in names)
        if quoted.endswith("_"):
            found.update(quoted + axis for axis in "xyz")
    return found


def exodus_variables():
    """From the tables of fields: each name of the first column with each suffix of the second."""
    section = re.search(r"^## Exodus variables.*?(?=^## |\Z)", (ROOT / "miniapp/output.md").read_text(), re.MULTILINE | re.DOTALL)[0]
    found = set()
    for fields, suffixes in re.findall(r"^\| (`[^|]*) \| ([^|]*)\|", section, re.MULTILINE):
        for field in re.findall(r"`(\w+)`", fields):
            found.update(field + suffix for suffix in re.findall(r"_\w+", suffixes) or [""])
    return found


def keys(json_value):
    if isinstance(json_value, dict):
        return set(json_value).union(*map(keys, json_value.values()))
    return set().union(*map(keys, json_value)) if isinstance(json_value, list) else set()


class OutputPage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, command, deck, settings, *more):
        options = [word for setting in settings for word in ("--set", setting)]
        subprocess.run([PROGRAM, command, ROOT / "inputs" / deck, "-o", self.folder, "-q", *options, *more], check=True, timeout=100)

    def test_names_all_that_a_run_writes(self):
        self.run_program("run", "tutorials/falling_stack.toml", ALL_OUTPUT)
        report = json.loads((self.folder / "report.json").read_text())
        self.assertGreater(len(report["time_step"]["cuts"]), 0)
        self.assertEqual(keys(report) - words("report.json"), set())
        self.assertEqual(faults_of(report, "miniapp/output/report.schema.json"), [])
        with open(self.folder / "history.csv", encoding="utf-8") as file:
            self.assertEqual(set(next(csv.reader(file))) - words("Columns of history.csv"), set())
        with netCDF4.Dataset(self.folder / "falling_stack.exo") as file:
            for kind in ("nod", "elem"):
                names = {row.tobytes().decode().rstrip("\0 ") for row in file[f"name_{kind}_var"][:].filled(b"\0")}
                self.assertEqual(names - exodus_variables(), set())

    def test_a_run_without_contact_has_the_form_of_the_schema(self):
        self.run_program("run", "one_brick.toml", ["time.steps=5", "contact.enabled=false"])
        report = json.loads((self.folder / "report.json").read_text())
        self.assertEqual(faults_of(report, "miniapp/output/report.schema.json"), [])
        for part in (report, report["fom"], report["phases"][0], report["balance"]):  # a key of another name
            name, value = part.popitem()
            part["renamed"] = value
            self.assertGreater(len(faults_of(report, "miniapp/output/report.schema.json")), 0, name)
            del part["renamed"]
            part[name] = value
        report["steps"] = "5"
        self.assertIn("steps: '5' is not of type 'integer'", faults_of(report, "miniapp/output/report.schema.json"))

    def test_names_all_that_a_search_writes(self):
        for timing in ("normal", "paper"):
            self.run_program("search", "brick_wall.toml", ["search.repetitions=1", "search.warmup=0"], "--timing", timing)
            report = json.loads((self.folder / "search.json").read_text())
            self.assertEqual(keys(report) - words("search.json") - words("report.json"), set())
            self.assertEqual(faults_of(report, "miniapp/output/search.schema.json"), [])
        report["seconds"]["whole"] = report["seconds"].pop("search")
        self.assertNotEqual(faults_of(report, "miniapp/output/search.schema.json"), [])


if __name__ == "__main__":
    unittest.main()
