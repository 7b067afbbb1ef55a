#!/usr/bin/python3
"""The load of the ranks over time in a strike, a wall that flies apart and a collapse: `./run.sh --study balance`.

Runs the scenes of balance.md with contact on the ranks of the elements (primary) and balanced, all in turns, and writes balance.png,
the largest rank over the mean over the steps, and table.md. With --cpu-time, ranks that share cores measure the CPU time of their own
work, and the table's critical path says what contact would take with a core for each rank and messages without latency.
"""
import csv
import json
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # of framework
from framework.options import study_parser  # framework first: it sets the path of brickwall_study

from brickwall_study import launch, machine
from brickwall_study.options import positive, positive_list
from brickwall_study.run_store import digest, finished, now, perform
from brickwall_study.tables import markdown, number

HERE = Path(__file__).resolve().parent
PULSE = HERE.parents[2] / "inputs" / "local_pulse.toml"
SCENES = {
    "strike in the middle": (PULSE, {}),
    "strike in a corner": (PULSE, {"load.pressure[0].center": [3.0, 0.0, 3.0], "time.end": 8}),
    "strike in a corner, W(16)": (PULSE, {"load.pressure[0].center": [3.0, 0.0, 3.0], "time.end": 8, "wall.elements": [32, 16, 16]}),
    "flying apart": (HERE / "apart.toml", {}),
    "collapse": (HERE / "collapse.toml", {}),
}
VALUES = {"active_contacts": "contacts", "work": "work", "enforcement": "time of enforcement"}
COLOURS = {"primary": "#35124a", "surface": "#d1603d", "auto": "#3a8a6e"}


def parse_arguments():
    parser = study_parser("balance", __doc__)
    parser.add_argument("-n", "--ranks", type=positive_list, default=[4], help="MPI ranks (default 4)")
    parser.add_argument("-t", "--threads", type=positive, default=1, help="threads of each rank (default 1)")
    parser.add_argument("--scenes", help=f"separated by semicolons (default all: {'; '.join(SCENES)})")
    parser.add_argument("--decompositions", default=",".join(COLOURS), help="of search.decomposition (default %(default)s)")
    parser.add_argument("--repetitions", type=positive, default=1, help="turns (default 1)")
    parser.add_argument("--cpu-time", action="store_true", help="CPU times, each step in a row: for more ranks than cores")
    parser.add_argument("--steps", type=positive, help="of each run (default: to the end of the deck)")
    parser.add_argument("--limit", type=float, default=3600, help="time limit of a run, s")
    parser.add_argument("-o", "--output", type=lambda path: Path(path).absolute(), default=Path("out/study_balance").absolute(),
                        help="folder (default out/study_balance)")
    arguments = parser.parse_args()
    arguments.scenes = [name.strip() for name in arguments.scenes.split(";")] if arguments.scenes else list(SCENES)
    arguments.decompositions = arguments.decompositions.split(",")
    for kind, known in (("scenes", SCENES), ("decompositions", COLOURS)):
        for name in getattr(arguments, kind):
            if name not in known:
                parser.error(f"unknown name {name!r} in --{kind}; known are {', '.join(known)}")
    return arguments


def run(arguments, cores, scene, ranks, decomposition, turn):
    """(rows of balance.csv, report.json), or the reason of a failure."""
    deck, settings = SCENES[scene]
    folder = arguments.output / "runs" / f"{''.join(c if c.isalnum() else '_' for c in scene)}_n{ranks}_{decomposition}_{turn}"
    settings = {**settings, "output.balance": True, "output.interval": 0.0, "search.decomposition": decomposition}
    if arguments.cpu_time:
        settings["output.history_interval"] = 1e-9
    words = [arguments.program, "run", str(deck), "-o", str(folder)]
    for key, value in settings.items():
        words += ["--set", f"{key}={launch.spell(value)}"]
    words += ["--steps", str(arguments.steps)] if arguments.steps else []
    preload = ["-x", f"LD_PRELOAD={arguments.clock}"] if arguments.cpu_time else []
    key = {"clock": arguments.cpu_time, "program": digest(arguments.program), "words": words[1:], "ranks": ranks, "threads": arguments.threads}
    if not finished(folder, key):
        environment = {**os.environ, **launch.environment(ranks, arguments.threads, cores)}
        command = [*launch.launcher(arguments.program), "-n", str(ranks), *preload, *words]
        record = perform(folder, key, command, arguments.limit, environment)
        if record["state"] != "ok":
            return f"{folder.name}: {record['state']}: {record['message']}"
    with open(folder / "balance.csv", newline="") as file:
        return list(csv.DictReader(file)), json.loads((folder / "report.json").read_text())


def imbalance(rows, value):
    """[(step, largest over mean)] where the mean is not 0."""
    return [(int(row["step"]), float(row[f"{value}_max"]) / float(row[f"{value}_mean"])) for row in rows
            if float(row[f"{value}_mean"]) > 0]


def over_time(rows, value):
    """The sum of the largest rank over that of the means: what all steps together cost more."""
    mean = sum(float(row[f"{value}_mean"]) for row in rows)
    return sum(float(row[f"{value}_max"]) for row in rows) / mean if mean > 0 else None


