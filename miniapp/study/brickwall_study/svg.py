"""Charts as SVG texts: lines over a number, and stacked bars. Nothing is drawn by a library, so that a page needs none."""
import math
from dataclasses import dataclass, field
from html import escape

COLOURS = ("#35124a", "#d1603d", "#2a7f9e", "#e0a13a", "#6d1c55", "#5b8c3e", "#a8324a", "#7a86b8", "#b58463", "#8a8a8a")
WIDTH, LEFT, RIGHT, TOP, BOTTOM = 660, 64, 16, 14, 44
AXIS = "#555555"


@dataclass
class Lines:
    """A chart of lines through points with their ranges. Both axes are logarithmic if `logarithmic`."""

    caption: str
    x_name: str
    y_name: str
    series: list  # (name, [(x, y, least, most), ...])
    ideal: list = field(default_factory=list)  # [(x, y), ...], dashed
    ideal_name: str = "ideal"
    logarithmic: bool = True
    ticks: list = None  # of x


@dataclass
class Bars:
    """A chart of horizontal bars that are stacked of parts."""

    caption: str
    unit: str
    parts: list  # names
    bars: list  # (name, [value of each part])


def draw(chart):
    return draw_bars(chart) if isinstance(chart, Bars) else draw_lines(chart)


def text(x, y, words, anchor="middle", extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{extra}>{escape(words)}</text>'


def line(x1, y1, x2, y2, colour, width=1.0, extra=""):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" stroke-width="{width}"{extra}/>'


def picture(height, caption, parts):
    return (f'<svg viewBox="0 0 {WIDTH} {height:.0f}" role="img" aria-label="{escape(caption)}" '
            f'xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>')


def short(value):
    """A tick's number: 20k, 1.5M."""
    for size, letter in ((1e9, "G"), (1e6, "M"), (1e4, "k")):
        if abs(value) >= size:
            return f"{value / (1e3 if letter == 'k' else size):g}{letter}"
    return f"{value:g}"


def round_ticks(low, high, count=5):
    """Round numbers from `low` to `high`."""
    if high <= low:
        return [low]
    step = 10**math.floor(math.log10((high - low) / count))
    step *= next(factor for factor in (1, 2, 5, 10) if (high - low) / (step * factor) <= count)
    return [step * i for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def log_ticks(low, high):
    """1, 2, 5, 10, ... from `low` to `high`; powers of 10 alone if there are many."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    factors = (1, 2, 5) if high / low < 300 else (1,)
    return [f * 10.0**d for d in decades for f in factors if low * 0.999 <= f * 10.0**d <= high * 1.001]


class Axis:
    """Maps numbers to positions. The range holds all `values` with some room."""

    def __init__(self, values, begin, end, logarithmic, ticks=None):
        self.logarithmic = logarithmic
        low, high = min(values), max(values)
        if logarithmic:
            room = max((high / low)**0.06, 1.1)
            low, high = low / room, high * room
        else:
            low, high = 0.0, high * 1.06 or 1.0
        self.low, self.high, self.begin, self.end = low, high, begin, end
        self.ticks = ticks or (log_ticks(low, high) if logarithmic else round_ticks(low, high))

    def __call__(self, value):
        at = (math.log(value / self.low) / math.log(self.high / self.low) if self.logarithmic
              else (value - self.low) / (self.high - self.low))
        return self.begin + at * (self.end - self.begin)


def frame(x, y, x_name, y_name, bottom):
    """Grid, ticks and names of both axes."""
    parts = []
    for tick in y.ticks:
        parts += [line(LEFT, y(tick), WIDTH - RIGHT, y(tick), "#e4e4e4"), text(LEFT - 6, y(tick) + 4, short(tick), "end")]
    for tick in x.ticks:
        parts += [line(x(tick), TOP, x(tick), bottom, "#e4e4e4"), text(x(tick), bottom + 16, short(tick))]
    parts += [line(LEFT, bottom, WIDTH - RIGHT, bottom, AXIS), line(LEFT, TOP, LEFT, bottom, AXIS),
              text((LEFT + WIDTH - RIGHT) / 2, bottom + 34, x_name)]
    middle = (TOP + bottom) / 2
    return parts + [text(14, middle, y_name, extra=f' transform="rotate(-90 14 {middle:.1f})"')]


def legend(entries, top):
    """(parts, height) of names with colours, in rows below each other; a dashed line for the colour "ideal"."""
    parts, x, y = [], LEFT, top + 12
    for name, colour in entries:
        width = 26 + 6.6 * len(name)
        if x > LEFT and x + width > WIDTH:
            x, y = LEFT, y + 18
        if colour == "ideal":
            parts.append(line(x, y - 4, x + 14, y - 4, "#8a8a8a", 1.5, ' stroke-dasharray="4 3"'))
        else:
            parts.append(f'<rect x="{x:.1f}" y="{y - 10:.1f}" width="12" height="12" fill="{colour}"/>')
        parts.append(text(x + 18, y, name, "start"))
        x += width + 8
    return parts, y + 8 - top


def draw_lines(chart):
    bottom = TOP + 270
    points = [point for _, series in chart.series for point in series]
    x = Axis([point[0] for point in points] + [at for at, _ in chart.ideal], LEFT, WIDTH - RIGHT, chart.logarithmic, chart.ticks)
    y = Axis([value for point in points for value in point[1:]] + [value for _, value in chart.ideal], bottom, TOP, chart.logarithmic)
    parts = frame(x, y, chart.x_name, chart.y_name, bottom)
    if chart.ideal:
        path = " ".join(f"{x(at):.1f},{y(value):.1f}" for at, value in chart.ideal)
        parts.append(f'<polyline points="{path}" fill="none" stroke="#8a8a8a" stroke-width="1.5" stroke-dasharray="5 4"/>')
    for i, (name, series) in enumerate(chart.series):
        colour = COLOURS[i % len(COLOURS)]
        path = " ".join(f"{x(at):.1f},{y(value):.1f}" for at, value, _, _ in series)
        parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for at, value, least, most in series:
            if most > least:
                parts += [line(x(at), y(least), x(at), y(most), colour, 1.2)]
                parts += [line(x(at) - 4, y(end), x(at) + 4, y(end), colour, 1.2) for end in (least, most)]
            tip = f"{name}: {chart.x_name} {at:,g}, {chart.y_name} {value:.4g}" + (f" ({least:.4g} to {most:.4g})" if most > least else "")
            parts.append(f'<circle cx="{x(at):.1f}" cy="{y(value):.1f}" r="3.6" fill="{colour}"><title>{escape(tip)}</title></circle>')
    entries = [(name, COLOURS[i % len(COLOURS)]) for i, (name, _) in enumerate(chart.series)]
    below, height = legend(entries + ([(chart.ideal_name, "ideal")] if chart.ideal else []), bottom + BOTTOM)
    return picture(bottom + BOTTOM + height, chart.caption, parts + below)


def draw_bars(chart):
    left = min(300, max(LEFT, 14 + max(6.6 * len(name) for name, _ in chart.bars)))
    bottom = TOP + 30 * len(chart.bars)
    x = Axis([sum(values) for _, values in chart.bars], left, WIDTH - RIGHT, False)
    parts = []
    for tick in x.ticks:
        parts += [line(x(tick), TOP, x(tick), bottom, "#e4e4e4"), text(x(tick), bottom + 16, short(tick))]
    for row, (name, values) in enumerate(chart.bars):
        top, sum_before = TOP + 30 * row + 4, 0.0
        room = int((left - 14) / 6.6)
        parts.append(text(left - 8, top + 15, name if len(name) <= room else name[:room - 1] + "…", "end"))
        for i, (part, value) in enumerate(zip(chart.parts, values)):
            begin, end = x(sum_before), x(sum_before + value)
            sum_before += value
            parts.append(f'<rect x="{begin:.1f}" y="{top}" width="{max(0, end - begin):.1f}" height="22" fill="{COLOURS[i % len(COLOURS)]}">'
                         f"<title>{escape(f'{name}: {part} {value:.4g} {chart.unit}')}</title></rect>")
    parts += [line(left, TOP, left, bottom, AXIS), text((left + WIDTH - RIGHT) / 2, bottom + 34, chart.unit)]
    below, height = legend([(name, COLOURS[i % len(COLOURS)]) for i, name in enumerate(chart.parts)], bottom + BOTTOM)
    return picture(bottom + BOTTOM + height, chart.caption, parts + below)
