"""Timed and evaluated runs. A call in the same folder reuses finished runs of the same program,
deck, settings and evaluation."""
import hashlib
import inspect
import json
import os
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import bricks
import numpy as np
from brickwall_study.run_store import digest
from framework.program import ProgramError

# The keys that the study changes, one or several at a time. Each run sets all of them, so that a
# deck's own value does not replace the program's default.
KEYS = ("time.safety", "contact.penalty", "contact.scheme", "contact.edges", "element.formulation", "element.mass",
        "search.reuse.margin")
PHYSICS = 3  # exit code of a run that failed physically or exceeded a limit, which is a result
# CPU time of the time loop: a Kokkos Tools library of the build, and the file that it writes.
PROBE = "verification/performance/libbrickwall_step_probe.so"
FIELDS = ("displacement", "velocity", "force_contact", "contact_status", "contact_gap")


@dataclass(frozen=True)
class Setting:
    """Changes of the program's defaults; plots draw each group in one colour."""

    changes: tuple = ()  # ((key, value), ...)
    group: str = "default"

    @property
    def name(self):
        return ", ".join(f"{key.split('.')[-1]} {str(value).lower()}" for key, value in self.changes) or "default"


@dataclass
class Point:
    """One setting on one mesh, with its cost and its errors."""

    setting: Setting
    mesh: str
    record: dict
    errors: dict = None

    @property
    def failure(self):
        """The reason why there is no error: a physical failure or a failed run."""
        return self.record["broken"] or self.record["failure"]

    @cached_property
    def seconds(self):
        return min(self.record["seconds"])

    @property
    def element_steps(self):
        return self.record["element_steps"]

    @property
    def error(self):
        return self.errors["error"]


class Bench:
    """Runs points of scenes through run.sh, one at a time."""

    def __init__(self, program, folder, repetitions, cpu_time=False):
        self.program, self.folder, self.repetitions = program, Path(folder), repetitions
        self.probe = Path(program.binary).parent.parent / PROBE if cpu_time else None
        self.fingerprint = digest(program.binary)
        self.defaults = program_defaults(program.binary)
        self.versions = {}
        self.failures = []

    def point(self, scene, mesh, setting, **how):
        changes = dict(setting.changes)
        label = "_".join([mesh, *(f"{key.split('.')[-1]}_{str(value).lower()}" for key, value in changes.items())])
        record = self.record(scene, mesh, label, changes, **how)
        return Point(setting, mesh, record)

    def needed(self, *arguments, **how):
        """A record that the study cannot do without: raises ProgramError if the run fails."""
        record = self.record(*arguments, **how)
        if record["failure"] or record["broken"]:
            raise ProgramError(f"{arguments[0].name}, {arguments[2]}: {record['failure'] or record['broke']}")
        return record

    def record(self, scene, mesh, label, changes, repetitions=None, threads=None, observe=None):
        """The result of `observe` (by default that of the scene) for a run, its cost, and the
        digest of its history."""
        observe = observe or scene.observe
        settings = {**self.defaults, **scene.settings(mesh), **changes}
        repetitions, threads = repetitions or self.repetitions, threads or self.program.threads
        key = {"program": self.fingerprint, "deck": scene.deck.read_text(), "settings": settings, "threads": threads, "cpu_time": self.probe is not None,
               "evaluation": inspect.getsource(observe) + inspect.getsource(bricks)}
        folder = self.folder / scene.name.replace(" ", "_") / label
        record = finished(folder, key)
        if record is None or len(record["seconds"]) < repetitions and not record["broken"]:
            record = self._measure(scene, mesh, folder, settings, repetitions, threads, observe)
            (folder / "record.json").write_text(json.dumps({"key": key, **record}, indent=1) + "\n")
        self.versions = self.versions or record["versions"]
        if record["failure"]:
            self.failures.append(f"{scene.name}, {label}: {record['failure']}")
        cost = record["failure"] or record["broken"] or f"{min(record['seconds']):9.3f} s"
        print(f"{scene.name:14} {label:50} {cost}", flush=True)
        return record

    def _measure(self, scene, mesh, folder, settings, repetitions, threads, observe):
        record = {"failure": "", "broken": "", "seconds": [], "element_steps": 0, "observed": {}, "course": "", "phases": {}, "versions": {}}
        results = folder / "run" / f"{scene.deck.stem}.exo"
        for repetition in range(repetitions):
            if repetition == 1:  # further runs are only timed
                settings = {**settings, "output.interval": 0.0}
            if self.probe:
                os.environ.update(KOKKOS_PROFILE_LIBRARY=str(self.probe), KOKKOS_TOOLS_LIBS=str(self.probe),
                                  BRICKWALL_STEP_PROBE=str(folder / "probe.json"), BRICKWALL_STEP_PROBE_ONLY="1")
            run = self.program.run(scene.deck, folder / "run", settings, mesh=scene.geometry(mesh), threads=threads, expect=None)
            if run.code not in (0, PHYSICS):
                record["failure"] = run.message
                break
            report = run.report
            record["broken"] = "; ".join(report["failures"])
            if record["broken"]:
                break
            record["seconds"].append(json.loads((folder / "probe.json").read_text()).get("miniapp::step", 0) if self.probe
                                     else report["loop_seconds"])
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
    """A digest of all bits of the history and of the fields at all output times, without the number
    of searches, which depends on kept lists."""
    digest = hashlib.sha256()
    for name, column in run.history.items():
        if name != "searches":
            digest.update(name.encode() + column.tobytes())
    for step in range(len(run.results.times)):
        for name in FIELDS:
            digest.update(np.ascontiguousarray(run.results.nodal(name, step)).tobytes())
    return digest.hexdigest()


def program_defaults(binary):
    """{key: value} of KEYS, from the output of `brickwall --keys`."""
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
        raise RuntimeError(f"brickwall --keys prints no default of {missing[0]}")
    return defaults


def json_value(text):
    try:
        return json.loads(text)
    except ValueError:
        return text
