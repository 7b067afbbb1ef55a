"""The style of all plots. No pyplot, whose state is global: cases run concurrently."""
from brickwall_plot import style
from brickwall_plot.style import COLOURS

EXACT = {"color": "#8a8a8a", "linewidth": 1.2, "linestyle": "--"}  # style of exact solutions


def new_figure(panels, width):
    figure, all_axes = style.new_figure(1, panels, (width * (1 if panels == 1 else 1.5), 0.62 * width))
    return figure, all_axes[0] if panels == 1 else all_axes


def save(figure, path):
    for axes in figure.axes:
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    style.save(figure, path)


def draw_slope(axes, sizes, errors, order):
    """A dashed line of the given order through the finest point of a log-log plot."""
    finest = min(range(len(sizes)), key=lambda i: sizes[i])
    axes.loglog(sizes, [errors[finest] * (size / sizes[finest])**order for size in sizes], label=f"order {order:g}", **EXACT)
