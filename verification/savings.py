#!/usr/bin/env python3
"""The time that skipped work saves: `./run.sh --study savings`.

The program skips work that a scene does not need (`skipped` in report.json). The study restores
each part by its deck key, one at a time. The bits must be the same: history.csv, all Exodus fields,
and the checksums of nodes and contacts. The times of the loop are medians of runs that take turns;
the saving is 1 - (time with all parts skipped)/(time with the part restored)."""
import datetime
import shutil
import statistics
import sys
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT))
from framework.needed import need

need("netCDF4")
from brickwall_study import machine
from brickwall_study.options import positive
from framework import report
from framework.bits import different_bits, history_text
from framework.options import add_run_options, study_parser
from framework.program import Program, ProgramError

INPUTS = ROOT.parent / "inputs"
RESTING = ("elements of bodies at rest", {"skip.resting_bodies": False})
STATIONARY = ("contact of stationary surfaces", {"skip.stationary_contact": False})
LATTICES = ("connectivity of lattices", {"skip.lattices": False})
SELF = ("contact of a body with itself", {"contact.self": "always"})
FREE = ("forces of free bricks", {"skip.free_bricks": False})
# The bricks of the second wythe are not loaded.
HANGING = {"wall.bricks": [15, 2, 15], "contact.enabled": False, "gravity.acceleration": [0.0, 0.0, -0.001]}
# name, deck, settings of all runs, parts to restore
SCENES = (
    ("default wall", "brick_wall.toml", {"time.steps": 400}, (RESTING, STATIONARY, LATTICES, SELF)),
    ("W(8) under a local pulse", "local_pulse.toml", {"time.steps": 60}, (RESTING, STATIONARY, LATTICES, SELF)),
    ("two wythes that hang, a local pulse on one, no contact", "local_pulse.toml", {**HANGING, "time.steps": 60}, (FREE, LATTICES)),
)
QUICK_SCENES = (
    ("default wall", "brick_wall.toml", {"time.steps": 60}, (RESTING, STATIONARY, LATTICES, SELF)),
    ("small wall under a local pulse", "local_pulse.toml",
     {"wall.bricks": [5, 1, 5], "wall.elements": [4, 2, 2], "load.pressure[0].center": [5.0, 0.0, 2.5],
      "load.pressure[0].radius": 0.5, "time.steps": 25}, (RESTING, STATIONARY, LATTICES, SELF)),
    ("small wythes that hang, no contact", "local_pulse.toml",
     {**HANGING, "wall.bricks": [5, 2, 5], "wall.elements": [8, 4, 4], "time.steps": 25}, (FREE, LATTICES)),
)


def parse_arguments():
    parser = study_parser("savings", __doc__)
    add_run_options(parser, "savings", "small scenes, once each, as in ctest: compares bits only",
                    "copy the report to verification/savings.md")
    parser.add_argument("--repetitions", type=positive, help="runs of each case; the median counts (default 5)")
    arguments = parser.parse_args()
    if arguments.repetitions is None:
        arguments.repetitions = 1 if arguments.quick else 5
    return arguments


def differences(skipped, whole):
    """The differences between two runs, as a list of words."""
    count, differing = different_bits(skipped.results, whole.results)
    found = [f"{differing} of {count} values of the Exodus file"] if differing else []
    if history_text(skipped.folder / "history.csv") != history_text(whole.folder / "history.csv"):
        found.append("history.csv")
    for name, value in skipped.report["checksums"].items():
        if whole.report["checksums"][name] != value:
            found.append(f"checksum of {name}")
    return found


def share_of(run, key):
    shares = [part["share"] for part in run.report["skipped"] if part["key"] == key]
    return f"{100 * shares[0]:.1f} %" if shares else ""


def compare(program, arguments, number, scene):
    """The rows of a scene's table, the number of parts that change bits, and one report. Runs take
    turns, so that load of the machine affects all of them alike."""
    name, deck, settings, parts = scene
    ways = (("", {}),) + parts
    runs, first = {way: [] for way, _ in ways}, {}
    for turn in range(arguments.repetitions):
        for place, (way, more) in enumerate(ways):
            folder = arguments.output / "runs" / f"{number}_{place}_{turn}"
            done = program.run(INPUTS / deck, folder, {**settings, **more})
            runs[way].append(done.report)
            if turn == 0:
                first[way] = done
            else:
                shutil.rmtree(folder)
    # Times of single runs scatter by an unknown amount, so they are not compared.
    may_compare = arguments.repetitions > 1
    seconds = {way: statistics.median(one["loop_seconds"] for one in done) for way, done in runs.items()}
    rows, failed = [], 0
    for way, more in parts:
        found = differences(first[""], first[way])
        failed += bool(found)
        saved = f"{100 * (1 - seconds[''] / seconds[way]):.1f} %" if may_compare else "one run each: unknown scatter"
        rows.append([way, next(iter(more)), share_of(first[""], next(iter(more))), seconds[""], seconds[way], saved,
                     "differ: " + ", ".join(found) if found else "the same"])
        saving = f"{saved} saved, " if may_compare else ""
        print(f"{name}: {way}: {saving}bits {rows[-1][6]}", flush=True)
    return rows, failed, first[""].report


def main():
    arguments = parse_arguments()
    program = Program(Path(arguments.run_sh), Path(arguments.program), arguments.ranks, arguments.threads)
    shutil.rmtree(arguments.output / "runs", ignore_errors=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    text, failed = ["# The time that skipped work saves\n"], 0
    text.append(f"Written by `./run.sh --study savings --keep`. {' '.join(__doc__.split(chr(10), 1)[1].split())}\n")
    try:
        for number, scene in enumerate(QUICK_SCENES if arguments.quick else SCENES):
            rows, bad, program_report = compare(program, arguments, number, scene)
            failed += bad
            text.append(f"## {scene[0]}\n\n" + report.table(
                ["part restored", "key", "share skipped", "loop, s", "loop with the part, s", "saved", "bits"], rows))
    except ProgramError as error:
        print(f"FAIL: {error}")
        return 1
    study = {"machine": machine.describe(), "program": program_report, "ranks": arguments.ranks, "threads": arguments.threads,
             "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")}
    how = f"medians of {arguments.repetitions} runs" if arguments.repetitions > 1 else "one run each"
    text.insert(1, f"{report.headline(study)}; {how}.\n")
    (arguments.output / "savings.md").write_text("\n".join(text))
    if arguments.keep:
        (ROOT / "savings.md").write_text("\n".join(text))
    print("FAIL: bits differ" if failed else "PASS")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
