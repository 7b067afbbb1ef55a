#!/usr/bin/python3
"""The same bits on any layout: `./run.sh --study same-bits`.

Runs the default wall on all numbers of ranks and threads, with a search in every step and with kept
lists, each twice, and compares every run with the first: all bits of mesh, times and variables of
the joined Exodus file (also by exodiff at tolerance 0 if it is installed), history.csv byte by
byte, and the checksums in report.json of all nodes and of the contact history. Only the number of
searches may differ where lists are kept. Prints a line for each run and writes a report; the exit
code is 1 if any run differs.
"""
import datetime
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT))
from framework.needed import need

need("netCDF4")
from brickwall_study import machine
from brickwall_study.options import positive_list
from framework import report
from framework.bits import different_bits, history_text
from framework.options import add_run_options, study_parser
from framework.program import Program, ProgramError

DECK = ROOT.parent / "inputs" / "brick_wall.toml"
SEARCHES = ("searches",)  # the global variables that kept lists change
EXODIFF_RULES = """DEFAULT TOLERANCE relative 0.0 floor 0.0
COORDINATES absolute 0.0
TIME STEPS relative 0.0
GLOBAL VARIABLES (all)
\t!searches
NODAL VARIABLES (all)
ELEMENT VARIABLES (all)
"""


@dataclass(frozen=True)
class Layout:
    ranks: int
    threads: int
    margin: float
    turn: int  # 1: the first run, 2: the second, ...

    @property
    def keeps_lists(self):
        return self.margin > 0

    def __str__(self):
        how = f"lists kept, margin {self.margin:g}" if self.keeps_lists else "search every step"
        return f"{self.ranks} x {self.threads}, {how}, run {self.turn}"

    @property
    def folder(self):
        return f"{self.ranks}x{self.threads}_{'kept' if self.keeps_lists else 'every'}_{self.turn}"


def parse_arguments():
    parser = study_parser("same-bits", __doc__)
    add_run_options(parser, "same-bits", "60 steps, 1 and 3 ranks, once each, as in ctest",
                    "copy the report to verification/same_bits.md", counts=False)
    parser.add_argument("-n", "--ranks", type=positive_list, help="list of MPI ranks (default 1,2,3,4,7)")
    parser.add_argument("-t", "--threads", type=positive_list, help="list of threads of each rank (default 1,2)")
    parser.add_argument("--steps", type=int, help="steps of each run (default 2000)")
    parser.add_argument("--margin", type=float, help="search.reuse.margin of the runs with kept lists (default 0.1)")
    parser.add_argument("--turns", type=int, help="number of times that each run is made (default 2)")
    arguments = parser.parse_args()
    usual = {"steps": 60, "ranks": [1, 3], "threads": [1, 2], "margin": 5e-4, "turns": 1} if arguments.quick else \
            {"steps": 2000, "ranks": [1, 2, 3, 4, 7], "threads": [1, 2], "margin": 0.1, "turns": 2}
    for name, value in usual.items():
        if getattr(arguments, name) is None:
            setattr(arguments, name, value)
    return arguments


def find_exodiff(program):
    cache = Path(program).resolve().parent.parent / "CMakeCache.txt"
    for line in cache.read_text().splitlines() if cache.exists() else ():
        if line.startswith("BRICKWALL_EXODIFF:") and Path(line.split("=", 1)[1]).is_file():
            return line.split("=", 1)[1]
    return shutil.which("exodiff")


def run(program, arguments, layout):
    """The end time lies beyond the last step, whose length is about 6 us. There are 80 outputs, and
    a row of history.csv about every other step."""
    settings = {"time.end": 2e-5 * arguments.steps, "time.steps": arguments.steps,
                "output.interval": 2.5e-7 * arguments.steps, "output.history_interval": 1e-5,
                "search.reuse.margin": layout.margin, "limits.energy_error": 10.0}
    return program.run(DECK, arguments.output / "runs" / layout.folder, settings, ranks=layout.ranks, threads=layout.threads)


