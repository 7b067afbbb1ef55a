"""Modules beyond the standard library of Python."""
import importlib
import sys


def need(*modules):
    """Ends the program with exit code 77, which ctest reports as skipped, if a module is
    missing."""
    try:
        for module in modules:
            importlib.import_module(module)
    except ImportError as missing:
        print(f"skipped: {sys.executable} lacks a module: {missing}")
        sys.exit(77)
