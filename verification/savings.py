#!/usr/bin/env python3
"""./run.sh --study savings: what leaving out costs nothing and saves.

Each part that the program leaves out by itself because a scene does not need it (`spared` in report.json) is put back by its
deck key, one at a time. The bits must be the same: history.csv, all Exodus fields, and the checksums of nodes and contacts. The
times of the loop are medians of runs that take turns; a saving is 1 less the time with all left out over that with the part put
back."""
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
from framework import machine, report
from framework.bits import different_bits, history_text
from framework.options import study_parser
from framework.program import Program, ProgramError

INPUTS = ROOT.parent / "inputs"
RESTING = ("elements of bodies at rest", {"spare.resting_bodies": False})
STILL = ("contact of what stands still", {"spare.still_contact": False})
LATTICES = ("connectivity of lattices", {"spare.lattices": False})
SELF = ("contact of a body with itself", {"contact.self": "always"})
FREE = ("forces of free bricks", {"spare.free_bricks": False})
# name, deck, settings of all runs, parts to put back
SCENES = (
    ("default wall", "brick_wall.toml", {"time.steps": 400}, (RESTING, STILL, LATTICES, SELF)),
    ("W(8) under a local pulse", "local_pulse.toml", {"time.steps": 60}, (RESTING, STILL, LATTICES, SELF)),
    ("W(8) under a local pulse, no contact", "local_pulse.toml", {"time.steps": 60, "contact.enabled": False}, (FREE, LATTICES)),
)
QUICK_SCENES = (
    ("default wall", "brick_wall.toml", {"time.steps": 60}, (RESTING, STILL, LATTICES, SELF)),
    ("small wall under a local pulse", "local_pulse.toml",
     {"wall.bricks": [5, 1, 5], "wall.elements": [4, 2, 2], "load.pressure[0].center": [5.0, 0.0, 2.5],
      "load.pressure[0].radius": 0.5, "time.steps": 25}, (RESTING, STILL, LATTICES, SELF)),
    ("the same without contact", "local_pulse.toml",
     {"wall.bricks": [5, 1, 5], "wall.elements": [8, 4, 4], "contact.enabled": False, "time.steps": 25}, (FREE, LATTICES)),
)


def parse_arguments():
    parser = study_parser("savings", __doc__)
    parser.add_argument("--quick", action="store_true", help="small scenes, each once, as in ctest: bits only")
    parser.add_argument("--repetitions", type=int, help="runs whose median counts (default 5)")
    parser.add_argument("-n", "--ranks", type=int, default=1, help="of each run (default %(default)s)")
    parser.add_argument("-t", "--threads", type=int, default=1, help="of each rank (default %(default)s)")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/study_savings"), help="folder (default %(default)s)")
    parser.add_argument("--keep", action="store_true", help="copy the report to verification/savings.md")
    arguments = parser.parse_args()
    if arguments.repetitions is None:
        arguments.repetitions = 1 if arguments.quick else 5
    arguments.output = arguments.output.absolute()
    return arguments


def differences(spared, whole):
    """What differs between two runs, in words."""
    count, differing = different_bits(spared.results, whole.results)
    found = [f"{differing} of {count} values of the Exodus file"] if differing else []
    if history_text(spared.folder / "history.csv") != history_text(whole.folder / "history.csv"):
        found.append("history.csv")
    for name, value in spared.report["checksums"].items():
        if whole.report["checksums"][name] != value:
            found.append(f"checksum of {name}")
    return found


def share_of(run, key):
    shares = [part["share"] for part in run.report["spared"] if part["key"] == key]
    return f"{100 * shares[0]:.1f} %" if shares else ""


def compare(program, arguments, number, scene):
    """Rows of a scene's table, how many parts change bits, and one report. Runs take turns, so that a busy spell meets all alike."""
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
    # Times of single runs scatter by nobody knows how much: they are not compared.
    may_compare = arguments.repetitions > 1
    seconds = {way: statistics.median(one["loop_seconds"] for one in done) for way, done in runs.items()}
    rows, failed = [], 0
    for way, more in parts:
        found = differences(first[""], first[way])
        failed += bool(found)
        saved = f"{100 * (1 - seconds[''] / seconds[way]):.1f} %" if may_compare else "one run each, scatter not known"
        rows.append([way, next(iter(more)), share_of(first[""], next(iter(more))), seconds[""], seconds[way], saved,
                     "differ: " + ", ".join(found) if found else "the same"])
        told = f"{saved} saved, " if may_compare else ""
        print(f"{name}: {way}: {told}bits {rows[-1][6]}", flush=True)
    return rows, failed, first[""].report


def main():
    arguments = parse_arguments()
    program = Program(Path(arguments.run_sh), Path(arguments.program), arguments.ranks, arguments.threads)
    shutil.rmtree(arguments.output / "runs", ignore_errors=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    text, failed = ["# What a scene does not need, and what leaving it out saves\n"], 0
    text.append(f"Written by `./run.sh --study savings --keep`. {' '.join(__doc__.split())}\n")
    try:
        for number, scene in enumerate(QUICK_SCENES if arguments.quick else SCENES):
            rows, bad, program_report = compare(program, arguments, number, scene)
            failed += bad
            text.append(f"## {scene[0]}\n\n" + report.table(
                ["put back", "key", "left out, of its kind", "loop, s", "with it, s", "saved", "bits"], rows))
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