def differences(first, other, layout, exodiff):
    """(values compared, list of differences in words)."""
    without = SEARCHES if layout.keeps_lists else ()
    count, differing = different_bits(first.results, other.results, without)
    found = [f"{differing} values of the Exodus file"] if differing else []
    if exodiff:
        rules = other.folder / "exodiff.rules"
        rules.write_text(EXODIFF_RULES)
        how = ["-f", str(rules)] if layout.keeps_lists else ["-tolerance", "0", "-Floor", "0"]
        files = [str(one.folder / f"{one.name}.exo") for one in (first, other)]
        with open(other.folder / "exodiff.log", "w") as log:
            if subprocess.run([exodiff, *how, *files], stdout=log, stderr=subprocess.STDOUT, check=False).returncode != 0:
                found.append("exodiff")
    if history_text(first.folder / "history.csv", without) != history_text(other.folder / "history.csv", without):
        found.append("history.csv")
    for name, value in first.report["checksums"].items():
        if other.report["checksums"][name] != value:
            found.append(f"checksum of {name}")
    if layout.keeps_lists and not 1 < other.report["search"]["searches"] < other.report["steps"] / 2:
        found.append(f"lists were not kept: {other.report['search']['searches']} searches")
    return count, found


def compare_all(program, arguments, exodiff):
    """(first run, rows of the report, number of runs that differ)."""
    layouts = [Layout(ranks, threads, margin, turn) for turn in range(1, arguments.turns + 1) for margin in (0.0, arguments.margin)
               for ranks in arguments.ranks for threads in arguments.threads]
    first, rows, failed = None, [], 0
    for layout in layouts:
        begin = time.monotonic()
        try:
            done = run(program, arguments, layout)
            first = first or done
            count, found = differences(first, done, layout, exodiff)
        except ProgramError as error:
            done, count, found = None, 0, [f"failed: {error}"]
        seconds = time.monotonic() - begin
        sums = done.report["checksums"] if done else {"nodes": "", "contacts": "", "interactions": ""}
        verdict = "DIFFERS: " + ", ".join(found) if found else "same bits"
        failed += bool(found)
        print(f"{layout}: {verdict}; {count} values, nodes {sums['nodes']}, contacts {sums['contacts']} "
              f"({sums['interactions']}), {seconds:.0f} s", flush=True)
        rows.append([layout.ranks, layout.threads, layout.margin, layout.turn, done.report["search"]["searches"] if done else "",
                     count, sums["nodes"], sums["contacts"], sums["interactions"], verdict])
        if done and done is not first and not found:
            shutil.rmtree(done.folder)  # equal to the first run
        if first is None:
            break
    return first, rows, failed


def write_report(path, first, rows, failed, seconds, exodiff):
    study = {"machine": machine.describe(), "program": first.report if first else {}, "ranks": 1, "threads": 1,
             "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")}
    steps = first.report["steps"] if first else 0
    path.write_text(
        f"# The same bits\n\nWritten by `./run.sh --study same-bits`: {len(rows) - failed} of {len(rows)} runs of "
        f"`inputs/{DECK.name}`, {steps} steps each, have the same bits as the first, in {seconds:.0f} s. "
        f"{report.headline(study).rsplit('; ', 1)[0]}.\n\nCompared: all bits of mesh, times and variables of the joined Exodus files"
        f"{', exodiff at tolerance 0' if exodiff else ''}, history.csv, checksums of the displacements and velocities of all nodes "
        f"and of the contact history at the end. Runs with a margin are compared without the column `searches`.\n\n"
        + report.table(["ranks", "threads", "margin", "run", "searches", "values compared", "nodes", "contacts", "interactions",
                        ""], rows))


def main():
    arguments = parse_arguments()
    shutil.rmtree(arguments.output / "runs", ignore_errors=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    exodiff = find_exodiff(arguments.program)
    begin = time.monotonic()
    first, rows, failed = compare_all(Program(arguments.run_sh, arguments.program), arguments, exodiff)
    path = arguments.output / "report.md"
    write_report(path, first, rows, failed, time.monotonic() - begin, exodiff)
    print(f"{'FAIL' if failed else 'PASS'}: {len(rows) - failed} of {len(rows)} runs have the same bits\nwrote    {path}")
    if arguments.keep:
        shutil.copy(path, ROOT / "same_bits.md")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
