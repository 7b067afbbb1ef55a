"""A finished run: report.json of `brickwall run` or search.json of `brickwall search`, checked, with the deck beside it."""
import json
import math
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from .errors import InputError, read_parsed

SCHEMAS = {"brickwall-report-1": "run", "brickwall-search-1": "search"}
FILES = ("report.json", "search.json")
BUILD = ("version", "commit", "compiler", "flags", "kokkos", "mpi", "execution_space")
# Parts of a step: the name in tables and the region in report.json; indented ones are parts of the one before.
PHASES = (("search", "search"), ("- ghosts", "contact::findGhosts"), ("- pairs", "contact::findCandidatePairs"),
          ("contact enforcement", "step::contact enforcement"), ("internal force", "step::internal force"),
          ("free bricks", "step::free bricks"), ("loads", "step::loads"), ("shared-node sum", "step::shared-node sum"),
          ("kick", "step::kick"), ("ledger", "step::ledger"), ("drift", "step::drift"),
          ("tunnelling guard", "step::tunnelling guard"), ("stable step", "step::stable step"),
          ("audit of pairs", "step::audit of pairs"))
# Settings of a search, which search.json holds in place of a deck.
SEARCH_SETTINGS = ("method", "timing", "local_search", "shuffled", "jitter", "drift", "seed", "margin")
IGNORED = ("title", "units", "output.")  # of a deck: they do not change the computation


@dataclass
class Run:
    """Times are in seconds; those of phases are means over the ranks."""

    path: Path  # of the JSON file
    kind: str  # "run" or "search"
    name: str  # of the case in a study, otherwise of the deck
    case: str  # the name of the deck
    title: str
    build: dict  # of BUILD
    cpu: str
    device: str
    host: str
    ranks: int
    threads: int
    sizes: dict  # elements (of a run only), nodes, faces
    steps: int  # counted steps or searches
    whole: float  # of a step on the slowest rank, or median of a search
    phases: dict  # name -> of a step or search
    imbalance: dict  # name -> largest rank over mean
    counts: dict
    throughput: float  # element steps or face searches per second
    setup: float
    memory: float  # bytes: of the GPU that is fullest, by all processes, or of the largest rank
    memory_share: float  # of a GPU's memory; otherwise None
    energy_error: float
    checksum: str
    settings: dict  # "block.key" -> value
    ended: str  # "" or the reason why it failed or stopped
    missing: list = field(default_factory=list)  # fields that the report lacks

    @property
    def workers(self):
        """GPUs, with a rank each, or cores."""
        return self.ranks if self.device != "none" else self.ranks * self.threads

    @property
    def layout(self):
        return f"{self.ranks} x {self.threads}"

    @property
    def unit(self):
        return "step" if self.kind == "run" else "search"

    @property
    def size(self):
        return self.sizes.get("elements", self.sizes["faces"])


class Fields:
    """The fields of a JSON object. Raises InputError that names the file and the field."""

    def __init__(self, path, values, prefix=""):
        self.path, self.values, self.prefix = path, values, prefix
        if not isinstance(values, dict):
            raise InputError(f"{path}: {prefix.rstrip('.') or 'the file'} is no JSON object")

    def get(self, name, *types):
        """A field of one of the types; numbers are finite and not negative."""
        if name not in self.values:
            raise InputError(f'{self.path}: the field "{self.prefix}{name}" is missing')
        value = self.values[name]
        is_right = isinstance(value, types) and (bool in types or not isinstance(value, bool))
        if not is_right or isinstance(value, (int, float)) and not 0 <= value < math.inf:
            raise InputError(f'{self.path}: the field "{self.prefix}{name}" is {json.dumps(value)[:40]}, expected '
                             + " or ".join({str: "a text", int: "a number", float: "a number", dict: "an object", list: "a list",
                                            bool: "true or false"}[one] for one in types[:1]))
        return value

    def optional(self, name, default, *types):
        """A field that reports of earlier versions lack."""
        return self.get(name, *types) if name in self.values else default

    def count(self, name):
        """A number from 1."""
        if self.get(name, int) < 1:
            raise InputError(f'{self.path}: the field "{self.prefix}{name}" is 0')
        return self.values[name]

    def number(self, name):
        return self.get(name, float, int)

    def object(self, name):
        return Fields(self.path, self.get(name, dict), f"{self.prefix}{name}.")

    def list(self, name):
        return [Fields(self.path, entry, f"{self.prefix}{name}[{i}].") for i, entry in enumerate(self.get(name, list))]


