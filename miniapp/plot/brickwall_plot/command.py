"""The program: reads the command line, draws, and turns faulty input into one message."""
import sys

import numpy as np
from PIL import Image

from .animation import write_gif, write_mp4
from .errors import PlotError
from .exodus import ExodusResults
from .figure import Pictures
from .history_plot import draw_history, draw_phases
from .options import parse
from .run_folder import RunFiles
from .scene import Scene
from .style import save

SAMPLES, SAMPLES_OF_ANIMATIONS = 3, 2  # along a side of a pixel


def main(arguments):
    """Returns the exit code."""
    try:
        run(parse(arguments))
    except PlotError as error:
        print(f"brickwall-plot: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        return 2
    return 0


def run(options):
    files = RunFiles(options.run)
    if options.history or options.phases:
        figure = draw_history(files.history(), files.title(), files.units(options.units)) if options.history else phases(files)
        path = options.output or files.folder / ("history.png" if options.history else "phases.png")
        writing(path, lambda: save(figure, path))
    else:
        results = ExodusResults(files.exodus())
        if options.list:
            print_fields(results)
            return
        path = options.output or files.base.with_name(files.base.name + ".png")
        draw(results, options, path, files.units(options.units))
    print(path)


def phases(files):
    report = files.report()
    try:
        return draw_phases(report)
    except KeyError as error:
        raise PlotError(f"{files.folder / 'report.json'}: lacks {error}") from None
    except (TypeError, AttributeError, ValueError) as error:
        raise PlotError(f"{files.folder / 'report.json'}: a field is of another kind: {error}") from None


def draw(results, options, path, units):
    scene = Scene(results, options.field, options.scale, cut_plane(options), options.arrows)
    steps = chosen_steps(results, options)
    pictures = Pictures(scene, steps, options, SAMPLES_OF_ANIMATIONS if options.animates else SAMPLES, units)
    frames = (pixels(pictures.draw(step)) for step in steps)
    if options.animates:
        write = write_mp4 if path.suffix.lower() == ".mp4" else write_gif
        writing(path, lambda: write(path, frames, options.fps))
    else:
        frame = next(frames)
        writing(path, lambda: Image.fromarray(frame).save(path))


def pixels(figure):
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[:, :, :3].copy()


def writing(path, write):
    try:
        write()
    except OSError as error:
        raise PlotError(f"{path}: cannot be written: {error.strerror or error}") from None


def chosen_steps(results, options):
    if not len(results.times):
        if options.animates or options.step is not None or options.time is not None:
            raise PlotError(f"{results.paths[0]}: the file has a mesh and no steps")
        return [None]
    if options.animates:
        first, last, stride = (0, -1, 1) if options.steps == slice(None) else options.steps
        steps = list(range(results.step(first), results.step(last) + 1, stride))
        if not steps:
            raise PlotError(f"--steps: the last step is before the first; those of the file are 0 to {len(results.times) - 1}")
        return steps
    if options.time is not None:
        low, high = results.times[[0, -1]]
        slack = 1e-9 * max(abs(low), abs(high))
        if not low - slack <= options.time <= high + slack:
            raise PlotError(f"{results.paths[0]}: there is no step at time {options.time:g}; times are {low:g} to {high:g}")
        return [int(np.argmin(abs(results.times - options.time)))]
    return [results.step(-1 if options.step is None else options.step)]


def cut_plane(options):
    """(point, normal) with the normal towards the removed half."""
    if options.cut is None or not isinstance(options.cut[0], int):
        return options.cut
    axis, value = options.cut
    azimuth, elevation = np.radians(options.view)
    eye = (np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation))[axis]
    if abs(eye) < 1e-6:
        raise PlotError(f"--cut: this view is along the plane {'xyz'[axis]}={value:g}; turn it, or give PX,PY,PZ:NX,NY,NZ")
    unit = np.zeros(3)
    unit[axis] = 1.0
    return unit * value, unit * np.sign(eye)


def print_fields(results):
    count = f"{len(results.files)} files of ranks" if len(results.files) > 1 else "1 file"
    print(f"{results.paths[0]} ({count}): {len(results.nodes)} nodes, {len(results.hexes)} elements in blocks "
          + ", ".join(name or str(i + 1) for i, name in enumerate(results.block_names)))
    if len(results.times):
        print(f"steps: 0 to {len(results.times) - 1}, times {results.times[0]:g} to {results.times[-1]:g}")
    vectors = [name[:-2] for name in results.names["nod"] if name.endswith("_x") and results.is_vector(name[:-2])]
    for kind, names in (("nodal vectors (also with _x, _y, _z)", vectors),
                        ("nodal fields", [name for name in results.names["nod"] if name[:-2] not in vectors]),
                        ("element fields", results.names["elem"])):
        print(f"{kind}: {', '.join(names) or 'none'}")
