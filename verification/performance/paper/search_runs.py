"""Runs of `brickwall search`: one case of a study, its folder and its result.

A run leaves search.json (the program's report), log.txt and run.json in a folder of its own.
run.json names the program and the options, so that a later call of the study reuses the finished
runs that have not changed.
"""
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from brickwall_study.run_store import digest, finished, perform

INPUTS = Path(__file__).resolve().parents[3] / "inputs"
# The walls W(n) of the paper's sizes have their own decks; any other wall is one of these with
# other elements.
DECKS = {2: "wall_17k", 8: "wall_278k", 16: "wall_1113k", 32: "wall_4454k", 42: "wall_7673k", 64: "wall_17818k"}
WARMUP = 2  # searches that are not counted; the same for all runs, so that all end on the same surface


def faces_of(n):
    return 4350 * n * n


@dataclass(frozen=True)
class Case:
    """One run: the wall W(n), the method, the layout and the kind of timing."""

    n: int
    method: str
    ranks: int
    threads: int
    timing: str = "normal"  # or "paper": ranks meet before each phase
    shuffled: bool = False  # nodes and faces in random order, for the first search
    local: bool = True  # with the local search
    repetitions: int = 5

    def name(self):
        extras = ("_shuffled" if self.shuffled else "") + ("" if self.local else "_global")
        return f"W{self.n}_{self.method}_n{self.ranks}_t{self.threads}_{self.timing}{extras}"

    def options(self):
        """The options of run.sh, except those for program and folder."""
        settings = [f"search.method={self.method}", f"search.repetitions={self.repetitions}", f"search.warmup={WARMUP}"]
        if self.n not in DECKS:
            settings += [f"wall.elements=[{2 * self.n},{self.n},{self.n}]",
                         f"title=Wall W({self.n}), {faces_of(self.n):,} faces"]
        if self.shuffled:
            settings.append("search.shuffle=true")
        if not self.local:
            settings.append("search.local=false")
        deck = INPUTS / (DECKS.get(self.n, "wall_17k") + ".toml")
        words = ["search", str(deck), "-n", str(self.ranks), "-t", str(self.threads), "--timing", self.timing]
        for setting in settings:
            words += ["--set", setting]
        return words


@dataclass
class Result:
    """The result of a case."""

    case: Case
    state: str  # "ok", "failed", "out of time"
    message: str = ""
    report: dict = None  # search.json, of state "ok"
    seconds: float = 0.0  # of the whole run, set-up included
    reused: bool = False  # from an earlier call of the study


class Runner:
    """Runs cases through run.sh, one at a time, and never raises for a run that fails."""

    def __init__(self, run_sh, program, folder, limit):
        self.run_sh, self.program, self.folder, self.limit = str(run_sh), str(program), Path(folder), limit
        self.fingerprint = digest(program)

    def knows_method(self, method):
        """(True, "") or (False, the last line that the program prints)."""
        done = subprocess.run(
            [self.run_sh, "check", str(INPUTS / "wall_17k.toml"), "-t", "1", "--set", f"search.method={method}",
             "--program", self.program], capture_output=True, text=True)
        text = (done.stderr + done.stdout).strip()
        return done.returncode == 0, text.splitlines()[-1] if text else f"exit code {done.returncode}"

    def run(self, case):
        place = self.folder / case.name()
        key = {"program": self.fingerprint, "options": case.options()}
        record = finished(place, key)
        reused = record is not None
        if not reused:
            command = [self.run_sh, *case.options(), "--program", self.program, "-o", str(place)]
            record = perform(place, key, command, self.limit)
        state, message, report = record["state"], record["message"], None
        if state == "ok":
            try:
                report = json.loads((place / "search.json").read_text())
            except (OSError, ValueError) as error:
                state, message = "failed", f"no search.json: {error}"
        return Result(case, state, message, report, record["wall_seconds"], reused)
