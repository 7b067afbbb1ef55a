"""`brickwall study`: many runs from one file."""
import argparse
import fcntl
import json
import random
import signal
import statistics
import sys
from contextlib import contextmanager
from pathlib import Path

from . import machine, page
from .comparison import compare_runs
from .deck_check import check_cases
from .errors import INTERRUPTED, PASSED, RUNS_FAILED, OutputError, run_main, write_text
from .options import positive_list
from .run_store import now
from .study_file import read_study
from .study_output import csv_text, json_text
from .study_runs import Runner, plan
from .tables import counted, number

DESCRIPTION = """Makes the runs of a study file, repeated and in random order, and writes study.csv, study.json, report.md and report.html to its
folder. The same command continues a study that was interrupted: finished runs of the same program, deck and settings are not made again."""
EXIT_CODES = "Exit code: 0 success, 2 faulty study file or command line, 3 a run failed, 4 a file cannot be written, 5 interrupted."


def main(words=None):
    parser = argparse.ArgumentParser(prog="brickwall study", description=DESCRIPTION, epilog=EXIT_CODES)
    parser.add_argument("file", metavar="FILE.toml", help="the study")
    parser.add_argument("-o", "--output", type=Path, help="folder (default out/study_FILE)")
    parser.add_argument("-n", "--ranks", type=positive_list, help="MPI ranks, in place of those of the file")
    parser.add_argument("-t", "--threads", type=positive_list, help="threads of each rank, in place of those of the file")
    parser.add_argument("--program", type=Path, default=Path(sys.argv[0]).absolute().parent / "brickwall",
                        help="program, where the file names none (default: brickwall in the folder of this program)")
    parser.add_argument("--list", action="store_true", help="print the runs in their order, make none")
    arguments = parser.parse_args(words)
    return run_main("brickwall study", lambda: run_study(arguments))


def run_study(arguments):
    cores = machine.physical_cores()
    study = read_study(arguments.file, arguments.program, cores, arguments.ranks, arguments.threads)
    folder = (arguments.output or Path(f"out/study_{study.path.stem}")).absolute()
    for reason in study.left_out:
        print(f"left out {reason}")
    check_cases(study)
    seed = seed_of(study, folder)
    steps = plan(study, seed)
    if arguments.list:
        for order, (repetition, case) in enumerate(steps, 1):
            print(f"{order:5} {case.id}, {'warm-up' if repetition < 1 else f'run {repetition}'}")
        return PASSED
    with locked(folder):
        print(f"results in {folder}", flush=True)
        state, runs = make_runs(study, folder, cores, seed, steps)
    return finish(state, runs, len(steps))


def make_runs(study, folder, cores, seed, steps):
    """Makes the runs and writes all files; ("complete" or "interrupted", [Done, ...])."""
    place, begin, runner, runs, state = machine.describe(), now(), Runner(study, folder, cores), [], "complete"

    def write(state):
        write_text(folder / "study.csv", csv_text(runs))
        write_text(folder / "study.json", json_text(study, state, seed, place, runner.programs, runs, (begin, now())))

    signal.signal(signal.SIGTERM, interrupt)
    write("incomplete")
    try:
        for order, (repetition, case) in enumerate(steps, 1):
            runs.append(runner.make(order, repetition, case))
            print(line_of(runs[-1], len(steps)), flush=True)
            if not runs[-1].reused:
                write("incomplete")
    except KeyboardInterrupt:
        state = "interrupted"
    write(state)
    write_report(study, folder, runs, seed, place)
    return state, runs


def seed_of(study, folder):
    """That of the file, of an earlier call in this folder, or a new one."""
    if study.seed is not None:
        return study.seed
    try:
        return int(json.loads((folder / "study.json").read_text())["seed"])
    except (OSError, ValueError, KeyError, TypeError):
        return random.SystemRandom().randrange(2**32)


@contextmanager
def locked(folder):
    """Two studies never write to one folder."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = open(folder / ".lock", "w")
    except OSError as error:
        raise OutputError(f"{error.filename}: cannot be made: {error.strerror}") from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise OutputError(f"{folder}: another study is writing there") from None
        yield


def interrupt(*_):
    raise KeyboardInterrupt


def line_of(done, total):
    result = done.record["state"] if done.record["state"] != "ok" else "warm-up" if not done.is_counted else (
        f"{number(1e3 * done.run.whole)} ms a {done.run.unit}")
    if done.record["state"] != "ok":
        result += f": {done.record['message']}"
    return f"{done.order:4}/{total} {done.case.id:50} {result}" + (" (finished before)" if done.reused else "")


def write_report(study, folder, runs, seed, place):
    measured = [done.run for case in study.cases for done in runs if done.case is case and done.run]
    if not measured:
        return
    document = compare_runs(measured, study.title)
    document.lead.append(
        f"{counted(place['physical_cores'], 'core')}, {place['system']}; {counted(study.repetitions, 'repetition')} and "
        f"{counted(study.warmup, 'warm-up run')} of {counted(len(study.cases), 'case')}, in turns of random order with seed {seed}; {loads(runs)}. All runs: study.csv, study.json.")
    faults = [f"{done.case.id}, run {done.repetition}: {done.record['state']}: {done.record['message']}"
              for done in runs if done.record["state"] != "ok"]
    for heading, lines in (("Left out", study.left_out), ("Failed", faults)):
        if lines:
            document.sections.append((heading, lines))
    write_text(folder / "report.md", page.markdown(document))
    write_text(folder / "report.html", page.html(document))
    for name in ("study.csv", "study.json", "report.md", "report.html"):
        print(f"wrote    {folder / name}")


def loads(runs):
    """A busy machine is no place for timings."""
    found = [done.record["load_average"] for done in runs]
    return f"load average before the runs {min(found):g} to {max(found):g}"


def finish(state, runs, total):
    """Prints the largest throughput, of runs and of searches, and the verdict."""
    found = {}
    for done in runs:
        if done.run:
            what = "element_steps_per_second" if done.run.kind == "run" else "face_searches_per_second"
            found.setdefault((what, done.case.id), []).append(done.run.throughput)
    for what in dict.fromkeys(what for what, _ in found):
        best, case = max((statistics.median(values), case) for (kind, case), values in found.items() if kind == what)
        print(f"FOM {what}={best:.6g} case={case}")
    failed = sum(done.record["state"] != "ok" for done in runs)
    if state == "interrupted":
        print(f"STOPPED: {len(runs)} of {total} runs are finished; the same command continues")
        return INTERRUPTED
    print(f"FAIL: {failed} of {total} runs failed" if failed else "PASS")
    return RUNS_FAILED if failed else PASSED
