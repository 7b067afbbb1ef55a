"""The style of plots of curves and bars. No pyplot, whose state is global."""
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

COLOURS = ("#35124a", "#d1603d", "#ea9152", "#a8324a", "#6d1c55", "#8a8a8a")


def new_figure(rows, columns, size):
    """(figure, list of axes row by row); `size` in inches."""
    figure = Figure(figsize=size)
    FigureCanvasAgg(figure)
    all_axes = [figure.add_subplot(rows, columns, i + 1) for i in range(rows * columns)]
    for axes in all_axes:
        axes.set_prop_cycle(color=COLOURS)
        axes.grid(True, color="#dddddd")
        axes.set_axisbelow(True)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    return figure, all_axes


def save(figure, path, dpi=110):
    """Without the version of matplotlib, equal plots are equal files."""
    figure.savefig(path, dpi=dpi, metadata={"Software": None} if str(path).endswith(".png") else None)
