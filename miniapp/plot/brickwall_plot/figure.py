"""A picture of a scene with its title, colour bar, axes and arrows. The view, the colours and the length of the arrows
are the same in all steps of an animation."""
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from .camera import Camera
from .colours import colour_map
from .errors import PlotError
from .painter import Canvas, Painter
from .units import quantity_of, round_below

INK, GREY = "#1a1717", "#5c5757"
LONGEST_ARROW = 0.07  # over the diagonal of the picture
BAR = 0.13  # share of the width that is kept for the colour bar
NO_COLOUR = np.array([[241, 230, 211]], dtype=np.uint8)  # of a mesh without steps


class Pictures:
    """Draws steps of a scene with options of the command line (options.py)."""

    def __init__(self, scene, steps, options, samples, units):
        self.scene, self.options, self.units = scene, options, units
        self.width, self.height = options.size
        self._choose_view(steps, samples)
        shades = self._choose_colours(steps) if scene.field else NO_COLOUR
        self.painter = Painter(self.canvas, self.camera, scene.surface, shades)
        self.longest = max((np.linalg.norm(scene.vectors(step)[1], axis=1).max(initial=0) for step in steps), default=0) \
            if scene.arrows else 0

    def _choose_view(self, steps, samples):
        options, points = self.options, self.scene.points
        boxes = [extent(points(step)) for step in steps]
        for step, box in zip(steps, boxes):
            if not np.isfinite(box).all():
                raise PlotError(f"{self.scene.results.paths[0]}: the displacements of step {step} are not finite")
        self.camera = Camera(*hull(boxes), *options.view, options.parallel)
        low, high = hull([extent(self.camera.project(points(step))[0]) for step in steps])
        margin = 0.04 * (high - low).max()
        low, high = low - margin, high + margin
        self.top = 0 if options.bare else round(0.08 * self.height)  # of the painted area, pixels
        if not options.bare:
            high[0] += (high[0] - low[0]) * BAR / (1 - BAR)
        self.canvas = Canvas(self.width, self.height - self.top, low, high, samples, options.outline * self.width / 1500,
                             options.mesh, options.plain)

    def _choose_colours(self, steps):
        """The shades [shade][rgb]; sets the range, the map and the label."""
        options, name = self.options, self.scene.field
        self.range = self.found = options.range
        if not options.range:
            low, high = self.found = hull([extent(values[np.isfinite(values)]) for values in map(self.scene.values, steps)])
            if not low <= high:
                raise PlotError(f"{self.scene.results.paths[0]}: {name} has no finite values here")
            self.range = (low, high) if high > low else (low, low + (abs(low) or 1.0))
        self.map = colour_map(options.colours, *self.range)
        self.factor, unit = self.units.scaled(quantity_of(name), max(map(abs, self.range)))
        self.label = self.scene.label() + (f" ({unit})" if unit else "")
        if options.label:
            self.factor, self.label = 1.0, options.label
        return np.rint(self.map(np.arange(self.map.N))[:, :3] * 255).astype(np.uint8)

    def draw(self, step):
        """The figure of a step."""
        options, scene = self.options, self.scene
        figure = Figure(figsize=(10, 10 * self.height / self.width), dpi=self.width / 10, facecolor="white")
        FigureCanvasAgg(figure)
        values = scene.values(step)
        if values is not None:
            values = (values - self.range[0]) / (self.range[1] - self.range[0])
        picture = self.painter.paint(scene.points(step), values)
        figure.figimage(picture, origin="upper", zorder=-1)
        if self.longest:
            self._draw_arrows(figure, *scene.vectors(step))
        if not options.bare:
            self._draw_text(figure, step)
            self._draw_axes(figure)
            if scene.field:
                self._draw_bar(figure)
        return figure

    def _draw_text(self, figure, step):
        title = self.options.title if self.options.title is not None else self.scene.results.title()
        figure.text(0.04, 0.953, title, fontsize=15, weight="semibold", va="center", color=INK)
        times, notes = self.scene.results.times, []
        if len(times):
            factor, unit = self.units.scaled("time", abs(times).max())
            digits = max(0, 4 - len(f"{abs(times).max() * factor:.0f}"))
            notes.append(f"t = {times[step] * factor:.{digits}f} {unit}".rstrip())
        if self.scene.displacement is None:
            notes.append("undeformed: the file has no displacement")
        elif self.scene.scale != 1:
            notes.append(f"displacements × {self.scene.scale:g}")
        figure.text(0.04, 0.915, ",   ".join(notes), fontsize=11, color=GREY, va="center")

    def _draw_bar(self, figure):
        norm = Normalize(self.range[0] * self.factor, self.range[1] * self.factor)
        extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get(
            (self.found[0] < self.range[0], self.found[1] > self.range[1]), "neither")
        bar = figure.colorbar(ScalarMappable(norm, self.map), cax=figure.add_axes([0.885, 0.27, 0.02, 0.57]), extend=extend)
        bar.set_label(self.label, fontsize=11, color=INK)
        bar.outline.set_visible(False)
        bar.formatter.set_powerlimits((-3, 4))
        bar.update_ticks()

    def _draw_axes(self, figure):
        """The directions of x, y, z in the lower right corner."""
        axes = figure.add_axes([0.88, 0.095, 0.1, 0.1 * self.width / self.height])
        axes.set(xlim=(-1.35, 1.35), ylim=(-1.35, 1.35))
        axes.set_axis_off()
        for i, name in enumerate("xyz"):
            tip = np.array([self.camera.right[i], self.camera.up[i]])
            if np.linalg.norm(tip) < 0.1:
                continue  # seen from its end
            axes.annotate("", tip * 0.85, (0, 0), arrowprops={"arrowstyle": "-|>", "color": GREY, "lw": 0.9, "shrinkA": 0, "shrinkB": 0,
                                                              "mutation_scale": 7})
            axes.text(*(tip + 0.22 * tip / np.linalg.norm(tip)), name, fontsize=9, color=GREY, ha="center", va="center", style="italic")

    def _draw_arrows(self, figure, points, vectors):
        overlay = figure.add_axes([0, 0, 1, 1])
        overlay.set(xlim=(0, self.width), ylim=(self.height, 0))
        overlay.set_axis_off()
        length = LONGEST_ARROW * np.hypot(self.width, self.height) / self.canvas.scale / self.longest  # length/value
        tails, tips = (self.canvas.pixels(self.camera.project(p)[0]) + [0, self.top] for p in (points, points + vectors * length))
        far = np.argsort(points @ self.camera.towards_eye, kind="stable")
        thickness = self.width / 1500
        overlay.add_collection(arrow_shapes(tails[far], tips[far], thickness))
        if self.options.bare:
            return
        # The key: an arrow of a round value.
        value = round_below(self.longest)
        factor, unit = self.units.scaled(quantity_of(self.scene.arrows), value)
        end = np.array([[0.97 * self.width, 0.962 * self.height]])
        overlay.add_collection(arrow_shapes(end - [value * length * self.canvas.scale, 0], end, thickness))
        overlay.text(end[0, 0], end[0, 1] - 14 * thickness, f"{self.scene.arrows.replace('_', ' ')}: {value * factor:g} {unit}".rstrip(),
                     fontsize=9, color=INK, ha="right", va="bottom")


def extent(values):
    """The least and the largest values of rows; inf, -inf without rows."""
    return values.min(axis=0, initial=np.inf), values.max(axis=0, initial=-np.inf)


def hull(extents):
    """The least and the largest of several extents."""
    return np.min([low for low, _ in extents], axis=0), np.max([high for _, high in extents], axis=0)


def arrow_shapes(tails, tips, thickness):
    """Arrows as polygons with a light rim; short ones are all head, and the shortest are left out."""
    way = tips - tails
    length = np.linalg.norm(way, axis=1)
    tails, tips, way, length = (part[length > 8 * thickness] for part in (tails, tips, way, length))
    along = way / length[:, None]
    size = np.minimum(thickness, length / 20)[:, None]  # pixels
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) * size
    neck = tips - 13 * along * size
    shape = [tails + 1.4 * across, neck + 1.4 * across, neck + 4.5 * across, tips, neck - 4.5 * across, neck - 1.4 * across,
             tails - 1.4 * across]
    return PolyCollection(np.stack(shape, axis=1), facecolors=INK, edgecolors="white", linewidths=0.5)
