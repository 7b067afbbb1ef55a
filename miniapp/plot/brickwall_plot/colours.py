"""Colour maps whose colours change evenly: equal steps of the field are equal distances in CIELAB."""
import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap, to_rgb

from .errors import PlotError

# From sand to burnt brick to plum; from sand to teal to night for the negative half.
BRICK = ("#f1e6d3", "#f3c48a", "#ea9152", "#d1603d", "#a8324a", "#6d1c55", "#35124a")
NIGHT = ("#f1e6d3", "#b7d3c4", "#6fb0b4", "#3a86a0", "#2a5a86", "#2b3166", "#201040")
SHADES = 512
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])  # sRGB, D65


def cielab(rgb):
    """L*, a*, b* of sRGB colours [colour][3] between 0 and 1."""
    rgb = np.asarray(rgb, dtype=float)
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = linear @ TO_XYZ.T / TO_XYZ.sum(axis=1)
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)


def even_steps(anchors, count):
    """`count` sRGB colours on the line through the anchors, at equal distances in CIELAB."""
    anchors = np.array([to_rgb(colour) for colour in anchors])
    places = np.linspace(0, len(anchors) - 1, 4096)
    line = np.stack([np.interp(places, np.arange(len(anchors)), anchors[:, i]) for i in range(3)], axis=1)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(cielab(line), axis=0), axis=1))])
    wanted = np.linspace(0, length[-1], count)
    return np.stack([np.interp(wanted, length, line[:, i]) for i in range(3)], axis=1)


def colour_map(name, low, high):
    """The colour map of a name of matplotlib for fields from low to high, or, for None, sand to plum; with both signs, the
    part of night to sand to plum in which zero is sand."""
    if name is None:
        if not low < 0 < high:
            return ListedColormap(even_steps(BRICK, SHADES), "brick")
        both = np.concatenate([even_steps(NIGHT, 2 * SHADES)[:0:-1], even_steps(BRICK, 2 * SHADES)])
        ends = np.array([low, high]) / max(-low, high)  # -1: night, 1: plum
        places = np.linspace(*(1 + ends) * (len(both) - 1) / 2, SHADES)
        return ListedColormap(both[np.rint(places).astype(int)], "night and brick")
    if name not in matplotlib.colormaps:
        raise PlotError(f"there is no colour map {name}; perceptually uniform ones are viridis, cividis, magma, inferno, plasma")
    return matplotlib.colormaps[name].resampled(SHADES)
