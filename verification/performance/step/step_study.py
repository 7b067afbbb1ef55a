#!/usr/bin/env python3
"""The time of a coupled step, part by part: `./run.sh --study step`.

Runs the program over scenes, walls, ranks, threads and both ways to search, in turns, and takes
medians of the means over the steps of a run. Scenes: all bricks under a pulse (the deck as it is),
pressed by 0.2 %, flying apart, at rest. Set-up lasts until the first step. Units of the internal force are those of the pressed wall
on the same ranks and threads.
"""
import csv
import datetime
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "verification"))
from framework.needed import need

need("numpy", "netCDF4")  # framework.program imports them
from brickwall_study import machine
from brickwall_study.options import positive
from framework import report
from framework.options import add_run_options, study_parser
from framework.program import Program, ProgramError


@dataclass(frozen=True)
class Wall:
    """A deck, its steps in a run, its bricks along in even and odd courses, and the velocity of a
    brick relative to the one before it or below it where bricks fly apart: gaps reach about the
    tolerance of the search at the end."""

    name: str
    deck: str
    steps: int
    bricks: tuple
    courses: int
    apart: float


WALLS = {
    "default": Wall("default wall", "brick_wall", 300, (8, 9), 10, 0.8),
    "2": Wall("W(2)", "wall_17k", 100, (15, 15), 29, 8e-4),
    "8": Wall("W(8)", "wall_278k", 20, (15, 15), 29, 4e-3),
    "16": Wall("W(16)", "wall_1113k", 12, (15, 15), 29, 4e-3),
}
SCENES = ("under pulse", "pressed", "flying apart", "at rest")
SEARCHES = {"every step": 0.0, "kept lists": 0.1}  # search.reuse.margin
LAYOUTS = ((1, 1), (1, 2), (4, 1))  # ranks, threads
ROWS = ("internal force", "contact enforcement", "search", "kick with ledger", "loads", "drift, guard, rest", "whole step")
# Regions of the program, and the names that report.json gives them.
PHASES = {"internal force": (("miniapp::computeInternalForces", "step::internal force"),),
          "contact enforcement": (("miniapp::enforceContact", "step::contact enforcement"),),
          "search": (("contact::search", "search"),),
          "kick with ledger": (("miniapp::kickVelocities", "step::kick"), ("miniapp::bookEnergies", "step::ledger")),
          "loads": (("miniapp::addLoads", "step::loads"),),
          "drift": (("miniapp::moveNodes", "step::drift"),),
          "whole step": (("miniapp::step", "step"),)}
PROBE = "verification/performance/libbrickwall_step_probe.so"
BENCHMARKS = ("mechanics_solver_speed", "contact_enforcement_speed")
# Bytes of a node that a phase must read and write, each array once: displacement, velocity and
# coordinates have 24, a force column 24, all three columns 72.
NODE_BYTES = {"zero forces": 72, "internal force": 24 + 2 * 24, "drift": 24 + 2 * 24, "kick": 72 + 2 * 24 + 24 + 24 + 8 + 1 + 3}


def parse_arguments():
    parser = study_parser("step", __doc__)
    add_run_options(parser, "step", "the default wall, two scenes, few steps, once, as in ctest; no benchmarks",
                    "copy step.md to verification/performance/step/", counts=False)
    parser.add_argument("--walls", type=lambda text: text.split(","), help="list of default, 2, 8, 16 (default all)")
    parser.add_argument("--repetitions", type=positive, help="runs of each case (default 5, of W(16) 3)")
    parser.add_argument("--cpu-time", action="store_true", help="CPU time of the thread that launches, in place of wall-clock "
                        "time: for a machine with other work")
    parser.add_argument("--lulesh", metavar="PROGRAM", help="program of LULESH 2.0, to be measured beside")
    arguments = parser.parse_args()
    arguments.walls = arguments.walls or (["default"] if arguments.quick else list(WALLS))
    for wall in arguments.walls:
        if wall not in WALLS:
            parser.error(f"unknown wall {wall}; known are {', '.join(WALLS)}")
    return arguments


