#!/usr/bin/python3
"""Strong and weak scaling on this machine, and a model of searches and coupled steps up to 100,000 ranks: `./run.sh --study scale`.

Measures searches and coupled steps of walls on the ranks and threads that the machine has, counts messages,
replays walls on virtual ranks, fits the few costs that are not counted (scale_model.py), checks the prediction of a wall
twice as long as the largest measured one, and writes scale.md, scale.csv, scale.json and plots.
"""
import math
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # of framework
from framework.options import study_parser  # framework first: it sets the path of brickwall_study

import scale_model as model
from brickwall_study import machine
from brickwall_study.options import positive, positive_list
from brickwall_study.run_store import now
from scale_runs import RunFailed, Runs

PAPER_WALLS = (2, 8, 16, 32, 64)
RANKS = (64, 256, 1000, 4096, 16384, 65536, 100000)
EDGES = 435 * 16  # element edges on the edges of bricks, of W(1); n times as many of W(n)
MOST_FACES_REPLAYED = 60000  # of a rank: larger ones follow from the perimeter


def parse_arguments():
    parser = study_parser("scale", __doc__)
    parser.add_argument("-n", "--ranks", type=positive_list, default=[1, 2, 4, 8, 16],
                        help="ranks whose messages are counted; more than there are cores are not timed (default %(default)s)")
    parser.add_argument("-t", "--threads", type=positive_list, help="threads of one rank (default 1 to the cores, doubling)")
    parser.add_argument("--sizes", type=positive_list, default=[1, 2, 4, 8], help="n of the walls W(n) that are timed")
    parser.add_argument("--repetitions", type=positive, default=3, help="turns of all timed runs (default 3)")
    parser.add_argument("--searches", type=positive, default=10, help="searches of a run (default 10)")
    parser.add_argument("--steps", type=positive, default=12, help="coupled steps of a run (default 12)")
    parser.add_argument("--virtual", type=positive_list, default=list(RANKS), help="numbers of virtual ranks")
    parser.add_argument("--walls", type=positive_list, default=list(PAPER_WALLS), help="n of the walls that are predicted")
    parser.add_argument("--sphere-rows", type=positive_list, default=[10, 20], help="rows of spheres a rank (ArborX: 40)")
    parser.add_argument("--latency", type=float, help="s of a message between ranks, instead of that of this machine")
    parser.add_argument("--bandwidth", type=float, help="bytes/s of a message, instead of that of this machine")
    parser.add_argument("--limit", type=float, default=600, help="time limit of a run, s")
    parser.add_argument("-o", "--output", type=lambda path: Path(path).absolute(), default=Path("out/study_scale").absolute(),
                        help="folder (default out/study_scale)")
    return parser.parse_args()


class Measured:
    """Seconds of searches and steps, {(kind, n, ranks, threads, length): [one of each turn]}; "solver" is the part of a step
    besides search and enforcement. Faces and elements, {(n, length): number}."""

    def __init__(self):
        self.seconds, self.faces, self.elements, self.versions = {}, {}, {}, {}

    def add(self, kind, n, ranks, threads, length, seconds, report):
        self.seconds.setdefault((kind, n, ranks, threads, length), []).append(seconds)
        self.faces[n, length] = report["faces"]
        if kind == "step":
            self.elements[n, length] = report["elements"]
            solver = report["elements"] / report["fom"]["solver_element_steps_per_second"]
            self.seconds.setdefault(("solver", n, ranks, threads, length), []).append(solver)
        self.versions = {name: report[name] for name in ("version", "commit", "compiler", "kokkos", "mpi", "cpu")}

    def triple(self, *case):
        return model.triple(self.seconds[case])


def layouts_of(arguments, cores):
    threads = arguments.threads or [2**i for i in range(int(math.log2(cores)) + 1)]
    timed = [(1, t) for t in threads if t <= cores] + [(n, 1) for n in arguments.ranks if 1 < n <= cores]
    return list(dict.fromkeys(timed))


def measure(arguments, runs, cores):
    """All timed runs take turns: strong scaling of each wall, weak scaling of W(n) over its length, and the wall twice as long as
    the largest one, which no fit sees."""
    measured = Measured()
    layouts, largest = layouts_of(arguments, cores), max(arguments.sizes)
    cases = [(n, *layout, 1) for n in arguments.sizes for layout in layouts]
    cases += [(n, ranks, 1, ranks) for n in arguments.sizes for ranks, threads in layouts if ranks > 1]
    cases += [(largest, *layout, 2 * layout[0]) for layout in layouts if layout[1] == 1]
    for turn in range(1, arguments.repetitions + 1):
        for kind, (seconds, report) in runs.smallest(turn).items():
            measured.add(kind, 0, 1, 1, 1, seconds, report)
        for n, ranks, threads, length in dict.fromkeys(cases):
            seconds, report = runs.search_seconds(n, ranks, threads, arguments.searches, turn, length)
            measured.add("search", n, ranks, threads, length, seconds, report)
            seconds, report = runs.step_seconds(n, ranks, threads, arguments.steps, turn, length)
            measured.add("step", n, ranks, threads, length, seconds, report)
        print(f"turn {turn} of {arguments.repetitions} is done", flush=True)
    return measured


