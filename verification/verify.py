#!/usr/bin/python3
"""Cases with exact or published answers: `./run.sh --study verification` and `--study stability`.

A case is a module in the folder cases/ of its study: a docstring that describes the comparison,
NAME, TITLE, DECK (in decks/) and evaluate(lab), see framework/lab.py. Each case prints one line,
`V7 PASS computed=... exact=... error=... threshold=...`, and its further checks below. The folder
of -o contains report.md, plots/ and all runs.
"""
import argparse
import concurrent.futures
import datetime
import importlib.util
import shutil
import sys
import time
import traceback
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT))
from framework.needed import need

need("matplotlib", "netCDF4")
from brickwall_study import machine
from brickwall_study.options import positive
from framework import report
from framework.checks import Outcome
from framework.lab import Lab
from framework.options import add_run_options, study_parser
from framework.program import Program

# Folder and title of each study.
STUDIES = {"verification": (ROOT, "Cases with exact or published answers"),
           "stability": (ROOT / "stability", "Hard cases: stability and clean failure")}


def parse_arguments():
    name = sys.argv[1] if len(sys.argv) > 1 and sys.argv[1] in STUDIES else "NAME"
    parser = study_parser(name, __doc__)
    parser.add_argument("study", choices=STUDIES, help=argparse.SUPPRESS)
    parser.add_argument("--only", type=lambda text: text.split(","), metavar="V7,V8", help="evaluate these cases only")
    parser.add_argument("-j", "--jobs", type=positive, help="number of concurrent cases (default: cores / (ranks x threads))")
    add_run_options(parser, name, "the short form of each case, as in ctest",
                    "copy report.md and plots/ into the source folder of the study")
    return parser, parser.parse_args()


def load_case(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def find_cases(folder):
    """{name: file}, in the order of the file names. Files that begin with an underscore are helpers
    of several cases."""
    sys.path.insert(0, str(folder / "cases"))
    files = sorted(path for path in (folder / "cases").glob("*.py") if not path.name.startswith("_"))
    return {load_case(path).NAME: path for path in files}


def evaluate(path, folder, arguments):
    """The Outcome of one case; any exception is its failure."""
    case = load_case(path)
    outcome = Outcome(case.NAME, case.TITLE, case.__doc__.split(": ", 1)[-1].strip())
    runs = arguments.output / "runs" / path.stem
    shutil.rmtree(runs, ignore_errors=True)
    runs.mkdir(parents=True)
    program = Program(arguments.run_sh, arguments.program, arguments.ranks, arguments.threads)
    begin = time.monotonic()
    try:
        case.evaluate(Lab(program, folder / "decks" / case.DECK, runs, arguments.output / "plots", outcome, arguments.quick))
    except Exception as error:
        outcome.failure = f"{type(error).__name__}: {error}"
        (runs / "traceback.txt").write_text(traceback.format_exc())
    outcome.seconds = time.monotonic() - begin
    return outcome


def evaluate_all(cases, folder, arguments):
    """Outcomes in the order of `cases`. Prints the lines of each case when it ends."""
    jobs = arguments.jobs or max(1, machine.physical_cores() // (arguments.ranks * arguments.threads))
    outcomes = {}
    with concurrent.futures.ProcessPoolExecutor(max_workers=jobs) as pool:
        # Long cases start first, so that none of them delays the end.
        order = sorted(cases, key=lambda name: -getattr(load_case(cases[name]), "SECONDS", 0))
        futures = {pool.submit(evaluate, cases[name], folder, arguments): name for name in order}
        for future in concurrent.futures.as_completed(futures):
            outcome = outcomes[futures[future]] = future.result()
            print("\n".join(outcome.lines()), flush=True)
    return [outcomes[name] for name in cases]


def main():
    parser, arguments = parse_arguments()
    folder, title = STUDIES[arguments.study]
    cases = find_cases(folder)
    unknown = [name for name in arguments.only or () if name not in cases]
    if unknown:
        parser.error(f"unknown case {unknown[0]}; known cases: {', '.join(cases)}")
    cases = {name: path for name, path in cases.items() if not arguments.only or name in arguments.only}
    begin = time.monotonic()
    outcomes = evaluate_all(cases, folder, arguments)
    study = {"title": title, "name": arguments.study, "machine": machine.describe(), "quick": arguments.quick,
             "program": next((outcome.program for outcome in outcomes if outcome.program), {}),
             "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"),
             "ranks": arguments.ranks, "threads": arguments.threads, "seconds": time.monotonic() - begin}
    report.write(arguments.output / "report.md", study, outcomes)
    print(f"wrote    {arguments.output / 'report.md'}")
    if arguments.keep:
        shutil.copy(arguments.output / "report.md", folder / "report.md")
        (folder / "plots").mkdir(exist_ok=True)
        for file, _ in (figure for outcome in outcomes for figure in outcome.figures):
            shutil.copy(arguments.output / "plots" / file, folder / "plots" / file)
        print(f"kept     {folder / 'report.md'}")
    missed = [outcome.name for outcome in outcomes if not outcome.passed]
    print(f"{len(outcomes) - len(missed)} of {len(outcomes)} cases pass" + (f"; not {', '.join(missed)}" if missed else ""))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
