"""Runs of a study, each in a folder of its own. run.json beside a report holds the key of the run: a later call reuses
finished runs whose program, deck, settings and layout have not changed."""
import hashlib
import json
import os
import shutil
import time
from datetime import datetime, timezone
from pathlib import Path

from .errors import write_text
from .process import execute


def digest(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def now():
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def finished(folder, key):
    """run.json of a finished run with this key, or None."""
    try:
        record = json.loads((Path(folder) / "run.json").read_text())
        return record if record["state"] == "ok" and record["key"] == json.loads(json.dumps(key)) else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def perform(folder, key, command, limit, environment=None, about=None):
    """Runs `command` with its output in log.txt of the folder, which is emptied first. Returns the record, which is
    run.json: `about`, the key, state ("ok", "failed", "out of time"), message, exit code, seconds, load average before."""
    folder = Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    record = {**(about or {}), "started": now(), "load_average": round(os.getloadavg()[0], 2)}
    begin = time.monotonic()
    state, message, code = execute(command, folder / "log.txt", limit, environment)
    record.update(state=state, message=message, exit_code=code, wall_seconds=round(time.monotonic() - begin, 3), key=key)
    write_text(folder / "run.json", json.dumps(record, indent=1) + "\n")
    return record