def read_run(path):
    """The Run of a report.json or search.json. Raises InputError."""
    path = Path(path)
    data = read_parsed(path, json.loads, "no JSON, or a truncated file: ")
    fields = Fields(path, data)
    schema = data.get("schema")
    if not isinstance(schema, str) or schema not in SCHEMAS:
        raise InputError(f'{path}: no report of Brickwall: the schema is {json.dumps(schema)}, expected {" or ".join(SCHEMAS)}')
    common = {"path": path, "kind": SCHEMAS[schema], "name": name_in_study(path) or fields.get("case", str),
              "build": {name: fields.get(name, str) for name in BUILD},
              **{name: fields.get(name, str) for name in ("case", "title", "cpu", "device", "host")},
              "ranks": fields.count("ranks"), "threads": fields.count("threads_per_rank")}
    run = (read_simulation if common["kind"] == "run" else read_search)(fields, common)
    if run.steps < 1 or run.whole <= 0:
        raise InputError(f"{path}: no {run.unit} was timed (the first step of a run is not counted)")
    return run


def name_in_study(path):
    """The name of the case in the study that made this run; see run_store.py."""
    try:
        return str(json.loads((path.parent / "run.json").read_text())["name"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""


def read_simulation(fields, common):
    phases = {phase.get("name", str): phase for phase in fields.list("phases")}
    if "step" not in phases:
        raise InputError(f'{fields.path}: the phase "step" is missing')
    steps = phases["step"].get("calls", int)
    counted = max(1, steps)
    found = {name: phases[region].number("mean") / counted for name, region in PHASES if region in phases}
    parts = sum(value for name, value in found.items() if not name.startswith("-"))
    found["other"] = max(0.0, phases["step"].number("mean") / counted - parts)
    imbalance, missing = imbalance_of_phases(fields.path, phases)
    imbalance.update(imbalance_of_counts(fields))
    search, balance = fields.object("search"), fields.object("balance")
    pass_, stopped = fields.get("pass", bool), fields.optional("stopped", "", str)
    return Run(
        **common, sizes={name: fields.count(name) for name in ("elements", "nodes", "faces")}, steps=steps,
        whole=fields.number("loop_seconds") / counted, phases=found, imbalance=imbalance, missing=missing,
        counts={"steps": fields.get("steps", int), "searches": search.get("searches", int), "ghost faces": search.get("ghost_faces", int),
                "pairs": search.get("candidate_pairs", int), "contacts": search.get("active_contacts", int), **messages_of(fields)},
        throughput=fields.object("fom").number("element_steps_per_second"), setup=fields.optional("setup_seconds", None, float, int),
        **memory_of(fields, fields.object("memory")), energy_error=balance.number("energy_error"),
        checksum=fields.optional("checksums", {}, dict).get("nodes", ""),
        settings={**settings_of_deck(fields, search), **options_of(fields)}, ended="" if pass_ else stopped or "; ".join(fields.get("failures", list)) or "failed")


def read_search(fields, common):
    seconds = fields.object("seconds")
    times = {name: seconds.object(part) for name, part in (("search", "search"), ("ghosts", "global_search"), ("pairs", "local_search"))}
    phases = {"ghosts": times["ghosts"].number("median"),
              **{f"- {timer.get('name', str)}": timer.number("median") for timer in fields.list("timers")},
              "pairs": times["pairs"].number("median")}
    counts = fields.object("counts")
    return Run(
        **common, sizes={name: fields.count(name) for name in ("nodes", "faces")}, steps=fields.get("searches", int),
        whole=times["search"].number("median"), phases=phases,
        imbalance={name: part.number("imbalance") for name, part in times.items()},
        counts={"searches": fields.get("searches", int), "ghost faces": counts.get("ghost_faces", int),
                "pairs": counts.get("candidate_pairs", int)},
        throughput=fields.object("fom").number("face_searches_per_second"), setup=None, energy_error=None, checksum="",
        **memory_of(fields, fields.object("memory").object("peak")),
        settings={f"search.{name}": fields.get(name, str, bool, int, float) for name in SEARCH_SETTINGS}, ended="")


def memory_of(fields, memory):
    """The memory that a larger problem would exhaust: of the GPU, otherwise that in `memory`."""
    gpu = fields.optional("device_memory", None, dict)
    if gpu is None:
        return {"memory": memory.number("max_rank_bytes"), "memory_share": None}
    gpu = fields.object("device_memory")
    return {"memory": gpu.number("bytes_in_use"), "memory_share": gpu.number("bytes_in_use") / gpu.count("bytes")}


def imbalance_of_phases(path, phases):
    """({name: largest rank over mean}, [fields that are missing])."""
    found, missing = {}, []
    for name, region in (("search", "search"), ("pairs", "contact::findCandidatePairs"), ("enforcement", "step::contact enforcement")):
        if region not in phases:
            continue  # a run without contact
        lacking = [what for what in ("mean", "max") if what not in phases[region].values]
        if lacking:
            missing.append(f'{path}: the phase "{region}" has no field "{lacking[0]}"')
        elif phases[region].number("mean") > 0:
            found[name] = phases[region].number("max") / phases[region].number("mean")
    return found, missing


def imbalance_of_counts(fields):
    """The same of the counts that a report states; those before `imbalance` was added state none."""
    if "imbalance" not in fields.values:
        return {}
    counts = fields.object("imbalance")
    return {name.replace("_", " "): counts.object(name).number("max_over_mean")
            for name in ("faces", "ghost_faces", "candidate_pairs", "active_contacts") if name in counts.values}


def messages_of(fields):
    """Messages and bytes that a rank sends in a step; reports of earlier versions state none."""
    sent = fields.optional("imbalance", {}, dict)
    return {name: round(fields.object("imbalance").object(key).number("mean"))
            for name, key in (("messages a rank and step", "messages"), ("bytes", "bytes_sent")) if key in sent}


def options_of(fields):
    """Options of the command line that change the times, and the step of the restart, since a restarted run has not timed the
    steps before; reports of earlier versions name none."""
    options = " ".join(map(str, fields.optional("options", [], list)))
    restart = fields.optional("first_step", 0, int)
    return {**({"options": options} if options else {}), **({"restart": f"at step {restart}"} if restart else {})}


def settings_of_deck(fields, search):
    """All keys of the resolved deck beside the report; without a deck only what the report says."""
    deck = fields.path.parent / f"{fields.values['case']}.resolved.toml"
    if not deck.exists():
        return {"search.method": search.get("method", str), "search.reuse.margin": search.number("margin")}
    try:
        settings = flat(tomllib.loads(deck.read_text()))
    except (OSError, ValueError) as error:
        raise InputError(f"{deck}: {error}") from None
    return {key: value for key, value in settings.items() if not key.startswith(IGNORED)}


def flat(table, prefix=""):
    """{"block.key": value} of nested tables; entries of lists of tables are counted from 0, as in --set."""
    found = {}
    for key, value in table.items():
        if isinstance(value, dict):
            found.update(flat(value, f"{prefix}{key}."))
        elif isinstance(value, list) and value and all(isinstance(entry, dict) for entry in value):
            for i, entry in enumerate(value):
                found.update(flat(entry, f"{prefix}{key}[{i}]."))
        else:
            found[prefix + key] = value
    return found


def find_runs(place):
    """The reports of a run's folder, of all runs below a folder, or the named file itself. Raises InputError."""
    place = Path(place)
    if place.is_file():
        return [place]
    if not place.is_dir():
        raise InputError(f"{place}: there is no such file or folder")
    found = sorted((path for name in FILES for path in place.rglob(name)), key=natural)
    if not found:
        raise InputError(f"{place}: no {' or '.join(FILES)} here or below")
    return found


def natural(path):
    """A sort key by which run-2 stands before run-10."""
    return [(int(word), "") if word.isdigit() else (-1, word) for word in re.split(r"(\d+)", str(path))]
