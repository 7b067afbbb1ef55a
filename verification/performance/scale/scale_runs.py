"""The runs behind the scaling model: searches and coupled steps of walls W(n), counts of their messages, the replay on
virtual ranks, spheres, and the costs of messages. Finished runs are reused."""
import csv
import io
import json
import os
from pathlib import Path

from brickwall_study import launch
from brickwall_study.run_store import digest, finished, perform

INPUTS = Path(__file__).resolve().parents[3] / "inputs"
# All bricks are pressed, so that every joint is in contact.
PRESSED = {"load.pressure[0].peak": 0.0, "initial.deformation": "[{gradient=[-0.002,0,0,0,0,0,0,0,-0.002]}]",
           "output.history_interval": 1e9, "limits.energy_error": 10.0, "time.end": 1e3}


class RunFailed(Exception):
    pass


class Runs:
    def __init__(self, program, folder, cores, limit):
        self.program, self.folder, self.cores, self.limit = Path(program), Path(folder), cores, limit
        self.tools = self.program.parent.parent / "verification" / "performance"
        self.launcher = launch.launcher(program)
        self.digests = {}
        self.has_reused = False

    def perform(self, name, words, ranks, threads, more=None):
        """The folder of a finished run."""
        binary = words[0]
        if binary not in self.digests:
            self.digests[binary] = digest(binary)
        folder = self.folder / name
        key = {"program": self.digests[binary], "words": [str(word) for word in words[1:]], "ranks": ranks, "threads": threads,
               "more": more or {}}
        if finished(folder, key):
            self.has_reused = True
            return folder
        environment = {**os.environ, **launch.environment(ranks, threads, self.cores), **(more or {})}
        command = [*self.launcher, "-n", str(ranks), *map(str, words)]
        record = perform(folder, key, [str(word).replace("@", str(folder)) for word in command], self.limit, environment)
        if record["state"] != "ok":
            raise RunFailed(f"{name}: {record['state']}: {record['message']}")
        return folder

    def wall(self, n, command, ranks, threads, settings, turn, length=1, more=None):
        """search.json or report.json of a run of W(n), `length` times as long as that of the paper's."""
        words = [self.program, command, INPUTS / "wall_17k.toml", "-o", "@"]
        settings = {"wall.elements": [2 * n, n, n], "wall.bricks": [15 * length, 1, 29], "output.interval": 0.0, **settings}
        for key, value in settings.items():
            words += ["--set", f"{key}={launch.spell(value)}"]
        kind = "counted" if more else f"turn{turn}"
        steps = f"_s{settings['time.steps']}" if command == "run" else f"_s{settings['search.repetitions']}"
        folder = self.perform(f"{command}_W{n}_l{length}_n{ranks}_t{threads}_{kind}{steps}", words, ranks, threads, more)
        return folder, json.loads((folder / ("report.json" if command == "run" else "search.json")).read_text())

    def search_seconds(self, n, ranks, threads, repetitions, turn, length=1):
        report = self.wall(n, "search", ranks, threads, {"search.repetitions": repetitions, "search.warmup": 2}, turn, length)[1]
        return report["seconds"]["search"]["median"], report

    def step_seconds(self, n, ranks, threads, steps, turn, length=1):
        report = self.wall(n, "run", ranks, threads, {**PRESSED, "time.steps": steps}, turn, length)[1]
        return report["elements"] / report["fom"]["element_steps_per_second"], report

    def smallest(self, turn):
        """Seconds and reports of a search and of a step of a wall of two bricks of two elements: what they take without work."""
        bricks = {"wall.bricks": [1, 1, 2]}
        search = self.wall(1, "search", 1, 1, {**bricks, "search.repetitions": 50, "search.warmup": 2}, f"{turn}_smallest")[1]
        step = self.wall(1, "run", 1, 1, {**PRESSED, **bricks, "time.steps": 50}, f"{turn}_smallest")[1]
        return {"search": (search["seconds"]["search"]["median"], search),
                "step": (step["elements"] / step["fom"]["element_steps_per_second"], step)}

    def messages(self, n, command, ranks, steps):
        """What the ranks send in a search or a step: {"messages": {"sum": .., "max": ..}, ...}, and the last report.
        The difference of two runs, so that the set-up is not in it."""
        found, report = [], None
        for count in (steps, 3 * steps):
            settings = {"search.repetitions": count, "search.warmup": 2} if command == "search" else {**PRESSED, "time.steps": count}
            counter = self.tools / "libbrickwall_message_counter.so"
            more = {"LD_PRELOAD": str(counter), "BRICKWALL_MESSAGE_COUNTS": "counts.json"}
            path = self.folder / f"counts_{command}_W{n}_n{ranks}_{count}.json"
            more["BRICKWALL_MESSAGE_COUNTS"] = str(path)
            report = self.wall(n, command, ranks, 1, settings, 0, more=more)[1]
            found.append(json.loads(path.read_text()))
        return {name: {part: (found[1][name][part] - found[0][name][part]) / (2 * steps) for part in ("sum", "max")}
                for name in ("messages", "bytes", "reductions", "collectives")}, report

    def output_of(self, name, tool, words, ranks=1):
        folder = self.perform(name, [self.tools / tool, *words], ranks, 1)
        return (folder / "log.txt").read_text()

    def message_costs(self):
        if self.cores < 2:
            return None
        return json_line(self.output_of("message_cost", "brickwall_message_cost", [], 2))

    def spheres(self, rows, ranks, repetitions):
        return json_line(self.output_of(f"spheres_r{rows}_n{ranks}", "contact_spheres",
                                        ["--rows", rows, "--repetitions", repetitions], ranks))

    def replay(self, *words):
        """Rows of contact_virtual_ranks."""
        text = self.output_of("replay_" + "_".join(map(str, words[:3])), "contact_virtual_ranks", words)
        begin = text.index("scene,n,ranks")
        return [row for row in csv.DictReader(io.StringIO(text[begin:])) if row["ranks"]]


def json_line(text):
    return json.loads(next(line for line in text.splitlines() if line.startswith("{")))
