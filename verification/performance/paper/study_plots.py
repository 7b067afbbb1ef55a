"""Plots of the paper's Figs. 8 to 11 from the rows of a study (study_tables.row_of).

Where the ranks share cores, wall-clock time depends on how the system shared them: the plots then
show CPU time per rank without waits (mean over ranks, --timing paper), and the axis says so.
"""
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from study_tables import TIMERS, column, counted

COLOURS = {"reference": "#8a8a8a", "paper": "#d1603d", "cluster": "#35124a"}
MARKERS = {"reference": "s", "paper": "o", "cluster": "^"}
LARGE_SEARCHES = ("searches 0 and 1", "search 2")


class Figures:
    def __init__(self, rows, cores, folder, subtitle):
        # The sizes are the ticks of the axis of faces, such as "278K".
        self.faces = sorted({row["faces"] for row in rows if row["state"] == "ok"})
        self.rows = [row for row in rows if row["state"] == "ok" and not row["shuffled"]]
        self.cores, self.folder, self.subtitle = cores, folder, subtitle

    def draw_all(self):
        """Draws all figures for which there are runs; returns the names of the files."""
        plt.rcParams.update({"axes.grid": True, "grid.color": "#dddddd", "axes.spines.top": False,
                             "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 7,
                             "legend.handlelength": 3.5,
                             "axes.axisbelow": True, "font.size": 9})
        ranks = self._ranks_for_sizes()
        figures = {"fig08_search_time.png": self._search_time(ranks), "fig09_migration.png": self._migration(ranks),
                   "fig10_threads.png": self._threads(), "fig11_timers.png": self._timers(ranks)}
        written = []
        for name, figure in figures.items():
            if figure is not None:
                lines = textwrap.wrap(self.subtitle, int(15 * figure.get_figwidth()))
                figure.text(0.01, 0.01, "\n".join(lines), fontsize=7, color="#555555")
                figure.tight_layout(rect=(0, 0.01 + 0.03 * len(lines), 1, 1))
                figure.savefig(self.folder / name, dpi=130)
                plt.close(figure)
                written.append(name)
        return written

    # The paper's 4 ranks if there are such runs, otherwise the largest number.
    def _ranks_for_sizes(self):
        ranks = {row["ranks"] for row in self.rows}
        return 4 if 4 in ranks else max(ranks, default=1)

    def _clock(self, ranks, threads=1):
        """("cpu" or "wall", the axis' label)."""
        if ranks > self.cores and threads == 1:
            return "cpu", f"CPU ms per rank ({ranks} ranks share {self.cores} cores)"
        return "wall", "wall clock, ms"

    def _pick(self, **values):
        return [row for row in self.rows if all(row[key] == value for key, value in values.items())]

    def _part(self, row, part, clock):
        return row.get(f"{part}_cpu_mean_ms" if clock == "cpu" else f"{part}_median_ms")

    def _timers_sum(self, row, timers, clock):
        return sum(row[column(timer, "cpu_mean" if clock == "cpu" else "mean")] for timer in timers)

    def _by_faces(self, axis, ranks, timing, value, style, label):
        """A line for each method against the number of faces, with the smallest number of
        threads."""
        threads = min(row["threads"] for row in self._pick(ranks=ranks))
        for method in COLOURS:
            points = sorted((row["faces"], value(row)) for row in self._pick(ranks=ranks, threads=threads, method=method,
                                                                               timing=timing) if value(row) is not None)
            if points:
                axis.loglog(*zip(*points), style, marker=MARKERS[method], color=COLOURS[method], markersize=4,
                            label=f"{method}{label}")
        axis.set_xticks(self.faces, [f"{faces / 1000:.0f}K" for faces in self.faces])
        axis.minorticks_off()
        axis.set_xlabel("faces")

    def _search_time(self, ranks):
        if not self._pick(ranks=ranks):
            return None
        clock, unit = self._clock(ranks)
        timing = "paper" if clock == "cpu" else "normal"
        figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
        self._by_faces(left, ranks, timing, lambda r: self._part(r, "search", clock), "-", ", with local pairs")
        self._by_faces(left, ranks, timing, lambda r: self._part(r, "global_search", clock), "--", ", global search")
        left.set(title=f"Search time, {counted(ranks, 'rank')}", ylabel=unit)
        for timer, style in zip(LARGE_SEARCHES, ("-", "--")):
            self._by_faces(right, ranks, "paper", lambda r, t=timer: self._timers_sum(r, (t,), clock) or None, style,
                           f", {timer}")
        right.set(title="Searches 0, 1 and 2 alone", ylabel=unit)
        for axis in (left, right):
            if axis.has_data():
                axis.legend()
        return figure

    def _migration(self, ranks):
        if not self._pick(ranks=ranks, timing="paper"):
            return None
        clock, unit = self._clock(ranks)
        figure, axis = plt.subplots(figsize=(6, 4.2))
        whole = [timer for timer in TIMERS if timer != "waiting"]
        self._by_faces(axis, ranks, "paper", lambda r: self._timers_sum(r, whole, clock), "-", ", phases 1 to 6")
        self._by_faces(axis, ranks, "paper", lambda r: self._timers_sum(r, ("migration",), clock) or None, "--",
                       ", migration")
        axis.set(title=f"Ghosting function and migration, {counted(ranks, 'rank')}, without waits", ylabel=unit)
        axis.legend()
        return figure

    def _threads(self):
        """The largest wall among the runs on the smallest number of ranks that have several thread
        counts."""
        counts = {}
        for row in self._pick(timing="normal"):
            counts.setdefault((row["ranks"], row["n"]), set()).add(row["threads"])
        several = [(-ranks, n) for (ranks, n), threads in counts.items() if len(threads) > 1]
        if not several:
            return None
        ranks, n = -max(several)[0], max(several)[1]
        figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
        most = max(counts[ranks, n])
        for method in COLOURS:
            for part, style, label in (("search", "-", ""), ("global_search", "--", ", global search")):
                points = sorted((row["threads"], row[f"{part}_median_ms"])
                                for row in self._pick(ranks=ranks, n=n, method=method, timing="normal")
                                if row.get(f"{part}_median_ms") is not None)
                if len(points) < 2:
                    continue
                threads, times = zip(*points)
                look = dict(marker=MARKERS[method], color=COLOURS[method], markersize=4, label=method + label)
                left.loglog(threads, times, style, **look)
                right.plot(threads, [times[0] / time * threads[0] for time in times], style, **look)
        right.plot([1, most], [1, most], ":", color="#999999", label="ideal")
        left.set(title=f"W({n}), {counted(ranks, 'rank')}", xlabel="threads per rank", ylabel="wall clock, ms")
        right.set(title="Speed-up", xlabel="threads per rank", ylabel="times faster than one thread")
        for axis in (left, right):
            axis.set_xticks(sorted(counts[ranks, n]), [str(t) for t in sorted(counts[ranks, n])])
            axis.minorticks_off()
            axis.legend()
        return figure

    def _timers(self, ranks):
        """The paper's 4458K case, W(32), if it ran, otherwise the largest wall."""
        rows = self._pick(ranks=ranks, timing="paper")
        if not rows:
            return None
        sizes = {row["n"] for row in rows}
        n = 32 if 32 in sizes else max(sizes)
        order = list(COLOURS)
        rows = sorted((row for row in rows if row["n"] == n), key=lambda r: (order.index(r["method"]), r["threads"]))
        clocks = {self._clock(ranks, row["threads"]) for row in rows}
        clock, unit = clocks.pop() if len(clocks) == 1 else ("wall", "wall clock, ms")
        figure, axis = plt.subplots(figsize=(max(6, 1.2 * len(rows) + 4), 4.8))
        names = [f"{row['method']}\n{counted(row['threads'], 'thread')}" for row in rows]
        bottoms = [0.0] * len(rows)
        colours = plt.get_cmap("tab20")
        for i, timer in enumerate(TIMERS):
            heights = [max(0.0, self._timers_sum(row, (timer,), clock)) for row in rows]
            axis.bar(names, heights, 0.6, bottom=bottoms, color=colours(i), label=timer)
            bottoms = [bottom + height for bottom, height in zip(bottoms, heights)]
        axis.grid(axis="x", visible=False)
        axis.set(title=f"The 13 timers of the global search, W({n}), {counted(ranks, 'rank')}",
                 ylabel=f"{unit}, mean over ranks")
        handles, labels = axis.get_legend_handles_labels()
        axis.legend(handles[::-1], labels[::-1], loc="center left", bbox_to_anchor=(1, 0.5))
        return figure
