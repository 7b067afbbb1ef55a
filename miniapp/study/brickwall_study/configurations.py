"""Groups runs: repetitions to configurations, configurations of one problem to a group; medians and noise of repetitions."""
import statistics
from dataclasses import dataclass

LEAST_REPETITIONS = 3  # for a statement on noise
ENOUGH_FOR_RANKS = 5  # repetitions, of which it means something that all are slower than all others
NORMAL = 1.4826  # the standard deviation of normal noise over its median absolute deviation
SURE = 3  # standard deviations
BUILD_LABELS = ("execution_space", "commit", "version", "compiler", "kokkos", "mpi", "flags")  # in the order of preference
OF_SIZE = ("wall.", "mesh.")  # settings that give the size of a problem


@dataclass(frozen=True)
class Sample:
    """Values of the repetitions of one configuration."""

    values: tuple

    @property
    def median(self):
        return statistics.median(self.values)

    @property
    def deviation(self):
        """The standard deviation, estimated by the median absolute deviation, which outliers do not move; None if there
        are too few repetitions."""
        if len(self.values) < LEAST_REPETITIONS:
            return None
        return NORMAL * statistics.median(abs(value - self.median) for value in self.values)


def compare(first, other):
    """"more" or "less" if the medians differ by more than the noise, SURE sqrt(s1^2 + s2^2) with the deviations s1 and
    s2 of both samples, or if the samples do not overlap, which by chance happens to two samples of five in 2/252 of all
    cases; "same" otherwise; "unknown" if either has too few repetitions."""
    if first.deviation is None or other.deviation is None:
        return "unknown"
    is_beyond = abs(other.median - first.median) > SURE * (first.deviation**2 + other.deviation**2)**0.5
    if min(len(first.values), len(other.values)) >= ENOUGH_FOR_RANKS:
        is_beyond |= max(first.values) < min(other.values) or max(other.values) < min(first.values)
    return "same" if not is_beyond else "more" if other.median > first.median else "less"


class Configuration:
    """Repetitions of one run: of one problem, with the same settings, program, machine, ranks and threads."""

    def __init__(self, runs):
        self.runs, self.first, self.label = runs, runs[0], ""

    def sample(self, value):
        """The Sample of value(run), without runs in which it is None; None if there is none."""
        values = tuple(found for found in map(value, self.runs) if found is not None)
        return Sample(values) if values else None

    @property
    def whole(self):
        return self.sample(lambda run: run.whole)

    def phase(self, name):
        return self.sample(lambda run: run.phases.get(name))

    @property
    def series(self):
        """Equal for configurations that differ in ranks and threads only."""
        return series_of(self.first)


class Problem:
    """All configurations of a deck at one size, in the order of the runs."""

    def __init__(self, runs):
        groups = {}
        for run in runs:
            groups.setdefault((series_of(run), run.ranks, run.threads), []).append(run)
        self.configurations = [Configuration(group) for group in groups.values()]
        self.first = runs[0]
        for configuration, label in zip(self.configurations, labels_of([c.first for c in self.configurations])):
            configuration.label = label

    @property
    def base(self):
        return self.configurations[0]

    @property
    def name(self):
        sizes = ", ".join(f"{number:,} {what}" for what, number in self.first.sizes.items())
        return f"{self.first.name}: {sizes}" + ("" if self.first.kind == "run" else " (search only)")

    def base_of(self, configuration):
        """The first configuration that differs from this one in ranks and threads only."""
        return next(other for other in self.configurations if other.series == configuration.series)


def problems_of(runs):
    groups = {}
    for run in runs:
        groups.setdefault((run.kind, run.name, run.case, tuple(run.sizes.items())), []).append(run)
    return [Problem(group) for group in groups.values()]


def hashable(settings):
    return tuple(sorted((key, repr(value)) for key, value in settings.items()))


def place_of(run):
    return run.cpu, run.device


def series_of(run):
    return hashable(run.settings), tuple(run.build.values()), place_of(run)


def labels_of(runs, without=()):
    """"ranks x threads" of each run, and all else in which they differ, except for settings that begin with `without`."""
    keys = dict.fromkeys(key for run in runs for key in run.settings if not key.startswith(tuple(without)))
    differing = [key for key in keys if len({repr(run.settings.get(key)) for run in runs}) > 1]
    builds = [name for name in BUILD_LABELS if len({run.build[name] for run in runs}) > 1]
    # One name of the build is enough if it tells all of them apart.
    number = len({tuple(run.build.values()) for run in runs})
    builds = next(([name] for name in builds if len({run.build[name] for run in runs}) == number), builds)
    labels = []
    for run in runs:
        words = [run.layout] + [f"{key.split('.')[-1]} {spell(run.settings.get(key, 'none'))}" for key in differing]
        words += [run.build[name] if name == "execution_space" else f"{name} {run.build[name]}" for name in builds]
        words += [run.device if run.device != "none" else run.cpu] if len(set(map(place_of, runs))) > 1 else []
        labels.append(", ".join(words))
    return labels


def spell(value):
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else str(value)


def family_of(run):
    """Equal for runs of any size, program and machine that are otherwise alike: the settings without wall and mesh."""
    return run.kind, hashable({key: value for key, value in run.settings.items() if not key.startswith(OF_SIZE)})
