"""Runs of the program through run.sh, as a user starts them: a deck, `--set` overrides, possibly a
mesh."""
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from brickwall_study.launch import spell
from brickwall_study.process import execute

from .exodus import Results, write_mesh


class ProgramError(RuntimeError):
    """A run with an unexpected exit code."""


@dataclass
class Run:
    """The results of a run in its folder."""

    folder: Path
    name: str  # the name of the deck
    code: int  # exit code
    message: str

    @cached_property
    def report(self):
        return json.loads((self.folder / "report.json").read_text())

    @cached_property
    def history(self):
        """Columns of history.csv: {name: array}."""
        table = np.genfromtxt(self.folder / "history.csv", delimiter=",", names=True)
        return {name: np.atleast_1d(table[name]) for name in table.dtype.names}

    def vector(self, name):
        """Columns name_x, name_y, name_z of history.csv as [row][xyz]."""
        return np.stack([self.history[f"{name}_{axis}"] for axis in "xyz"], axis=1)

    @cached_property
    def results(self):
        return Results(self.folder / f"{self.name}.exo")


@dataclass(frozen=True)
class Program:
    """The program with the defaults for all runs of a study."""

    run_sh: Path
    binary: Path
    ranks: int = 1
    threads: int = 1
    limit: float = 1800  # seconds

    def run(self, deck, folder, settings=None, mesh=None, ranks=None, threads=None, expect=0):
        """Runs `deck` with `settings` {key: value} into `folder`. `mesh` is written there and
        replaces mesh.file. Raises ProgramError if the exit code is not `expect` (None: any)."""
        deck, folder = Path(deck), Path(folder).absolute()
        folder.mkdir(parents=True, exist_ok=True)
        settings = dict(settings or {})
        if mesh is not None:
            write_mesh(folder / "mesh.exo", mesh)
            settings["mesh.file"] = str(folder / "mesh.exo")
        command = [str(self.run_sh), "run", str(deck), "--program", str(self.binary), "--no-picture", "-o", str(folder),
                   "-n", str(ranks or self.ranks), "-t", str(threads or self.threads)]
        for key, value in settings.items():
            command += ["--set", f"{key}={spell(value)}"]
        # Unbound, since concurrent runs would all bind to the same first cores.
        _, message, code = execute(command, folder / "log.txt", self.limit, {"OMP_PROC_BIND": "false"})
        if expect is not None and code != expect:
            raise ProgramError(f"{folder.name}: {message or 'the run passed'}, expected exit code {expect} ({folder}/log.txt)")
        return Run(folder, deck.stem, code, message)
