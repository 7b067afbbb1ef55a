"""Labels of fields with SI units and prefixes. Decks in other units need labels of their own (--label)."""
import numpy as np

UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s²", "force": "N", "stress": "Pa", "principal": "Pa",
         "von_mises": "Pa", "pressure": "Pa", "contact_pressure": "Pa", "energy_density": "J/m³", "strain_energy": "J",
         "contact_gap": "m", "slip_velocity": "m/s", "slip_distance": "m", "search_time": "s"}
PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k", 1.0: "", 1e-3: "m", 1e-6: "µ", 1e-9: "n"}


def unit_of(name):
    """The SI unit of a field of the program, or ""."""
    return next((unit for start, unit in UNITS.items() if name.startswith(start)), "")


def scaled(unit, largest):
    """(factor, unit with prefix) that bring the largest value of a field between 1 and 1000; from 0.05 on it keeps the
    plain unit."""
    if not unit or not np.isfinite(largest) or largest == 0 or 0.05 <= largest < 1:
        return 1.0, unit
    factor = next((f for f in PREFIXES if largest >= f), 1e-9)
    return 1 / factor, PREFIXES[factor] + unit


def round_below(value):
    """The largest of 1, 2, 5 times a power of ten that is not above the value."""
    power = 10.0 ** np.floor(np.log10(value))
    return next(step * power for step in (5, 2, 1) if step * power <= value * (1 + 1e-12))
