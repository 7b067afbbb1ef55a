"""Sizes of a problem: a number of its deck, such as the bricks along a wall, multiplied by a factor."""
import re
import tomllib

from . import machine
from .deck_check import check
from .errors import InputError


def enlarged(where, deck, settings, key, factor):
    """The settings with the number `key` of the settings, or else of the deck, multiplied by `factor`; `key` may end
    with an index such as [0]."""
    key, _, index = key.rstrip("]").partition("[")
    value = settings.get(key)
    if value is None:
        try:
            value = tomllib.loads(deck.read_text())
            for word in key.split("."):
                value = value[word]
        except (ValueError, KeyError, TypeError):
            raise InputError(f"{where}: grow: {deck} has no {key}; give it in [set]") from None
    number = value[int(index)] if index and isinstance(value, list) and int(index) < len(value) else None if index else value
    if not isinstance(number, (int, float)) or isinstance(number, bool):
        raise InputError(f"{where}: grow: {key} is {value!r}, which has no number" + f" at [{index}]" * bool(index))
    return {**settings, key: [*value[:int(index)], number * factor, *value[int(index) + 1:]] if index else number * factor}


def factor_of_share(where, program, deck, settings, key, share, gpu_bytes):
    """The largest factor with which the problem takes at most this share of the machine's memory, or, if `gpu_bytes` is
    given, of that; 0 if there is none. `brickwall check` estimates the memory, which grows linearly."""
    one, two = (memory_needed(where, program, deck, enlarged(where, deck, settings, key, factor), gpu_bytes is not None)
                for factor in (1, 2))
    if two <= one:
        raise InputError(f"{where}: memory: {key} does not change the memory that brickwall check estimates")
    room = share * (gpu_bytes or machine.memory_bytes("MemTotal"))
    return max(0, int(1 + (room - one) / (two - one)))


def memory_needed(where, program, deck, settings, on_device):
    """Bytes of all ranks, by `brickwall check`."""
    text, fault = check(program, deck, settings)
    found = re.search(r"memory +([\d.]+) MB per rank on 1 rank, of which ([\d.]+) MB", text)
    if fault or not found:
        raise InputError(f"{where}: brickwall check gives no estimate of the memory: {fault or text}")
    return 1e6 * float(found[2 if on_device else 1])
