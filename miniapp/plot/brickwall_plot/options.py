"""The command line."""
import argparse
from pathlib import Path

import numpy as np

from .camera import VIEWS
from .errors import PlotError
from .units import SYSTEMS

EPILOG = """examples:
  brickwall-plot out/brick_wall --list                        steps and fields
  brickwall-plot out/brick_wall                               the last step, coloured by the displacement
  brickwall-plot out/brick_wall --field stress_yy --time 2e-3 --view back
  brickwall-plot out/brick_wall --cut x=0.8 --arrows --field energy_density -o cut.png
  brickwall-plot out/brick_wall -o wall.mp4                   all steps; also .gif
  brickwall-plot out/brick_wall -o slow.gif --steps 0:-1:2 --fps 5 --size 900x675
  brickwall-plot out/brick_wall --history                     energies, errors, momenta, contacts
  brickwall-plot out/brick_wall --phases                      times of the stages of a step
  brickwall-plot results.exo.4.0                              the files of all four ranks, joined or not

Units are those of the deck (its key units). Exit codes: 0 success, 2 faulty input or command line."""
ANIMATIONS, PICTURES, PLOTS = (".mp4", ".gif"), (".png",), (".png", ".pdf", ".svg")


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise PlotError(f"{message} (brickwall-plot --help)")


def parse(arguments):
    parser = Parser(prog="brickwall-plot", description="Pictures, animations and plots of Brickwall's results.", epilog=EPILOG,
                    formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN", help="folder of a run, or an Exodus file: joined, or one of the files of ranks")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE",
                        help="file to write; its suffix chooses picture (png) or animation (mp4, gif); --history and --phases also "
                        "write pdf and svg (default: beside the results, png)")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--list", action="store_true", help="print the steps and fields of the file")
    what.add_argument("--history", action="store_true", help="plot history.csv: energies, errors, momenta, contacts")
    what.add_argument("--phases", action="store_true", help="plot the times in report.json as bars")
    content = parser.add_argument_group("what to draw")
    content.add_argument("--field", metavar="NAME", help="colour: a nodal vector (its magnitude), a component, a nodal or an element "
                         "field (default displacement)")
    content.add_argument("--step", type=int, help="output step, 0 is the first, -1 the last (default)")
    content.add_argument("--time", type=finite, metavar="T", help="the output step nearest to this time")
    content.add_argument("--steps", type=step_range, default=slice(None), metavar="FIRST:LAST[:STRIDE]",
                         help="steps of an animation, LAST included (default all)")
    content.add_argument("--scale", type=finite, default=1.0, metavar="S", help="factor on the displacements (default 1)")
    content.add_argument("--cut", type=plane, metavar="PLANE", help="remove material: x=0.8 (or y, z) the half that is nearer to the "
                         "eye, px,py,pz:nx,ny,nz the half towards which the normal n at p points; in undeformed coordinates")
    content.add_argument("--arrows", nargs="?", const="force_contact", metavar="VECTOR", help="draw a nodal vector as arrows; forces "
                         "are summed over each side of a brick (default force_contact)")
    view = parser.add_argument_group("how to draw it")
    view.add_argument("--view", type=view_angles, default=(62.0, 18.0), metavar="AZIMUTH,ELEVATION", help="position of the eye in "
                      f"degrees: from x towards y, and from the ground; or {', '.join(VIEWS)} (default 62,18)")
    view.add_argument("--parallel", action="store_true", help="parallel projection instead of perspective")
    view.add_argument("--range", type=pair, metavar="LOW,HIGH", help="limits of the colours (default: those of all steps drawn)")
    view.add_argument("--colours", metavar="NAME", help="colour map of matplotlib, such as viridis (default: sand to plum; with both "
                      "signs night to sand to plum)")
    view.add_argument("--units", choices=SYSTEMS, help="units of the labels (default: those in report.json, or m-kg-s)")
    view.add_argument("--label", help="label of the colours, without change of the unit")
    view.add_argument("--title", help="default: the title in the file")
    view.add_argument("--outline", type=finite, default=1.2, metavar="WIDTH", help="of the outlines of bricks; 0 for none "
                      "(default %(default)s)")
    view.add_argument("--mesh", action="store_true", help="draw the edges of elements")
    view.add_argument("--plain", action="store_true", help="no light and no shadow: exactly the colours of the bar")
    view.add_argument("--bare", action="store_true", help="no title, bar and axes")
    view.add_argument("--size", type=size, default=(1500, 1125), metavar="WxH", help="pixels (default 1500x1125)")
    view.add_argument("--fps", type=finite, default=10.0, help="frames per second of an animation (default 10)")
    if any(word in ("-h", "--help") for word in arguments):
        parser.print_help()
        parser.exit()
    # argparse takes "-62,18" for an option.
    joined = list(arguments)
    for i, word in enumerate(arguments[:-1]):
        if word in ("--view", "--range", "--cut", "--steps") and arguments[i + 1][:1] == "-" and arguments[i + 1][1:2].isdigit():
            joined[i:i + 2] = [f"{word}={arguments[i + 1]}", None]
    options = parser.parse_args([word for word in joined if word is not None])
    check(options)
    return options


