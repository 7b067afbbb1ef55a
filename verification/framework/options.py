"""The command line that all studies share."""
import argparse


def study_parser(name, doc):
    """A parser for the options of `./run.sh --study NAME`. What run.sh tells every study is there already: `run_sh`, to make runs
    by, and `program`, the binary that they are of."""
    parser = argparse.ArgumentParser(prog=f"./run.sh --study {name}", description=doc.splitlines()[0])
    parser.add_argument("--run-sh", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--program", required=True, help=argparse.SUPPRESS)
    return parser
