"""The exit codes of `brickwall report` and `brickwall study`, which are those of the program, and the error of bad input."""
import os
import sys
from pathlib import Path

PASSED, INTERNAL, BAD_INPUT, RUNS_FAILED, NO_OUTPUT, INTERRUPTED = range(6)


class InputError(Exception):
    """A faulty report, study file or option; its text is the whole message to the user."""


class OutputError(Exception):
    """A file that cannot be written."""


def run_main(name, main):
    """The exit code of main(); prints one line for an error."""
    try:
        return main()
    except InputError as error:
        print(f"{name}: error: {error}", file=sys.stderr)
        return BAD_INPUT
    except OutputError as error:
        print(f"{name}: error: {error}", file=sys.stderr)
        return NO_OUTPUT
    except BrokenPipeError:  # such as of `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PASSED


def read_parsed(path, parse, fault=""):
    """parse(text of the file). Raises InputError; `fault` precedes the message of the parser."""
    try:
        return parse(path.read_text())
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except ValueError as error:
        raise InputError(f"{path}: {fault}{error}") from None


def write_text(path, text):
    """Writes a file whole or not at all, in an existing folder. Raises OutputError."""
    path = Path(path)
    try:
        beside = path.with_name(path.name + ".part")
        beside.write_text(text)
        beside.replace(path)
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}") from None
