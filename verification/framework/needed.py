"""Modules that Python itself does not bring."""
import importlib
import sys


def need(*modules):
    """Ends the program with exit code 77, which ctest tells as skipped, where one is missing."""
    try:
        for module in modules:
            importlib.import_module(module)
    except ImportError as missing:
        print(f"skipped: {sys.executable} lacks a module: {missing}")
        sys.exit(77)
