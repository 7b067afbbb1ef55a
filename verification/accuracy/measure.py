"""Runs that are timed and evaluated. A call in the same folder takes over what is finished: the same program, deck, settings
and evaluation."""
import hashlib
import inspect
import json
import statistics
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import bricks
import numpy as np
from framework.program import ProgramError

# What the study changes, one thing at a time or several. Each run is told all of them, so that a deck's own choice does not
# stand for the program's default.
KEYS = ("time.safety", "contact.penalty", "contact.scheme", "contact.edges", "element.formulation", "search.reuse.margin")
PHYSICS = 3  # exit code of a run that broke down or passed a limit: a result, if a bad one
FIELDS = ("displacement", "velocity", "force_contact", "contact_status", "contact_gap")


@dataclass(frozen=True)
class Setting:
    """Changes against the program's defaults, of a group that the plots draw in one colour."""

    changes: tuple = ()  # ((key, value), ...)
    group: str = "default"

    @property
    def name(self):
        return ", ".join(f"{key.split('.')[-1]} {str(value).lower()}" for key, value in self.changes) or "default"


@dataclass
class Point:
    """One setting on one mesh: what it cost and what it gave."""

    setting: Setting
    mesh: str
    record: dict
    errors: dict = None

    @property
    def failure(self):
        """Why there is no error to tell: the physics broke down, or the run failed."""
        return self.record["broke"] or self.record["failure"]

    @cached_property
    def seconds(self):
        return statistics.median(self.record["seconds"])

    @property
    def element_steps(self):
        return self.record["element_steps"]

    @property
    def error(self):
        return self.errors["error"]


class Bench:
    """Runs points of scenes through run.sh, one at a time."""

    def __init__(self, program, folder, repetitions):
        self.program, self.folder, self.repetitions = program, Path(folder), repetitions
        self.fingerprint = hashlib.sha256(Path(program.binary).read_bytes()).hexdigest()
        self.defaults = program_defaults(program.binary)
        self.versions = {}
        self.failures = []

    def point(self, scene, mesh, setting, **how):
        changes = dict(setting.changes)
        label = "_".join([mesh, *(f"{key.split('.')[-1]}_{str(value).lower()}" for key, value in changes.items())])
        record = self.record(scene, mesh, label, changes, **how)
        return Point(setting, mesh, record)

    def needed(self, *what, **how):
        """A record without which the study can not go on."""
        record = self.record(*what, **how)
        if record["failure"] or record["broke"]:
            raise ProgramError(f"{what[0].name}, {what[2]}: {record['failure'] or record['broke']}")
        return record

    def record(self, scene, mesh, label, changes, repetitions=None, threads=None, observe=None):
        """What `observe` (of the scene, if not given) saw in a run, its cost, and the fingerprint of its course."""
        observe = observe or scene.observe
        settings = {**self.defaults, **scene.settings(mesh), **changes}
        repetitions, threads = repetitions or self.repetitions, threads or self.program.threads
        key = {"program": self.fingerprint, "deck": scene.deck.read_text(), "settings": settings, "threads": threads,
               "evaluation": inspect.getsource(observe) + inspect.getsource(bricks)}
        folder = self.folder / scene.name.replace(" ", "_") / label
        record = finished(folder, key)
        if record is None or len(record["seconds"]) < repetitions and not record["broke"]:
            record = self._measure(scene, mesh, folder, settings, repetitions, threads, observe)
            (folder / "record.json").write_text(json.dumps({"key": key, **record}, indent=1) + "\n")
        self.versions = self.versions or record["versions"]
        if record["failure"]:
            self.failures.append(f"{scene.name}, {label}: {record['failure']}")
        cost = record["failure"] or record["broke"] or f"{statistics.median(record['seconds']):9.3f} s"
        print(f"{scene.name:14} {label:50} {cost}", flush=True)
        return record

    def _measure(self, scene, mesh, folder, settings, repetitions, threads, observe):
        record = {"failure": "", "broke": "", "seconds": [], "element_steps": 0, "observed": {}, "course": "", "phases": {}, "versions": {}}
        results = folder / "run" / f"{scene.deck.stem}.exo"
        for repetition in range(repetitions):
            if repetition == 1:  # those that follow are timed only
                settings = {**settings, "output.interval": 0.0}
            run = self.program.run(scene.deck, folder / "run", settings, mesh=scene.geometry(mesh), threads=threads, expect=None)
            if run.code not in (0, PHYSICS):
                record["failure"] = run.message
                break
            report = run.report
            record["broke"] = "; ".join(report["failures"])
            if record["broke"]:
                break
            record["seconds"].append(report["loop_seconds"])
            if repetition == 0:
                record["element_steps"] = report["elements"] * report["steps"]
                record["observed"] = observe(run)
                record["course"] = course(run)
                record["phases"] = {phase["name"]: phase["mean"] for phase in report["phases"]}
                record["searches"] = report["search"]["searches"]
                record["versions"] = {name: report[name] for name in (
                    "version", "commit", "compiler", "kokkos", "mpi", "cpu", "execution_space")}
            run.results.file.close()
            results.unlink(missing_ok=True)  # large
        return record


def finished(folder, key):
    try:
        record = json.loads((folder / "record.json").read_text())
    except (OSError, ValueError):
        return None
    return record if record.pop("key") == json.loads(json.dumps(key)) else None


def course(run):
    """A digest of the whole history and of the fields at all output times, with all their bits; counts of searches, which
    kept lists save, are not in it."""
    digest = hashlib.sha256()
    for name, column in run.history.items():
        if name != "searches":
            digest.update(name.encode() + column.tobytes())
    for step in range(len(run.results.times)):
        for name in FIELDS:
            digest.update(np.ascontiguousarray(run.results.nodal(name, step)).tobytes())
    return digest.hexdigest()


def program_defaults(binary):
    """{key: value} of KEYS, as `brickwall --keys` tells them."""
    text = subprocess.run([str(binary), "--keys"], capture_output=True, text=True, check=True).stdout
    defaults, block = {}, ""
    for line in text.splitlines():
        words = line.split()
        if line.startswith("["):
            block = words[0].strip("[]")
        elif words and f"{block}.{words[0]}" in KEYS:
            defaults[f"{block}.{words[0]}"] = json_value(line.rsplit("; default ", 1)[1])
    missing = [key for key in KEYS if key not in defaults]
    if missing:
        raise RuntimeError(f"the program tells no default of {missing[0]}")
    return defaults


def json_value(text):
    try:
        return json.loads(text)
    except ValueError:
        return text
