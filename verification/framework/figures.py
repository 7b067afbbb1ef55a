"""The style of all plots. No pyplot, whose state is global: cases run concurrently."""
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

COLOURS = ("#35124a", "#d1603d", "#ea9152", "#a8324a", "#6d1c55", "#8a8a8a")
EXACT = {"color": "#8a8a8a", "linewidth": 1.2, "linestyle": "--"}  # style of exact solutions


def new_figure(panels, width):
    figure = Figure(figsize=(width * (1 if panels == 1 else 1.5), 0.62 * width))
    FigureCanvasAgg(figure)
    all_axes = [figure.add_subplot(1, panels, i + 1) for i in range(panels)]
    for axes in all_axes:
        axes.set_prop_cycle(color=COLOURS)
        axes.grid(True, color="#dddddd")
        axes.set_axisbelow(True)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    return figure, all_axes[0] if panels == 1 else all_axes


def save(figure, path):
    for axes in figure.axes:
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    # Without the version of matplotlib, equal plots are equal files.
    figure.savefig(path, dpi=110, metadata={"Software": None})


def draw_slope(axes, sizes, errors, order):
    """A dashed line of the given order through the finest point of a log-log plot."""
    finest = min(range(len(sizes)), key=lambda i: sizes[i])
    axes.loglog(sizes, [errors[finest] * (size / sizes[finest])**order for size in sizes], label=f"order {order:g}", **EXACT)