def settings_of(wall, scene, search, quick):
    settings = {"time.steps": 4 if quick else wall.steps, "time.end": 1e3, "output.interval": 0.0,
                "output.history_interval": 1e3, "search.reuse.margin": SEARCHES[search], "limits.energy_error": 10.0}
    if scene != "under pulse":
        settings["load.pressure[0].peak"] = 0.0
    if scene == "pressed":
        settings["initial.deformation"] = "[{gradient=[-0.002,0,0,0,0,0,0,0,-0.002]}]"
    return settings


def deck_of(arguments, wall, scene):
    """The deck of the wall; bricks that fly apart have velocities in a copy of it, since they are too many for a line."""
    deck = ROOT / "inputs" / f"{wall.deck}.toml"
    if scene != "flying apart":
        return deck
    velocities = [f"\n[[initial.velocity]]\nbrick = [{x}, 0, {z}]\nvelocity = [{wall.apart * x:g}, 0, {wall.apart * z:g}]\n"
                  for z in range(1, wall.courses) for x in range(wall.bricks[z % 2])]
    copy = arguments.output / deck.name
    arguments.output.mkdir(parents=True, exist_ok=True)
    copy.write_text(deck.read_text() + "".join(velocities))
    return copy


def run_once(program, arguments, wall, scene, search, layout, probed=False):
    """A run and, if probed, what the probe has written."""
    folder = arguments.output / "runs"
    file = folder / "probe.json"
    probe = program.binary.parent.parent / PROBE
    probing = {"KOKKOS_PROFILE_LIBRARY": str(probe), "KOKKOS_TOOLS_LIBS": str(probe), "BRICKWALL_STEP_PROBE": str(file),
               "OMP_WAIT_POLICY": "passive"} if probed else {}
    os.environ.update(probing)
    done = program.run(deck_of(arguments, wall, scene), folder, settings_of(wall, scene, search, arguments.quick),
                       ranks=layout[0], threads=layout[1])
    for name in probing:
        del os.environ[name]
    outcome, found = done.report, json.loads(file.read_text()) if probed else None
    shutil.rmtree(folder)
    return outcome, found


def figures_of(outcome, probed):
    """Milliseconds a step of each row, and other figures of a run: CPU time if `probed`."""
    seconds = probed or {phase["name"]: phase["max"] for phase in outcome["phases"]}
    row = {name: 1e3 * sum(seconds.get(names[0 if probed else 1], 0) for names in phases) / (outcome["steps"] - 1)
           for name, phases in PHASES.items()}
    row["drift, guard, rest"] = row["whole step"] - sum(row[name] for name in ROWS[:5])
    row["set-up"] = 1e3 * (probed["setup"] if probed else outcome["setup_seconds"])
    row["active contacts"] = outcome["search"]["active_contacts"]
    return row


def run_all(program, arguments, wall, columns, layouts):
    """{(scene, search, layout): {row: median}}, the ratio of the longest to the shortest step of each
    case, and the last report. All cases take turns."""
    cases = [(*column, layout) for layout in layouts for column in columns]
    found = {case: [] for case in cases}
    usual = 1 if arguments.quick else 3 if wall.deck == "wall_1113k" else 5
    for turn in range(arguments.repetitions or usual):
        for case in cases:
            outcome, probed = run_once(program, arguments, wall, *case, probed=arguments.cpu_time)
            found[case].append(figures_of(outcome, probed))
            print(f"{wall.name}, {case[0]}, {case[1]}, {case[2][0]} x {case[2][1]}, run {turn + 1}: "
                  f"{found[case][-1]['whole step']:.3f} ms a step", flush=True)
    medians = {case: {name: statistics.median(row[name] for row in rows) for name in rows[0]} for case, rows in found.items()}
    spreads = {case: max(row["whole step"] for row in rows) / min(row["whole step"] for row in rows) for case, rows in found.items()}
    return medians, spreads, outcome


def launches_of(program, arguments, wall, columns):
    """{(scene, search): launches of (parallel_for, parallel_reduce, parallel_scan) a step}."""
    counts = {}
    for column in columns:
        _, probed = run_once(program, arguments, wall, *column, (1, 1), probed=True)
        counts[column] = [number / probed["steps"] for number in probed["launches"]]
    return counts