def boundary_cost(rows):
    """Seconds of an item at the boundary: phases 3 and 4 of the replayed ranks, over what they list. Least, median, largest."""
    return model.triple([1e-6 * (float(row["candidates_us"]) + float(row["node_boxes_us"]))
                         / (float(row["blocks_tested"]) + float(row["node_boxes_sent"]))
                         for row in rows if row["scene"] in ("wall", "pile") and float(row["node_boxes_sent"]) > 100])


def costs_of(kind, measured, arguments, cores, boundary, messages):
    fixed = measured.triple(kind, 0, 1, 1, 1)  # of a wall of four elements
    edge = element = (0.0, 0.0, 0.0)
    if kind == "search":
        (face,) = model.fit_triples([((measured.faces[n, 1],), measured.triple(kind, n, 1, 1, 1)) for n in arguments.sizes])
    else:  # the solver by its elements, search and enforcement by faces and edges
        solver, whole = [{n: measured.seconds[name, n, 1, 1, 1] for n in arguments.sizes} for name in ("solver", kind)]
        (element,) = model.fit_triples([((measured.elements[n, 1],), model.triple(solver[n])) for n in arguments.sizes])
        face, edge = model.fit_triples([((measured.faces[n, 1], EDGES * n), model.triple([a - b for a, b in zip(whole[n], solver[n])]))
                                        for n in arguments.sizes])
    ranks = max((n for n, _ in layouts_of(arguments, cores)), default=1)
    contention = (1.0, 1.0, 1.0)
    if ranks > 1:  # a wall `ranks` times as long over the time of one alone
        ratios = [measured.triple(kind, n, ranks, 1, ranks)[1] / measured.triple(kind, n, 1, 1, 1)[1]
                  for n in arguments.sizes if n > 1 or len(arguments.sizes) == 1]
        contention = tuple(max(1.0, value) for value in model.triple(ratios))
    of = {name: tuple(messages[name][part] for part in ("min", "median", "max")) for name in
          ("latency", "seconds_per_byte", "reduction")}
    return model.Costs(fixed, face, edge, element, boundary, of["latency"], of["seconds_per_byte"],
                       tuple(value / math.log2(messages["ranks"]) for value in of["reduction"]), contention)


def replayed_walls(arguments, runs):
    """{(n, factor): {ranks: row}} of the walls that are predicted, those 100 times larger included."""
    walls = {}
    for n in arguments.walls:
        for factor in (1, 10):
            faces = 4350 * n * n * factor**2
            ranks = [p for p in arguments.virtual if 100 <= faces / p <= MOST_FACES_REPLAYED]
            if ranks:
                rows = runs.replay("wall", n, factor, *ranks)
                walls[n, factor] = {int(row["ranks"]): row for row in rows}
    return walls


def count_messages(arguments, runs, n):
    """{(kind, ranks): counts} of W(n), with ghosts and partners of the searches."""
    found = {}
    for ranks in arguments.ranks:
        if ranks < 2:
            continue
        for kind, command, steps in (("search", "search", 4), ("step", "run", 4)):
            counts, report = runs.messages(n, command, ranks, steps)
            counts["ghosts"] = (report["counts"] if kind == "search" else report["search"])["ghost_faces"]
            if kind == "search":
                counts["node_boxes"], counts["partners"] = report["counts"]["node_boxes_sent"], report["counts"]["most_partners"]
            found[kind, ranks] = counts
    return found


def step_counts(search, counted, edges, elements, ranks):
    """Counts of a coupled step with a search: per partner and per ghost as counted in real steps."""
    pairs = [(counted["step", p], counted["search", p]) for kind, p in counted if kind == "step"]
    per_message = model.triple([step["messages"]["max"] / max(1, found["messages"]["max"]) for step, found in pairs])[1]
    per_byte = model.triple([step["bytes"]["sum"] / max(1, found["bytes"]["sum"]) for step, found in pairs])[1]
    reductions = model.triple([step["reductions"]["max"] for step, _ in pairs])[1]
    return model.Counts(ranks, search.faces, edges * search.faces, elements, search.boundary * per_byte, search.messages * per_message,
                        search.bytes * per_byte, reductions)


