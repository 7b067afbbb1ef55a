"""The searches that the study of the paper's figures runs, and those that it leaves out, with the
reasons.

Sizes grow: the needs of a smaller wall tell whether a larger one fits into memory and time.
"""
from search_runs import WARMUP, Case, faces_of
from study_tables import counted, layout

PAPER_SIZES = (2, 8, 16, 32, 42, 64)
METHODS = ("reference", "paper", "cluster")
NODES_PER_FACE = 2.2  # of the walls, in which bodies share no nodes
# The reference tests all pairs. One test takes 1.0 to 2.0 ns (W(2), one core of an AMD EPYC, Zen
# 5).
SECONDS_PER_PAIR = 2e-9
# The estimate of a run's resident memory until one has been measured: `paper` took 130 MB for the
# 278,400 faces of W(8) on one rank.
BYTES_PER_FACE = 600
BYTES_PER_RANK = 40e6


def default_layouts(ranks, threads, cores):
    """(layouts, left out): ranks x threads as given, by default 1 and the paper's 4 ranks on 1 to
    all cores.

    More threads than cores run only if they were given. More ranks than cores run with one thread
    each, since CPU time without waits still measures their work.
    """
    given = threads is not None
    threads = threads or sorted({min(2**i, cores) for i in range(cores.bit_length() + 1)})
    layouts, left_out = [], []
    for r in ranks or [1, 4]:
        for t in threads:
            if given or r * t <= cores or t == threads[0]:
                layouts.append((r, t))
            else:
                left_out.append(f"{layout(r, t)}: more than the {cores} cores; -t {t} requests it")
    return layouts, left_out


class PaperPlan:
    """Yields the cases one by one; record() must get each result before the next case is taken."""

    def __init__(self, sizes, layouts, methods, repetitions, cores, memory, reference_seconds):
        self.sizes, self.layouts, self.methods, self.repetitions = sorted(sizes), layouts, methods, repetitions
        self.cores, self.memory, self.reference_seconds = cores, memory, reference_seconds
        self.left_out = []
        self.bytes_per_face = {}  # by method, measured
        self.out_of_time = {}  # (method, ranks, threads, local) -> the smallest such n

    def cases(self):
        for n in self.sizes:
            for method in self.methods:
                for ranks, threads in self.layouts:
                    yield from self._of_layout(n, method, ranks, threads)
                yield from self._first_search(n, method)

    def record(self, result):
        case = result.case
        if result.state == "out of time":
            self.out_of_time.setdefault((case.method, case.ranks, case.threads, case.local), case.n)
        if result.state == "ok":
            report = result.report
            measured = (report["memory"]["peak"]["sum_bytes"] - case.ranks * BYTES_PER_RANK) / report["faces"]
            if report["faces"] > 100_000:  # in smaller runs the memory of the program itself dominates
                self.bytes_per_face[case.method] = max(measured, self.bytes_per_face.get(case.method, 0))

    def memory_needed(self, n, method, ranks):
        return ranks * BYTES_PER_RANK + faces_of(n) * self.bytes_per_face.get(method, BYTES_PER_FACE)

    def _of_layout(self, n, method, ranks, threads):
        local = True
        if method == "reference":
            if (ranks, threads) != min(pair for pair in self.layouts if pair[0] == ranks):
                self._leave_out(f"reference, W({n}), {layout(ranks, threads)}: its loops are serial")
                return
            local = self._reference_seconds(n, ranks) <= self.reference_seconds
            if not local:
                self._leave_out(
                    f"reference, W({n}), {counted(ranks, 'rank')}: its local search of all pairs would take about "
                    f"{self._reference_seconds(n, ranks):.0f} s a run (--reference-seconds {self.reference_seconds:g})"
                    + ("" if ranks == 1 else "; its global search is run alone"))
                if ranks == 1:
                    return
        for timing in ("normal", "paper"):
            if self._can_run(n, method, ranks, threads, local):
                yield Case(n, method, ranks, threads, timing, False, local, self.repetitions)

    def _first_search(self, n, method):
        ranks, threads = self.layouts[0]
        if method != "reference" and self._can_run(n, method, ranks, threads, True):
            yield Case(n, method, ranks, threads, "normal", True, True, self.repetitions)

    def _can_run(self, n, method, ranks, threads, local):
        needed = self.memory_needed(n, method, ranks)
        if needed > self.memory:
            self._leave_out(f"{method}, W({n}), {counted(ranks, 'rank')}: needs about {needed / 1e9:.1f} GB, "
                            f"{self.memory / 1e9:.1f} GB are available (--memory)")
            return False
        smallest = self.out_of_time.get((method, ranks, threads, local))
        if smallest is not None:
            self._leave_out(f"{method}, W({n}), {layout(ranks, threads)}: W({smallest}) ran out of time (--limit)")
            return False
        return True

    def _reference_seconds(self, n, ranks):
        pairs = NODES_PER_FACE * (faces_of(n) / ranks) ** 2  # of a rank
        sharing = max(1, ranks / self.cores)
        return SECONDS_PER_PAIR * pairs * sharing * (WARMUP + self.repetitions)

    def _leave_out(self, reason):
        if reason not in self.left_out:
            self.left_out.append(reason)
