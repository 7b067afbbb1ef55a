"""The results of a study: study.csv, study.json; README.md beside this folder describes both."""
import csv
import io
import json

from .launch import spell
from .run_report import BUILD

SCHEMA = "brickwall-sweep-1"
COLUMNS = ("order", "case", "name", "command", "deck", "program", "commit", "ranks", "threads", "repetition", "state", "message", "started",
           "wall_seconds", "load_average", "elements", "nodes", "faces", "steps", "setup_seconds", "seconds_per_step", "throughput", "pairs",
           "contacts", "energy_error")


def row_of(done):
    """A flat row of study.csv; what a run does not have is absent."""
    case, record, run = done.case, done.record, done.run
    row = {"order": done.order, "case": case.id, "name": case.name, "command": case.command, "deck": case.deck.name, "program": case.program,
           "ranks": case.ranks, "threads": case.threads, "repetition": done.repetition,
           **{name: record[name] for name in ("state", "message", "started", "wall_seconds", "load_average")},
           **{f"set:{key}": spell(value) for key, value in case.settings.items()}}
    if run:
        row.update(commit=run.build["commit"], **run.sizes, steps=run.steps, setup_seconds=run.setup, seconds_per_step=run.whole,
                   throughput=run.throughput, pairs=run.counts["pairs"], contacts=run.counts.get("contacts"), energy_error=run.energy_error,
                   **{f"phase:{name.lstrip('- ')}": seconds for name, seconds in run.phases.items()})
    return {key: value for key, value in row.items() if value is not None}


def csv_text(runs):
    """One line for each counted run, in the order of the runs."""
    rows = [row_of(done) for done in runs if done.is_counted]
    extra = sorted({key for row in rows for key in row} - set(COLUMNS))
    file = io.StringIO()
    writer = csv.DictWriter(file, [*COLUMNS, *extra], restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return file.getvalue()


def json_text(study, state, seed, machine, digests, runs, times):
    """`state` is "complete", "incomplete" or "interrupted"; `times` the begin and the end of this call."""
    builds = {done.case.program: done.run.build for done in runs if done.run}
    data = {
        "schema": SCHEMA, "title": study.title, "file": str(study.path), "state": state, "seed": seed, "started": times[0], "ended": times[1],
        "machine": {**machine, **next(({"cpu": done.run.cpu, "device": done.run.device} for done in runs if done.run), {})},
        "programs": [{"name": name, "path": str(path), "sha256": digests[name], **{key: builds.get(name, {}).get(key) for key in BUILD}}
                     for name, path in study.programs.items()],
        "repetitions": study.repetitions, "warmup": study.warmup, "left_out": study.left_out,
        "cases": [{"case": case.id, "name": case.name, "command": case.command, "deck": str(case.deck), "program": case.program,
                   "ranks": case.ranks, "threads": case.threads, "settings": case.settings, "options": list(case.options)} for case in study.cases],
        "runs": [json_row(done) for done in runs]}
    return json.dumps(data, indent=1) + "\n"


def json_row(done):
    """As in study.csv, with the phases in one object, and without what the case states."""
    row = row_of(done)
    phases = {key[6:]: value for key, value in row.items() if key.startswith("phase:")}
    of_case = ("name", "command", "deck", "program", "ranks", "threads")
    kept = [key for key in row if not key.startswith(("phase:", "set:")) and key not in of_case]
    return {**{key: row[key] for key in kept}, "counted": done.is_counted, "reused": done.reused, "exit_code": done.record["exit_code"],
            **({"phases": phases} if phases else {})}
