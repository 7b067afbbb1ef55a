"""The comparison of runs as a document: tables and charts, which page.py and tables.py put into a form."""
from dataclasses import dataclass, field

from .configurations import ENOUGH_FOR_RANKS, LEAST_REPETITIONS, OF_SIZE, SURE, compare, family_of, labels_of, place_of, problems_of
from .svg import Bars, Lines
from .tables import WORDS, Table, change, counted, number, percent

SMALL = 1e-3  # share of a step below which a phase is left out
ALIKE = 0.1  # runs of a weak scaling have the same size for each rank x thread within this
NOISE = (f"Times are medians over the repetitions. Noise is {SURE} standard deviations, estimated by the median absolute deviation x "
         f"1.4826; a change is beyond noise if the medians differ by more than {SURE} sqrt(s1^2 + s2^2), or if all of at least "
         f"{ENOUGH_FOR_RANKS} repetitions are slower than all of at least {ENOUGH_FOR_RANKS} others. With fewer than "
         f"{LEAST_REPETITIONS} repetitions nothing is said about noise.")


@dataclass
class Document:
    title: str
    lead: list  # paragraphs
    sections: list = field(default_factory=list)  # (heading, [text, Table, Lines or Bars])


def compare_runs(runs, title="Comparison of runs"):
    """The Document of runs; those of different decks and sizes stand in different sections."""
    problems = problems_of(runs)
    lead = [build_of(runs)]
    if len(problems) > 1:
        lead.append(f"These are {len(problems)} problems (decks, or sizes of a deck). Speed-ups compare runs of the same problem only.")
    document = Document(title, lead)
    for problem in problems:
        document.sections.append((problem.name, section_of(problem)))
    for heading, blocks in (("Throughput over size", throughput(problems)), ("Weak scaling", weak_scaling(problems))):
        if blocks:
            document.sections.append((heading, blocks))
    document.sections.append(("How to read this", [
        NOISE,
        "Speed-up is the time of the first configuration of the problem over this one. Efficiency is the speed-up over the first "
        "configuration that differs in ranks and threads only, divided by the ratio of ranks x threads (of ranks on a GPU). Shares "
        "and times of phases are means over the ranks; parts marked with a hyphen belong to the phase above. Imbalance is "
        "the largest rank over the mean; unless a search was run with --timing paper, its times include waits for "
        "other ranks, which hide a part of it."]))
    return document


def build_of(runs):
    def all_of(values):
        return " / ".join(dict.fromkeys(values))

    builds = [run.build for run in runs]
    return (f"{counted(len(runs), 'run')}; {all_of(run.cpu for run in runs)}"
            + "".join(f", {device}" for device in dict.fromkeys(run.device for run in runs) if device != "none")
            + f"; host {all_of(run.host for run in runs)}; brickwall {all_of(b['version'] for b in builds)}, commit "
            f"{all_of(b['commit'] for b in builds)}, {all_of(b['compiler'] for b in builds)}, Kokkos {all_of(b['kokkos'] for b in builds)} "
            f"{all_of(b['execution_space'] for b in builds)}, {all_of(b['mpi'] for b in builds)}.")


def section_of(problem):
    blocks = [problem.first.title] if problem.first.title else []
    blocks += [f"{run.path.parent}: {run.ended}" for run in (run for c in problem.configurations for run in c.runs) if run.ended]
    if len({c.first.settings.get("restart") for c in problem.configurations}) > 1:
        blocks.append("A restarted run has timed only the steps since its restart, in which other bodies may touch: its changes of "
                      "times are not those of the program alone.")
    blocks += [overview(problem), phases(problem), *charts(problem), *imbalance(problem), counts(problem)]
    return [block for block in blocks if block]


def overview(problem):
    unit = problem.first.unit
    header = ["ranks x threads", "runs", f"ms a {unit}", "noise", "speed-up", "efficiency",
              "element steps/s" if unit == "step" else "face searches/s", "change"]
    rows, marks = [], {}
    for configuration in problem.configurations:
        whole, is_first = configuration.whole, configuration is problem.base
        verdict = compare(problem.base.whole, whole)
        if not is_first and verdict in ("more", "less"):
            marks[len(rows), 7] = verdict
        rows.append([
            configuration.label, str(len(configuration.runs)), number(1e3 * whole.median),
            percent(whole.deviation and SURE * whole.deviation / whole.median), number(problem.base.whole.median / whole.median),
            percent(efficiency(problem, configuration), 3), number(configuration.sample(lambda run: run.throughput).median),
            "" if is_first else f"{change(whole.median / problem.base.whole.median)}, {WORDS[verdict]}"])
    return Table("Speed; changes with respect to the first row", header, rows, marks)


def efficiency(problem, configuration):
    base = problem.base_of(configuration)
    return base.whole.median / configuration.whole.median * base.first.workers / configuration.first.workers


