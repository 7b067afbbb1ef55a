"""A child process with its output in a log and a time limit; none of its processes survives the
call."""
import os
import signal
import subprocess
from pathlib import Path

PATIENCE = 10  # seconds between the signals that end a process


def execute(command, log, limit, environment=None):
    """Runs `command` with additional variables in its `environment`. Returns ("ok" | "failed" |
    "out of time", message, exit code or None)."""
    with open(log, "w") as file:
        # A process group, so that the children of run.sh end with it.
        process = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT, start_new_session=True,
                                   env={**os.environ, **(environment or {})})
        try:
            code = process.wait(timeout=limit)
        except subprocess.TimeoutExpired:
            end(process)
            return "out of time", f"stopped after {limit:g} s", None
        except BaseException:
            end(process)
            raise
    return ("ok", "", 0) if code == 0 else ("failed", f"exit code {code}: {last_words(log)}", code)


def last_words(log):
    """The last error message of the program or of run.sh, otherwise the last line."""
    lines = [line for line in Path(log).read_text(errors="replace").splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith(("brickwall:", "run.sh:")) and "run.sh: warning" not in line]
    return (errors or lines or ["no output"])[-1]


def end(process):
    # run.sh starts its launcher in a session of its own; a second signal makes it end that at once.
    for how in (signal.SIGTERM, signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, how)
            process.wait(timeout=PATIENCE)
            return
        except subprocess.TimeoutExpired:
            continue
        except ProcessLookupError:
            process.wait()
            return
