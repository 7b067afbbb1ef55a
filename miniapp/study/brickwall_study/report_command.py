"""`brickwall report`: compares finished runs."""
import argparse
import shutil
import sys

from . import page
from .comparison import compare_runs
from .errors import PASSED, run_main, write_text
from .run_report import find_runs, read_run

DESCRIPTION = """Compares finished runs of `brickwall run` and `brickwall search`: times of phases, speed-up, efficiency, imbalance, counts, energy
error. Runs of the same deck, settings, program, machine, ranks and threads are repetitions; the first run is the one that others are
compared with."""
EXIT_CODES = "Exit code: 0 success, 2 a report is missing or faulty, 4 the page cannot be written."


def main(words=None):
    parser = argparse.ArgumentParser(prog="brickwall report", description=DESCRIPTION, epilog=EXIT_CODES)
    parser.add_argument("places", nargs="+", metavar="RUN", help="report.json or search.json, the folder of a run, or a folder of runs")
    parser.add_argument("--markdown", action="store_true", help="print Markdown")
    parser.add_argument("--html", metavar="FILE", help="also write one page with plots, which needs no other file")
    arguments = parser.parse_args(words)
    return run_main("brickwall report", lambda: report(arguments))


def report(arguments):
    paths = dict.fromkeys(path.resolve() for place in arguments.places for path in find_runs(place))
    document = compare_runs([read_run(path) for path in paths])
    if arguments.html:
        write_text(arguments.html, page.html(document))
    width = shutil.get_terminal_size((120, 24)).columns
    sys.stdout.write(page.markdown(document) if arguments.markdown else page.plain(document, width))
    sys.stdout.flush()
    if arguments.html:
        print(f"wrote    {arguments.html}", file=sys.stderr)
    return PASSED
