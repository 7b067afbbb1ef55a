"""The command line common to all studies."""
import argparse
from pathlib import Path

from brickwall_study.options import positive


def study_parser(name, doc):
    """A parser for the options of `./run.sh --study NAME`. It has the two options that run.sh
    passes to every study: `run_sh`, the script that starts runs, and `program`, the binary."""
    parser = argparse.ArgumentParser(prog=f"./run.sh --study {name}", description=doc.splitlines()[0])
    parser.add_argument("--run-sh", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--program", required=True, help=argparse.SUPPRESS)
    return parser


def add_run_options(parser, name, quick, keep, counts=True):
    """Adds --quick and --keep with these help texts, the folder -o, and, if `counts`, the ranks -n
    and threads -t of each run."""
    parser.add_argument("--quick", action="store_true", help=quick)
    if counts:
        parser.add_argument("-n", "--ranks", type=positive, default=1, help="MPI ranks of each run (default %(default)s)")
        parser.add_argument("-t", "--threads", type=positive, default=1, help="threads of each rank (default %(default)s)")
    parser.add_argument("-o", "--output", type=lambda path: Path(path).absolute(), default=Path(f"out/study_{name}").absolute(),
                        help=f"output folder (default out/study_{name})")
    parser.add_argument("--keep", action="store_true", help=keep)