def phases(problem):
    """Time, time a step, share and change of each phase, side by side."""
    unit, names = problem.first.unit, phase_names(problem)
    table = Table(f"Phases: seconds in total, ms a {unit}, share, change with respect to the first", ["phase"], [])
    for configuration in problem.configurations:
        shown = ["s", "ms", "share", "change"][:3 if configuration is problem.base else 4]
        table.groups.append((configuration.label, len(shown)))
        table.header += shown
    for name in [*names, f"whole {unit}"]:
        row, base = [name], phase_of(problem.base, name)
        for configuration in problem.configurations:
            sample = phase_of(configuration, name)
            if sample is None:
                row += ["-"] * (3 if configuration is problem.base else 4)
                continue
            steps = configuration.sample(lambda run: run.steps).median
            row += [number(sample.median * steps), number(1e3 * sample.median), percent(sample.median / configuration.whole.median)]
            if configuration is problem.base:
                continue
            if not base or base.median == 0:
                row.append("-")
                continue
            verdict = compare(base, sample)
            if verdict in ("more", "less"):
                table.marks[len(table.rows), len(row)] = verdict
            row.append(change(sample.median / base.median))
        table.rows.append(row)
    table.note = f"Phases below {100 * SMALL:g} % of the {unit} are left out." + (" Marked changes are beyond noise." if table.marks else "")
    return table


def phase_of(configuration, name):
    return configuration.whole if name.startswith("whole ") else configuration.phase(name)


def phase_names(problem, least=SMALL):
    """Phases that take at least this share in some configuration."""
    names = dict.fromkeys(name for c in problem.configurations for run in c.runs for name in run.phases)

    def share(configuration, name):
        sample = configuration.phase(name)
        return sample.median / configuration.whole.median if sample else 0

    return [name for name in names if any(share(c, name) >= least for c in problem.configurations)]


def charts(problem):
    unit = problem.first.unit
    # Small phases are joined, so that the colours can be told apart.
    kept = [name for name in phase_names(problem, 0.01) if not name.startswith("-") and name != "other"]
    bars = []
    for configuration in problem.configurations:
        values = [1e3 * (sample.median if sample else 0) for sample in map(configuration.phase, kept)]
        bars.append((configuration.label, values + [max(0.0, 1e3 * configuration.whole.median - sum(values))]))
    found = [Bars(f"Where the time of a {unit} goes", f"ms a {unit}", kept + ["other"], bars)]
    return found + scaling_charts(problem)


def scaling_charts(problem):
    """Speed-up over ranks x threads, where a series has several."""
    series = {}
    for configuration in problem.configurations:
        series.setdefault(configuration.series, []).append(configuration)
    series = {key: group for key, group in series.items() if len({c.first.workers for c in group}) > 1}
    if not series:
        return []
    lines, workers = [], set()
    for group in series.values():
        base, by_rank = group[0], {}
        for configuration in group:  # more ranks and more threads are lines of their own
            by_rank.setdefault("threads" if configuration.first.ranks == base.first.ranks else "ranks", []).append(configuration)
        for what, some in by_rank.items():
            some = sorted(([base] if base not in some else []) + some, key=lambda c: c.first.workers)
            points = [(c.first.workers, *speed_ups(base, c)) for c in some]
            workers.update(point[0] for point in points)
            rest = base.label.split(", ", 1)[1:]
            if len(some) > 1:
                lines.append((", ".join([f"{what} from {base.first.layout}", *rest]), points))
    least = min(group[0].first.workers for group in series.values())
    ticks = sorted(workers)
    ideal = [(count, count / least) for count in ticks]
    unit = "ranks" if problem.first.device != "none" else "ranks x threads"
    return [Lines("Speed-up", unit, "speed-up", lines, ideal, ticks=ticks)]


def speed_ups(base, configuration):
    """By the median, the slowest and the fastest repetition."""
    whole = configuration.whole
    return [base.whole.median / time for time in (whole.median, max(whole.values), min(whole.values))]


def imbalance(problem):
    names = list(dict.fromkeys(name for c in problem.configurations for run in c.runs for name in run.imbalance))
    missing = [text for c in problem.configurations for run in c.runs for text in run.missing]
    more = f", and {len(missing) - 1} more" if missing[1:] else ""
    notes = [f"The imbalance is incomplete: {missing[0]}{more}."] if missing else []
    if not names or all(c.first.ranks == 1 for c in problem.configurations):
        return notes
    rows = []
    for configuration in problem.configurations:
        samples = [configuration.sample(lambda run: run.imbalance.get(name)) for name in names]
        rows.append([configuration.label] + [number(sample and sample.median) for sample in samples])
    return [Table("Imbalance: largest rank over the mean, of times and counts", ["ranks x threads", *names], rows), *notes]