def output_of(command, threads, **environment):
    """What a program prints, and its CPU seconds over its threads."""
    before = os.times()
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={
        **os.environ, "OMP_NUM_THREADS": str(threads), "OMP_PROC_BIND": "false", "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", **environment})
    return done.stdout, (os.times().children_user - before.children_user) / threads


def zones_per_second(program, threads, cpu_time):
    """Of LULESH, whose figure of merit is in thousands; by CPU time its set-up counts too."""
    edge, steps = 76, 50
    text, seconds = output_of([program, "-s", str(edge), "-i", str(steps)], threads, OMP_WAIT_POLICY="passive")
    return edge**3 * steps / seconds if cpu_time else 1e3 * float(re.search(r"FOM\s*=\s*(\S+)", text)[1])


def measure_machine(arguments):
    """Bandwidth, time of an empty launch and counts of operations, from the benchmarks."""
    build = Path(arguments.program).parent.parent
    subprocess.run(["cmake", "--build", str(build), "--target", *BENCHMARKS], check=True, stdout=subprocess.DEVNULL)
    clock = {"BRICKWALL_CPU_TIME": "1"} if arguments.cpu_time else {}
    solver, contact = (build / "verification/performance" / name for name in BENCHMARKS)
    found = {}
    for threads in (1, 2):
        text, _ = output_of([solver], threads, BRICKWALL_BRICKS="24", **clock)
        found[threads] = {name: float(re.search(pattern, text)[1]) for name, pattern in (
            ("triad, GB/s", r"triad ([\d.]+) GB/s"), ("parallel_for, us", r"parallel_for ([\d.]+) us"),
            ("parallel_reduce, us", r"parallel_reduce ([\d.]+) us"), ("flops of an element-step", r"congruent: (\d+) flops"))}
        if arguments.lulesh:
            found[threads]["LULESH, zones/s"] = zones_per_second(arguments.lulesh, threads, arguments.cpu_time)
    text, _ = output_of([contact], 1)
    found["contact"] = {name: float(re.search(pattern, text)[1]) for name, pattern in (
        ("flops", r"contact: (\d+) flops"), ("bytes", r"flops, (\d+) B"))}
    return found


