#!/usr/bin/python3
"""The study of the paper's Figs. 8 to 11: `./run.sh --study paper`.

Runs `brickwall search` over sizes, methods, ranks and threads and writes study.csv, study.json,
study.md and plots. A run that fails is reported, the others continue, and the exit code is 1. A
second call in the same folder reuses the finished runs of the same program with the same options.
"""
import datetime
import signal
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # of framework
from framework.options import study_parser  # framework first: it sets the path of brickwall_study

import study_tables as tables
from brickwall_study import machine
from brickwall_study.options import positive, positive_list
from paper_plan import METHODS, PAPER_SIZES, PaperPlan, default_layouts
from search_runs import Result, Runner


def parse_arguments():
    parser = study_parser("paper", __doc__)
    parser.add_argument("-n", "--ranks", type=positive_list, help="MPI ranks, such as 1,2,4 (default 1,4)")
    parser.add_argument("-t", "--threads", type=positive_list, help="threads per rank (default 1 to the cores, doubling)")
    parser.add_argument("--sizes", type=positive_list, default=list(PAPER_SIZES),
                        help="n of the walls W(n) with 4350 n^2 faces (default %(default)s)")
    parser.add_argument("--methods", default=",".join(METHODS), help="search methods (default %(default)s)")
    parser.add_argument("--repetitions", type=positive, default=5, help="counted searches of each run (default 5)")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/study_paper"), help="folder (default %(default)s)")
    parser.add_argument("--memory", type=float, help="memory limit of a run in GB (default: 90 %% of the available memory)")
    parser.add_argument("--reference-seconds", type=float, default=60,
                        help="limit of the estimated time of all-pairs tests in a run of `reference`, seconds (default 60)")
    parser.add_argument("--limit", type=float, default=900, help="time limit of a run, seconds (default 900)")
    arguments = parser.parse_args()
    arguments.methods = list(dict.fromkeys(arguments.methods.split(",")))
    unknown = [method for method in arguments.methods if method not in METHODS]
    if unknown:
        parser.error(f"unknown method {unknown[0]}; known are {', '.join(METHODS)}")
    return arguments


def run_all(plan, runner):
    results = []
    for case in plan.cases():
        print(f"{case.name():44} ", end="", flush=True)
        try:
            result = runner.run(case)
        except KeyboardInterrupt:
            print("interrupted; the finished runs are written")
            return results + [Result(case, "failed", "interrupted")]
        results.append(result)
        plan.record(result)
        if result.state != "ok":
            print(f"{result.state}: {result.message}")
        else:
            times = result.report["seconds"]["search"]
            print(f"{1e3 * times['median']:10.2f} ms" + (" (reused)" if result.reused else ""), flush=True)
    return results


def versions_of(results):
    names = ("version", "commit", "compiler", "flags", "kokkos", "mpi", "cpu", "execution_space")
    report = next((result.report for result in results if result.state == "ok"), None)
    return {name: report[name] for name in names} if report else {}


def headline(study):
    place, built = study["machine"], study["versions"]
    return (f"{built.get('cpu', 'unknown processor')}, {place['physical_cores']} cores, {place['system']}; "
            f"brickwall {built.get('commit', '?')}, {built.get('compiler', '?')}, Kokkos {built.get('kokkos', '?')} "
            f"{built.get('execution_space', '')}, {built.get('mpi', '?')}; {study['date']}")


def write_markdown(path, study, rows, figures):
    good = [row for row in rows if row["state"] == "ok"]
    searches = study["options"]["repetitions"]
    text = [f"# The paper's figures\n\n{headline(study)}. Load average at the start: "
            f"{study['machine']['load_average']:.2f}.\n"]
    text += [f"![{name}]({name})\n" for name in figures]
    if good:
        text += [
            f"## Times\n\nMin / median / max over {searches} steady searches of the slowest rank, in one run without "
            "synchronisation. CPU time is that of all threads of a rank, mean over ranks, without waits for other ranks, from a "
            "second run with `--timing paper`; imbalance is the largest CPU time of a rank over the mean. Memory is that of "
            "the searches of all ranks, without their inputs.\n", tables.times_table(good),
            "## First search, shuffled input\n\nLocal nodes and faces are in random order; the first search also sorts and "
            "allocates.\n", tables.first_table(good),
            "## Counts, last search, all ranks\n", tables.counts_table(good),
            "## The 13 timers\n\nMean over ranks and searches, `--timing paper`; without the local search.\n",
            tables.timers_table(good)]
    for title, lines in (("Left out", study["left_out"]), ("Failed", study["failures"])):
        if lines:
            text.append(f"## {title}\n\n" + "\n".join(f"- {line}" for line in lines) + "\n")
    path.write_text("\n".join(text))


def write_study(arguments, study, results):
    rows = [tables.row_of(result) for result in results]
    folder = arguments.output
    tables.write_csv(folder / "study.csv", rows)
    tables.write_json(folder / "study.json", study, results)
    try:
        from study_plots import Figures

        figures = Figures(rows, study["machine"]["physical_cores"], folder, headline(study)).draw_all()
    except ImportError as error:
        figures = []
        print(f"no plots: {error}")
    write_markdown(folder / "study.md", study, rows, figures)
    for name in ("study.csv", "study.json", "study.md", *figures):
        print(f"wrote    {folder / name}")


def interrupt(*_):
    raise KeyboardInterrupt


def main():
    arguments = parse_arguments()
    signal.signal(signal.SIGTERM, interrupt)
    arguments.output.mkdir(parents=True, exist_ok=True)
    place = machine.describe()
    runner = Runner(arguments.run_sh, arguments.program, arguments.output / "runs", arguments.limit)
    left_out, methods = [], []
    for method in arguments.methods:
        known, reason = runner.knows_method(method)
        methods += [method] if known else []
        left_out += [] if known else [f"method {method}: the program refuses it: {reason}"]
    layouts, more_left_out = default_layouts(arguments.ranks, arguments.threads, place["physical_cores"])
    memory = 1e9 * arguments.memory if arguments.memory else 0.9 * machine.memory_bytes("MemAvailable")
    plan = PaperPlan(arguments.sizes, layouts, methods, arguments.repetitions, place["physical_cores"], memory,
                     arguments.reference_seconds)
    for line in left_out + more_left_out:
        print(f"left out {line}")
    results = run_all(plan, runner)
    for line in plan.left_out:
        print(f"left out {line}")
    failures = [f"{result.case.name()}: {result.state}: {result.message}" for result in results
                if result.state == "failed" or (result.state == "out of time" and result.case.method != "reference")]
    failures += tables.disagreements([tables.row_of(result) for result in results])
    left_out += more_left_out + plan.left_out + [
        f"{result.case.name()}: {result.message}" for result in results
        if result.state == "out of time" and result.case.method == "reference"]
    if not any(result.state == "ok" for result in results):
        failures.append("no run has finished")
    options = {name: value for name, value in vars(arguments).items() if name not in ("run_sh", "output")}
    study = {"schema": "brickwall-study-1", "study": "paper",
             "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"), "machine": place,
             "versions": versions_of(results), "options": options, "left_out": left_out, "failures": failures}
    write_study(arguments, study, results)
    for line in failures:
        print(f"FAILED   {line}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