def counts(problem):
    names = list(dict.fromkeys(name for c in problem.configurations for run in c.runs for name in run.counts))
    header = ["ranks x threads", *names] + (["energy error", "state at the end"] if problem.first.kind == "run" else [])
    rows = []
    for configuration in problem.configurations:
        row = [configuration.label] + [same(run.counts.get(name, "-") for run in configuration.runs) for name in names]
        if problem.first.kind == "run":
            row += [same(f"{run.energy_error:.2e}" for run in configuration.runs), bits(problem, configuration)]
        rows.append(row)
    return Table("Counts in the last step" if problem.first.kind == "run" else "Counts in the last search", header, rows)


def same(values):
    values = list(dict.fromkeys(values))
    shown = [number(value) if isinstance(value, int) else value for value in values]
    return shown[0] if len(shown) == 1 else f"{shown[0]} ... differ"


def bits(problem, configuration):
    """Whether the state at the end has the bits of the first configuration, after as many steps."""
    first = problem.first
    if not first.checksum or any(not run.checksum for run in configuration.runs):
        return "-"
    if any(run.checksum != first.checksum for run in configuration.runs):
        return "differs" if all(run.counts["steps"] == first.counts["steps"] for run in configuration.runs) else "other steps"
    return "same bits" if configuration is not problem.base or len(configuration.runs) > 1 else "-"


def families(problems):
    """[[configuration, ...], ...]: those of different sizes that are otherwise alike."""
    found = {}
    for problem in problems:
        for configuration in problem.configurations:
            found.setdefault(family_of(configuration.first), []).append(configuration)
    return [family for family in found.values() if len({c.first.size for c in family}) > 1]


def throughput(problems):
    """Work per second over the size of the problem, a line for each layout, program and machine."""
    blocks = []
    for family in families(problems):
        curves = {}
        for configuration, label in zip(family, labels_of([c.first for c in family], OF_SIZE)):
            curves.setdefault(label, []).append(configuration)
        curves = {label: sorted(group, key=lambda c: c.first.size) for label, group in curves.items()
                  if len({c.first.size for c in group}) > 1}
        if not curves:
            continue
        first = family[0].first
        what, rate = ("elements", "element steps/s") if first.kind == "run" else ("faces", "face searches/s")
        rows, series = [], []
        for label, group in curves.items():
            samples = [c.sample(lambda run: run.throughput) for c in group]
            series.append((label, [(c.first.size, s.median, min(s.values), max(s.values)) for c, s in zip(group, samples)]))
            rows += [[f"{c.first.name}, {label}", number(c.first.size), memory(c), str(len(c.runs)), number(1e3 * c.whole.median),
                      number(s.median)] for c, s in zip(group, samples)]
        names = ", ".join(dict.fromkeys(c.first.name for c in family))
        header = ["case, ranks x threads", what, "memory of a rank or GPU, MB", "runs", f"ms a {first.unit}", rate]
        blocks += [Table(f"Throughput: {names}", header, rows),
                   Lines(f"Throughput over size: {names}", what, rate, series)]
    return blocks


def memory(configuration):
    """That of the largest rank; on a GPU what all processes use, with its share."""
    run = configuration.first
    return number(1e-6 * run.memory) + (f" ({percent(run.memory_share)})" if run.memory_share is not None else "")


def weak_scaling(problems):
    """Runs of one program and machine with the same size for each rank x thread, within 10 %."""
    blocks = []
    for family in families(problems):
        groups = []  # configurations of one load, by rising ranks x threads
        for configuration in sorted(family, key=lambda c: (c.first.workers, c.first.size)):
            group = next((group for group in groups if is_of_load(configuration.first, group[0].first)), None)
            if group is None:
                groups.append([configuration])
            elif configuration.first.workers > group[-1].first.workers:
                group.append(configuration)
        blocks += [block for group in groups if len(group) > 1 for block in weak_scaling_of(group)]
    return blocks


def is_of_load(run, first):
    return (run.build, place_of(run)) == (first.build, place_of(first)) and abs(
        run.size / run.workers / (first.size / first.workers) - 1) <= ALIKE


def weak_scaling_of(group):
    base = group[0]
    what = "elements" if base.first.kind == "run" else "faces"
    rows = [[c.first.layout, number(c.first.size), number(round(c.first.size / c.first.workers)), str(len(c.runs)),
             number(1e3 * c.whole.median), percent(base.whole.median / c.whole.median, 3)] for c in group]
    points = [(c.first.workers, *speed_ups(base, c)) for c in group]
    ticks = [point[0] for point in points]
    header = ["ranks x threads", what, "for each", "runs", f"ms a {base.first.unit}", "efficiency"]
    return [Table(f"Weak scaling: {base.first.name}", header, rows),
            Lines("Efficiency of weak scaling", "ranks x threads", "efficiency", [("measured", points)],
                  [(ticks[0], 1.0), (ticks[-1], 1.0)], logarithmic=False, ticks=ticks)]