def predictions(arguments, costs, walls, counted):
    rows = []
    for (n, factor), replayed in walls.items():
        faces, elements, edges = 4350 * n * n * factor**2, 870 * n**3 * factor**2, EDGES * n * factor**2
        for ranks in [1, 4, 16] + arguments.virtual:
            if faces / ranks < 100:
                continue
            search = model.search_counts(replayed, ranks) if ranks > 1 else model.Counts(1, faces)
            step = step_counts(search, counted, edges / faces, elements / ranks, ranks) if ranks > 1 else \
                model.Counts(1, faces, edges, elements)
            for kind, counts in (("search", search), ("step", step)):
                low, usual, high = model.seconds(costs[kind], counts)
                rows.append({"kind": kind, "wall": f"W({n})" + (f" x{factor**2}" if factor > 1 else ""), "faces": faces,
                             "elements": elements, "ranks": ranks, "least_s": low, "usual_s": usual, "largest_s": high,
                             "faces_of_rank": counts.faces, "boundary": counts.boundary, "messages": counts.messages,
                             "bytes": counts.bytes, **model.terms(costs[kind], counts)})
    return rows


def checks_of(arguments, measured, costs, cores, counted, n):
    """Predictions of the wall twice as long as the largest one on each number of ranks, beside its runs."""
    rows, largest = [], max(arguments.sizes)
    for ranks, threads in layouts_of(arguments, cores):
        for kind in ("search", "step"):
            case = (kind, largest, ranks, 1, 2 * ranks)
            if threads > 1 or case not in measured.seconds:
                continue
            faces = measured.faces[largest, 2 * ranks] / ranks
            elements = measured.elements[largest, 2 * ranks] / ranks
            edges = 2 * EDGES * largest
            counts = model.Counts(1, faces, edges, elements)
            if ranks > 1:  # the cut between two ranks is as high and thick as that of the counted wall, with finer elements
                found = counted[kind, ranks]
                finer = largest / n
                counts = model.Counts(ranks, faces, edges, elements, 2 * counted["search", ranks]["node_boxes"] / ranks * finer,
                                      found["messages"]["max"], found["bytes"]["max"] * finer, found["reductions"]["max"])
            low, usual, high = model.seconds(costs[kind], counts)
            run = measured.triple(*case)
            rows.append({"kind": kind, "ranks": ranks, "faces": faces * ranks, "predicted": (low, usual, high), "measured": run,
                         "error": usual / run[1] - 1})
    return rows


def replay_check(runs, counted, n):
    """Ghosts and partners of real runs beside those of the replay."""
    ranks = [p for kind, p in counted if kind == "search" and p > 2]
    rows = {int(row["ranks"]): row for row in runs.replay("wall", n, 1, *ranks)} if ranks else {}
    return [{"ranks": p, "ghosts": counted["search", p]["ghosts"] / p, "replayed_ghosts": float(row["faces_sent"]),
             "node_boxes": counted["search", p]["node_boxes"] / p, "replayed_node_boxes": float(row["node_boxes_sent"]),
             "partners": counted["search", p]["partners"], "replayed_partners": int(row["partners_max"])} for p, row in rows.items()]


def collect(arguments, runs, cores):
    messages = runs.message_costs()
    if messages is None:
        sys.exit("the scaling study needs two cores for the cost of a message")
    for name, value in (("latency", arguments.latency), ("seconds_per_byte", arguments.bandwidth and 1 / arguments.bandwidth)):
        if value:
            messages[name] = {part: value for part in ("min", "median", "max")}
    if arguments.latency:
        levels = math.log2(messages["ranks"])
        messages["reduction"] = {part: 2 * arguments.latency * levels for part in ("min", "median", "max")}
    measured = measure(arguments, runs, cores)
    n = min(4, max(arguments.sizes))
    counted = count_messages(arguments, runs, n)
    print("messages are counted", flush=True)
    weak = runs.replay("weak", *arguments.virtual)
    walls = replayed_walls(arguments, runs)
    print("walls are replayed on virtual ranks", flush=True)
    boundary = boundary_cost(weak)
    costs = {kind: costs_of(kind, measured, arguments, cores, boundary, messages) for kind in ("search", "step")}
    spheres = [runs.spheres(rows, ranks, arguments.searches) for rows in arguments.sphere_rows for ranks in (1, 2)
               if rows * ranks <= 60]
    return {"measured": measured, "counted": counted, "counted_wall": n, "weak": weak, "costs": costs, "messages": messages,
            "predicted": predictions(arguments, costs, walls, counted),
            "checks": checks_of(arguments, measured, costs, cores, counted, n), "replay": replay_check(runs, counted, n),
            "spheres": spheres}


def main():
    arguments = parse_arguments()
    arguments.output.mkdir(parents=True, exist_ok=True)
    place = machine.describe()
    cores = place["physical_cores"]
    build = Path(arguments.program).resolve().parent.parent
    subprocess.run(["cmake", "--build", build, "--target", "brickwall_scale"], check=True, stdout=subprocess.DEVNULL)
    runs = Runs(arguments.program, arguments.output / "runs", cores, arguments.limit)
    try:
        study = collect(arguments, runs, cores)
    except RunFailed as error:
        print(f"FAILED   {error}", file=sys.stderr)
        return 1
    study.update(machine=place, date=now(), arguments=vars(arguments))
    from scale_report import write

    for name in write(arguments.output, study):
        print(f"wrote    {arguments.output / name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
