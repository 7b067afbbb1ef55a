"""Makes the runs of a study in random order, and reads what they report."""
import random
from dataclasses import dataclass

from . import launch
from .errors import InputError
from .run_report import FILES, Run, read_run
from .run_store import digest, finished, perform


@dataclass
class Done:
    """A run that was made, or found finished."""

    order: int  # from 1
    case: object
    repetition: int  # from 1; those of warm-up runs are 0, -1, ...
    record: dict  # run.json
    reused: bool
    run: Run = None  # of a counted run that passed

    @property
    def is_counted(self):
        return self.repetition > 0


def plan(study, seed):
    """[(repetition, case)]: turns of all cases, each in a random order, warm-up turns first. So a change of the
    machine's speed with time meets all cases alike."""
    order = random.Random(seed)
    found = []
    for repetition in range(1 - study.warmup, study.repetitions + 1):
        turn = list(study.cases)
        order.shuffle(turn)
        found += [(repetition, case) for case in turn]
    return found


class Runner:
    def __init__(self, study, folder, cores):
        self.study, self.folder, self.cores = study, folder, cores
        self.programs = {name: digest(path) for name, path in study.programs.items()}
        self.decks = {case.deck: digest(case.deck) for case in study.cases}

    def make(self, order, repetition, case):
        """Makes a run unless it is finished already."""
        place = self.folder / "runs" / case.id / (f"warmup-{1 - repetition}" if repetition < 1 else f"run-{repetition}")
        words = [case.command, "-q", *case.options]
        for key, value in case.settings.items():
            words += ["--set", f"{key}={launch.spell(value)}"]
        variables = launch.environment(case.ranks, case.threads, self.cores)
        program = self.study.programs[case.program]
        key = {"program": self.programs[case.program], "deck": self.decks[case.deck], "options": words, "ranks": case.ranks,
               "threads": case.threads, "environment": variables}
        record = finished(place, key)
        if repetition >= 1 and not any((place / name).is_file() for name in FILES):
            record = None  # its report was removed
        done = Done(order, case, repetition, record, record is not None)
        if record is None:
            command = [*launch.launcher(program), "-n", str(case.ranks), str(program), case.command, str(case.deck), "-o", str(place),
                       *words[1:]]
            about = {"case": case.id, "name": case.name, "repetition": repetition}
            done.record = perform(place, key, command, self.study.limit, variables, about)
            # Fields are not needed, and reports of warm-up runs would be found by `brickwall report`.
            for name in ("*.exo*", "history.csv") if done.is_counted else ("*.exo*", "history.csv", *FILES):
                for path in place.glob(name):
                    path.unlink()
        if done.is_counted and done.record["state"] == "ok":
            try:
                done.run = read_run(place / FILES[case.command == "search"])
            except InputError as error:
                done.record.update(state="failed", message=str(error))
        return done