def number(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def step_tables(medians, spreads, columns, layouts):
    """One table for each layout: milliseconds a step, and units of the internal force."""
    parts = []
    for layout in layouts:
        unit = medians["pressed", "kept lists", layout]["internal force"]
        keys = [(*column, layout) for column in columns]
        rows = [[name] + [f"{number(medians[key][name])} ({number(medians[key][name] / unit)})" for key in keys] for name in ROWS]
        rows.append(["set-up, steps of this run"] + [number(medians[key]["set-up"] / medians[key]["whole step"]) for key in keys])
        rows.append(["most over least whole step"] + [number(spreads[key]) for key in keys])
        parts.append(f"{layout[0]} rank(s) with {layout[1]} thread(s); unit {number(unit)} ms\n\n" + report.table(
            ["ms a step (units)"] + [", ".join(column) for column in columns], rows))
    return parts


def scaling_table(medians, columns):
    def ratio(name, column):
        one, two = (medians[(*column, (1, threads))][name] for threads in (1, 2))
        return number(one / two) if two > 1e-3 else "-"

    return report.table(["time with 1 thread over time with 2"] + [", ".join(column) for column in columns],
                        [[name] + [ratio(name, column) for column in columns] for name in ROWS])


def launch_table(counts, medians, place, layouts):
    rows = [["launches a step: for / reduce / scan"] + [" / ".join(f"{kind:.1f}" for kind in count) for count in counts.values()]]
    for layout in layouts if place else ():
        if layout[0] == 1:
            costs = place[layout[1]]
            rows.append([f"share of the step, {layout[1]} thread(s)"])
            for column, (loops, *others) in counts.items():
                lost = 1e-3 * (loops * costs["parallel_for, us"] + sum(others) * costs["parallel_reduce, us"])
                rows[-1].append(f"{100 * lost / medians[(*column, layout)]['whole step']:.1f} %")
    return report.table(["launches times the time of an empty launch"] + [", ".join(column) for column in counts], rows)


def traffic_table(medians, outcome, place, layouts):
    """Counted bytes and flops over times, of the pressed wall with kept lists."""
    rows, nodes, elements = [], outcome["nodes"], outcome["elements"]
    for layout in layouts:
        if layout[0] > 1:
            continue
        median, triad = medians["pressed", "kept lists", layout], 1e9 * place[layout[1]]["triad, GB/s"]
        for name, row, count in (("internal force", "internal force", NODE_BYTES["internal force"] * nodes / elements),
                                 ("drift", "drift", NODE_BYTES["drift"] * nodes / elements),
                                 ("kick", "kick with ledger", NODE_BYTES["kick"] * nodes / elements)):
            flops = place[1]["flops of an element-step"] if name == "internal force" else 0
            rate = elements / median[row] * 1e3
            rows.append([name, layout[1], "element-step", count, flops or "", rate * count / triad, 1e-9 * rate * flops or ""])
        contact = place["contact"]
        rate = median["active contacts"] / median["contact enforcement"] * 1e3
        rows.append(["contact enforcement", layout[1], "active contact", contact["bytes"], contact["flops"],
                     rate * contact["bytes"] / triad, 1e-9 * rate * contact["flops"]])
    return report.table(["phase", "threads", "of", "bytes", "flops", "fraction of triad", "Gflop/s"], rows)


def main():
    arguments = parse_arguments()
    program = Program(Path(arguments.run_sh), Path(arguments.program))
    arguments.output.mkdir(parents=True, exist_ok=True)
    layouts = LAYOUTS[:2] if arguments.quick else LAYOUTS
    columns = [(scene, search) for scene in (SCENES[:2] if arguments.quick else SCENES) for search in SEARCHES]
    place = None if arguments.quick else measure_machine(arguments)
    parts, lines, outcome = [], [], {}
    try:
        for wall in (WALLS[name] for name in arguments.walls):
            medians, spreads, outcome = run_all(program, arguments, wall, columns, layouts)
            lines += [[wall.name, scene, search, *layout] + list(row.values()) for (scene, search, layout), row in medians.items()]
            parts += [f"## {wall.name}\n", f"{outcome['elements']} elements, {outcome['faces']} faces.\n"]
            parts += step_tables(medians, spreads, columns, layouts) + [scaling_table(medians, columns)]
            if wall.deck != "wall_1113k":
                parts.append(launch_table(launches_of(program, arguments, wall, columns), medians, place, layouts))
            if place and outcome["elements"] > 100000:  # beyond the caches
                parts.append(traffic_table(medians, outcome, place, layouts))
    except ProgramError as error:
        print(f"FAIL: {error}")
        return 1
    study = {"machine": machine.describe(), "program": {name: outcome[name] for name in ("version", "commit", "compiler", "kokkos",
             "mpi", "cpu", "execution_space")}, "ranks": 1, "threads": 1, "benchmarks": place, "command": " ".join(sys.argv[1:]),
             "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")}
    names = ["wall", "scene", "lists", "ranks", "threads"] + list(next(iter(medians.values())))
    text = [f"# The time of a coupled step\n\nWritten by `./run.sh --study step`. {' '.join(__doc__.split(chr(10), 1)[1].split())}\n",
            report.headline(study).rsplit("; ", 1)[0] + ".\n"]
    if place:
        text.append("Benchmarks: `" + json.dumps(place) + "`\n")
    if arguments.cpu_time:
        text.append("Times are CPU times of the thread that launches (of rank 0): waits for other threads are not in them.\n")
    (arguments.output / "step.md").write_text("\n".join(text + parts))
    with open(arguments.output / "step.csv", "w", newline="") as file:
        csv.writer(file).writerows([names] + lines)
    (arguments.output / "step.json").write_text(json.dumps({**study, "rows": [dict(zip(names, line)) for line in lines]}, indent=1) + "\n")
    if arguments.keep:
        shutil.copy(arguments.output / "step.md", Path(__file__).parent)
    print(f"wrote    {arguments.output}/step.md\nPASS")
    return 0


if __name__ == "__main__":
    sys.exit(main())
