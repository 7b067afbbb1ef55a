"""`brickwall check` of the decks of a study, before its runs."""
import os
import subprocess

from . import launch, machine
from .errors import InputError


def check(program, deck, settings):
    """(what `brickwall check` prints, what it finds wrong or "")."""
    words = [word for name, value in settings.items() for word in ("--set", f"{name}={launch.spell(value)}")]
    cores = machine.physical_cores()
    done = subprocess.run([*launch.launcher(program), "-n", "1", str(program), "check", str(deck), *words], capture_output=True, text=True,
                          env={**os.environ, **launch.environment(1, cores, cores)})
    if done.returncode == 0:
        return done.stdout, ""
    return done.stdout, (done.stderr.strip() or f"exit code {done.returncode}").removeprefix("brickwall: error: ")


def check_cases(study):
    """Checks each deck with its settings once. Raises InputError with all faults."""
    found, faults = {}, {}
    for case in study.cases:
        key = case.program, case.deck, repr(case.settings)
        if key not in found:
            found[key] = check(study.programs[case.program], case.deck, case.settings)[1]
        if found[key]:
            faults.setdefault(found[key], []).append(case.id)
    if faults:
        raise InputError(f"{study.path}: brickwall check refuses {sum(map(len, faults.values()))} of {len(study.cases)} cases"
                         + "".join(f"\n{ids[0]}{f' and {len(ids) - 1} more' if ids[1:] else ''}: {fault}" for fault, ids in faults.items()))
