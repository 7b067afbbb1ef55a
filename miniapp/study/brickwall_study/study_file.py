"""A study file: TOML that names decks, settings, ranks, threads and programs; see README.md beside this folder."""
import itertools
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from .errors import InputError, read_parsed
from .launch import spell
from .problem_size import enlarged, factor_of_share
from .tables import counted

COMMANDS = ("run", "search")
# Key -> (type, check, description of what is expected). Keys of a case override those of the file.
COUNT = (int, lambda value: value >= 1, "an integer from 1")
COUNTS = (list, lambda value: value and all(type(n) is int and n >= 1 for n in value) and len(set(value)) == len(value),
          "a list of different integers from 1")
TABLE = (dict, lambda value: True, "a table")
COMMON = {"command": (str, lambda value: value in COMMANDS, " or ".join(COMMANDS)), "ranks": COUNTS, "threads": COUNTS,
          "set": TABLE, "sweep": TABLE, "grow": (str, lambda value: re.fullmatch(r"[\w.]+(\[\d+\])?", value), "a key such as wall.bricks[0]"),
          "memory": (list, lambda value: value and all(type(share) is float and 0 < share < 1 for share in value),
                     "a list of shares between 0 and 1"),
          "gpu_memory": ((int, float), lambda value: value > 0, "bytes above 0"),
          "options": (list, lambda value: all(isinstance(word, str) for word in value), "a list of texts")}
FILE = {**COMMON, "title": (str, lambda value: True, "a text"), "repetitions": COUNT,
        "warmup": (int, lambda value: value >= 0, "an integer from 0"), "seed": (int, lambda value: value >= 0, "an integer from 0"),
        "limit": ((int, float), lambda value: value > 0, "seconds above 0"), "oversubscribe": (bool, lambda value: True, "true or false"),
        "programs": (dict, lambda value: value and all(isinstance(path, str) for path in value.values()), "a table of name = path"),
        "case": (list, lambda value: value and all(isinstance(one, dict) for one in value), "at least one [[case]]")}
CASE = {**COMMON, "name": (str, lambda value: value.strip(), "a text"), "deck": (str, lambda value: value, "the path of a deck")}


@dataclass(frozen=True)
class Case:
    """A run of the study, to be repeated."""

    id: str  # the name of its folder
    name: str
    command: str
    deck: Path
    program: str  # its name in `programs`
    ranks: int
    threads: int
    settings: dict  # "block.key" -> value
    options: tuple


@dataclass
class Study:
    path: Path
    title: str
    programs: dict  # name -> path
    repetitions: int
    warmup: int
    seed: int  # or None
    limit: float  # seconds of a run
    cases: list
    left_out: list = field(default_factory=list)  # with the reason


def read_study(path, program, cores, ranks=None, threads=None):
    """The Study of a file. `program` is the one that runs where the file names none; `ranks` and `threads` replace
    those of the file. Raises InputError for the first fault."""
    path = Path(path)
    data = read_parsed(path, tomllib.loads)
    if "case" not in data and ("wall" in data or "mesh" in data):
        raise InputError(f"{path}: found a deck, expected a study file with [[case]]; brickwall run {path} runs it")
    check_keys(f"{path}", data, FILE)
    if "case" not in data:
        raise InputError(f"{path}: found no [[case]], expected at least one")
    programs = {name: (path.parent / one).resolve() for name, one in data.get("programs", {"": Path(program).absolute()}).items()}
    for one in programs.values():
        if not one.is_file():
            raise InputError(f"{path}: there is no program {one}")
    study = Study(path, data.get("title", path.stem), programs, data.get("repetitions", 5), data.get("warmup", 1), data.get("seed"),
                  data.get("limit", 900), [])
    for number, entry in enumerate(data["case"]):
        where = f"{path}: case {entry.get('name', number + 1)}"
        check_keys(where, entry, CASE)
        if "deck" not in entry:
            raise InputError(f'{where}: the key "deck" is missing')
        deck = (path.parent / entry["deck"]).resolve()
        if not deck.is_file():
            raise InputError(f"{where}: there is no deck {deck}")
        merged = {key: entry.get(key, data.get(key)) for key in ("command", "grow", "memory", "gpu_memory", "options")}
        merged.update({key: flat({**data.get(key, {}), **entry.get(key, {})}) for key in ("set", "sweep")})
        if merged["memory"] and not merged["grow"]:
            raise InputError(f'{where}: memory needs the key "grow"')
        for key, values in merged["sweep"].items():
            if not isinstance(values, list) or not values:
                raise InputError(f"{where}: sweep: {key} is {values}, expected a list of values")
        layouts = itertools.product(ranks or entry.get("ranks") or data.get("ranks", [1]),
                                    threads or entry.get("threads") or data.get("threads", [1]))
        for layout in layouts:
            add_cases(study, where, entry.get("name", deck.stem), deck, merged, layout, cores if not data.get("oversubscribe") else None)
    if not study.cases:
        raise InputError(f"{path}: no case is left: {study.left_out[0]}")
    return study


def check_keys(where, table, known):
    for key, value in table.items():
        if key not in known:
            raise InputError(f'{where}: unknown key "{key}", expected one of {", ".join(sorted(known))}')
        kind, is_right, expected = known[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool) or not is_right(value):
            raise InputError(f"{where}: {key} is {value!r}, expected {expected}")


def flat(table, prefix=""):
    """{"block.key": value}: keys may be written as [set] time.steps = 20 and as "time.steps" = 20."""
    found = {}
    for key, value in table.items():
        found.update(flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value})
    return found


def add_cases(study, where, name, deck, merged, layout, cores):
    """Adds the cases of all programs, swept values and sizes on one layout."""
    ranks, threads = layout
    if cores and ranks * threads > cores:
        study.left_out.append(f"{name}, {ranks} x {threads}: more than the {counted(cores, 'core')}; oversubscribe = true runs it")
        return
    keys = list(merged["sweep"])
    for program, path in study.programs.items():
        for *values, share in itertools.product(*merged["sweep"].values(), merged["memory"] or [None]):
            settings = {**merged["set"], **dict(zip(keys, values))}
            words = [name] + [f"{key.split('.')[-1]}={spell(value)}" for key, value in zip(keys, values)]
            words += [*([f"memory={share:g}"] if share else []), f"{ranks}x{threads}", *([program] if program else [])]
            identity = re.sub(r"[^\w=.,()-]+", "_", "_".join(words))
            if any(case.id == identity for case in study.cases):
                raise InputError(f"{where}: there are two cases {identity}; give them different names")
            if merged["grow"]:
                gpus = merged["gpu_memory"] and merged["gpu_memory"] * ranks
                factor = ranks * threads if share is None else factor_of_share(where, path, deck, settings, merged["grow"], share, gpus)
                if factor < 1:
                    study.left_out.append(f"{identity}: the smallest size needs more than this share of the memory")
                    continue
                settings = enlarged(where, deck, settings, merged["grow"], factor)
            if (merged["command"] or "run") == "run":
                settings = {"output.interval": 0.0, **settings}
            study.cases.append(Case(identity, name, merged["command"] or "run", deck, program, ranks, threads, settings,
                                    tuple(merged["options"] or ())))