def check(options):
    suffix = options.output.suffix.lower() if options.output else ".png"
    allowed = PLOTS if options.history or options.phases else PICTURES + ANIMATIONS
    if suffix not in allowed:
        raise PlotError(f"{options.output}: the suffix must be one of {', '.join(allowed)}")
    if options.step is not None and options.time is not None:
        raise PlotError("--step and --time exclude each other")
    options.animates = suffix in ANIMATIONS
    if options.animates and (options.step is not None or options.time is not None):
        raise PlotError("an animation takes --steps FIRST:LAST[:STRIDE], not --step or --time")
    if not options.animates and options.steps != slice(None):
        raise PlotError("--steps needs an animation: -o FILE.mp4 or FILE.gif")
    if suffix == ".mp4":  # H.264 needs even numbers
        options.size = tuple(number + number % 2 for number in options.size)
    if not options.fps > 0:
        raise PlotError("--fps must be positive")
    if options.range and not options.range[0] < options.range[1]:
        raise PlotError("--range needs LOW,HIGH with LOW < HIGH")


def numbers(text, count, form):
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or not np.isfinite(values).all():
        raise argparse.ArgumentTypeError(f'"{text}" is not {form}')
    return values


def finite(text):
    return numbers(text, 1, "a finite number")[0]


def pair(text):
    return numbers(text, 2, "LOW,HIGH")


def view_angles(text):
    return VIEWS[text] if text in VIEWS else numbers(text, 2, f"AZIMUTH,ELEVATION nor one of {', '.join(VIEWS)}")


def size(text):
    try:
        width, height = (int(part) for part in text.split("x"))
    except ValueError:
        width = height = 0
    if not (100 <= width <= 10000 and 100 <= height <= 10000):
        raise argparse.ArgumentTypeError(f'"{text}" is not WxH with 100 to 10000 pixels')
    return width, height


def step_range(text):
    try:
        first, last, *stride = (int(part) for part in text.split(":"))
        if len(stride) > 1 or (stride and stride[0] < 1):
            raise ValueError
    except ValueError:
        raise argparse.ArgumentTypeError(f'"{text}" is not FIRST:LAST or FIRST:LAST:STRIDE') from None
    return first, last, stride[0] if stride else 1


def plane(text):
    """An axis (0, 1, 2) and a value, or (point, normal)."""
    form = "x=VALUE, y=VALUE, z=VALUE or PX,PY,PZ:NX,NY,NZ"
    if text[:2] in ("x=", "y=", "z="):
        return "xyz".index(text[0]), numbers(text[2:], 1, form)[0]
    point, _, normal = text.partition(":")
    point, normal = np.array(numbers(point, 3, form)), np.array(numbers(normal, 3, form))
    if not normal.any():
        raise argparse.ArgumentTypeError(f'"{text}": the normal is zero')
    return point, normal / np.linalg.norm(normal)
