"""Error against cost, log-log, with one colour for each group of settings and the Pareto front as
circles joined by a line."""
from brickwall_plot import style
from framework.figures import COLOURS, EXACT, new_figure, save
from front import by_setting, front
from scene import BOTH_MASSES, ROW_SUMS

COSTS = (("element-steps", lambda point: point.element_steps), ("seconds of the time loop", lambda point: point.seconds))
GROUPS = {"time step": (COLOURS[1], "v"), "penalty": (COLOURS[3], "s"), "penalty, longest step": (COLOURS[2], "^"),
          "element": (COLOURS[5], "D"), "scheme, edges": ("#4a7c59", "x"), "row sums": ("#7f3f98", "1"), "reuse": ("#2f6f9f", "+"), "several": ("#c9a227", "*"),
          "default": (COLOURS[0], "o")}


def draw(scene, points, path, uncertainty=0):
    figure, panels = new_figure(2, 7.5)
    for axes, (label, cost) in zip(panels, COSTS):
        labelled = set()
        for group, (colour, marker) in GROUPS.items():
            for setting, series in by_setting([point for point in points if point.setting.group == group]).items():
                series = sorted(series, key=cost)
                axes.loglog([cost(point) for point in series], [point.error for point in series], color=colour, marker=marker,
                            markersize=4, linewidth=1.8 if group == "default" else 0.6,
                            label=None if group in labelled else group)
                labelled.add(group)
        best = front(points, cost)
        axes.loglog([cost(point) for point in best], [point.error for point in best], "o--", color="#000000", linewidth=0.8,
                    markersize=9, markerfacecolor="none", markeredgewidth=0.8, label="Pareto front")
        if uncertainty:
            axes.axhline(uncertainty, label="uncertainty of the reference", **EXACT)
        axes.set(xlabel=label, ylabel="error")
    figure.suptitle(scene.name, fontsize=10)
    save(figure, path)


def draw_masses(results, path):
    """For each scene: the fronts of the settings that run with both nodal masses."""
    figure, panels = style.new_figure(2, (len(results) + 1) // 2, (11.0, 6.0))
    for axes, result in zip(panels, results):
        for label, settings, colour in (("masses with inertia", BOTH_MASSES, COLOURS[0]), ("row sums", ROW_SUMS, COLOURS[1])):
            points = front([point for point in result.points if point.setting in settings], COSTS[1][1])
            axes.loglog([point.seconds for point in points], [point.error for point in points], "o-", color=colour, markersize=4, label=label)
        axes.set(xlabel=COSTS[1][0], ylabel="error", title=result.scene.name)
    save(figure, path)


def draw_growth(growths, path):
    """Draws the growth of a change in the 13th digit beside the error."""
    figure, panels = new_figure(len(growths), 7.0)
    for axes, (name, growth) in zip(panels if len(growths) > 1 else [panels], growths.items()):
        milliseconds = 1e3 * growth["times"][1:]
        for label, key in (("displacement", "size"), ("error", "error"), ("change", "change")):
            axes.semilogy(milliseconds, growth[key][1:], label=label)
        if growth["time"]:
            axes.axvline(1e3 * growth["time"], label="t*", **EXACT)
        axes.set(xlabel="t, ms", ylabel="m, root mean square over bricks", title=f"{name}, {growth['mesh']}")
    save(figure, path)