def seconds(rows, kind, *parts):
    """The sum of these times over the rows, s, without waits: of the slowest rank of each (kind max) or the mean. In the first row times begin."""
    return sum(float(row[f"{part}_{kind}"]) for row in rows[1:] for part in parts)


def median(values):
    in_order = sorted(values)
    return in_order[len(in_order) // 2]


def undisturbed(runs):
    """Rows whose times are, step by step, the least of runs that have distributed in the same steps: other programs only add time. Of other
    runs the fastest."""
    if len({tuple(row["distributions"] for row in rows) for rows in runs}) > 1:
        return min(runs, key=lambda rows: seconds(rows, "max", "search", "enforcement"))
    times = [f"{part}_{kind}" for part in ("search", "enforcement", "distribution") for kind in ("max", "mean")]
    return [{**rows[0], **{time: min(float(row[time]) for row in rows) for time in times}} for rows in zip(*runs)]


def draw(folder, results, scenes, ranks):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"axes.grid": True, "grid.color": "#dddddd", "axes.spines.top": False, "axes.spines.right": False,
                         "legend.frameon": False, "font.size": 8})
    figure, panels = plt.subplots(len(VALUES), len(scenes), figsize=(3.6 * len(scenes), 7), sharex="col", squeeze=False)
    for column, scene in enumerate(scenes):
        for row, (value, title) in enumerate(VALUES.items()):
            panel = panels[row][column]
            for decomposition, colour in COLOURS.items():
                found = results.get((scene, ranks, decomposition))
                points = imbalance(found[0][0], value) if found else []
                panel.plot(*zip(*points) if points else ([], []), color=colour, linewidth=1, label=decomposition)
            panel.set_ylim(bottom=1)
            panel.set_title(f"{scene}, {ranks} ranks" if row == 0 else "")
            panel.set_ylabel(f"{title}: largest over mean" if column == 0 else "")
            panel.set_xlabel("step" if row == len(VALUES) - 1 else "")
    panels[0][0].legend()
    figure.tight_layout()
    figure.savefig(folder / "balance.png", dpi=110)


def table(results, with_waits):
    contact = ("search", "enforcement")
    least = {case: undisturbed([rows for rows, _ in found]) for case, found in results.items()}
    path = {case: seconds(rows, "max", *contact) for case, rows in least.items()}
    whole = {case: seconds(rows, "max", *contact, "distribution") for case, rows in least.items()}
    lines = []
    for case, found in results.items():
        scene, ranks, decomposition = case
        rows, report = found[-1]
        mean = seconds(least[case], "mean", *contact)
        home = (scene, ranks, "primary")
        gain = f"{path[home] / path[case]:.2f} / {whole[home] / whole[case]:.2f}" if home in results and case != home else ""
        lines.append([scene, ranks, decomposition, number(over_time(rows, "active_contacts")), number(path[case] / mean),
                      number(path[case]), number(mean), report["search"]["distributions"], number(whole[case] - path[case]), gain,
                      *([number(median(report["imbalance"]["contact_with_waits"]["max"] for _, report in found))] if with_waits else []),
                      report["checksums"]["nodes"]])
    return markdown(["scene", "ranks", "decomposition", "contacts: largest over mean", "time: largest over mean", "critical path, s",
                     "mean of the ranks, s", "distributions", "their path, s", "gain without / with distributions",
                     *(["contact with waits, s"] if with_waits else []), "checksum of the nodes"], lines)


def main():
    arguments = parse_arguments()
    place = machine.describe()
    if arguments.cpu_time:
        arguments.output.mkdir(parents=True, exist_ok=True)
        arguments.clock = arguments.output / "cpu_clock.so"
        subprocess.run(["mpicc", "-O2", "-shared", "-fPIC", "-o", arguments.clock, HERE / "cpu_clock.c"], check=True)
    results, failures = {}, []
    for turn in range(1, arguments.repetitions + 1):
        for case in [(scene, ranks, name) for scene in arguments.scenes for ranks in arguments.ranks
                     for name in arguments.decompositions]:
            found = run(arguments, place["physical_cores"], *case, turn)
            if isinstance(found, str):
                failures.append(found)
                print(f"FAILED   {found}", file=sys.stderr)
                continue
            results.setdefault(case, []).append(found)
            print(f"{', '.join(map(str, case))}: done", flush=True)
    for scene in arguments.scenes:
        if len({report["checksums"]["nodes"] for case, found in results.items() if case[0] == scene for _, report in found}) > 1:
            failures.append(scene)
            print(f"FAILED   {scene}: the checksums of the nodes differ", file=sys.stderr)
    for ranks in arguments.ranks:
        if any(case[1] == ranks for case in results):
            draw(arguments.output, results, arguments.scenes, ranks)
    built = next((found[0][1] for found in results.values()), {})
    (arguments.output / "table.md").write_text(
        f"# The load of the ranks\n\n{built.get('cpu')}, {place['physical_cores']} cores; commit {built.get('commit')}; {now()}; "
        f"largest over mean: sums over the rows of balance.csv; time and path: of search and enforcement, each step the least of "
        f"{arguments.repetitions} runs. The plot is of {arguments.ranks[-1]} ranks.\n\n![Load](balance.png)\n\n"
        + table(results, not arguments.cpu_time))
    print(f"wrote    {arguments.output / 'balance.png'}, {arguments.output / 'table.md'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
