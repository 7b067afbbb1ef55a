"""Labels of fields with the units of the deck, and prefixes in SI."""
import numpy as np

# The rows of the table in miniapp/deck/reference.md.
SYSTEMS = {"m-kg-s": {"length": "m", "time": "s", "velocity": "m/s", "force": "N", "stress": "Pa", "energy": "J"},
           "mm-t-s": {"length": "mm", "time": "s", "velocity": "mm/s", "force": "N", "stress": "MPa", "energy": "mJ"},
           "mm-kg-ms": {"length": "mm", "time": "ms", "velocity": "m/s", "force": "kN", "stress": "GPa", "energy": "J"},
           "cm-g-us": {"length": "cm", "time": "µs", "velocity": "10⁴ m/s", "force": "10⁷ N", "stress": "Mbar", "energy": "10⁵ J"},
           "none": {}}
SI = "m-kg-s"
QUANTITIES = {"displacement": "length", "velocity": "velocity", "acceleration": "acceleration", "force": "force", "stress": "stress",
              "principal": "stress", "von_mises": "stress", "pressure": "stress", "contact_pressure": "stress",
              "energy_density": "energy/volume", "strain_energy": "energy", "contact_gap": "length", "slip_velocity": "velocity",
              "slip_distance": "length", "search_time": "wall clock"}
PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k", 1.0: "", 1e-3: "m", 1e-6: "µ", 1e-9: "n"}


class Units:
    """The units of a system of SYSTEMS."""

    def __init__(self, system=SI):
        self.system, self.names = system, SYSTEMS[system]

    def of(self, quantity):
        """The unit of a quantity, or "" where it has none."""
        if quantity == "wall clock":
            return "s"
        if not self.names or not quantity:
            return ""
        length, time, force = (self.names[name] for name in ("length", "time", "force"))
        products = {"acceleration": f"{length}/{time}²", "energy/volume": f"{self.names['energy']}/{length}³",
                    "momentum": f"{force} {time}", "angular momentum": f"{force} {length} {time}"}
        return products.get(quantity) or self.names[quantity]

    def scaled(self, quantity, largest):
        """(factor, unit) for values of a quantity. In SI prefixes bring the largest between 1 and 1000; from 0.05 on it keeps the
        plain unit."""
        unit = self.of(quantity)
        if self.system != SI or not unit or not np.isfinite(largest) or largest == 0 or 0.05 <= largest < 1:
            return 1.0, unit
        factor = next((f for f in PREFIXES if largest >= f), 1e-9)
        return 1 / factor, PREFIXES[factor] + unit


def quantity_of(name):
    """The quantity of a field of the program, or ""."""
    return next((quantity for start, quantity in QUANTITIES.items() if name.startswith(start)), "")


def round_below(value):
    """The largest of 1, 2, 5 times a power of ten that is not above the value."""
    power = 10.0 ** np.floor(np.log10(value))
    return next(step * power for step in (5, 2, 1) if step * power <= value * (1 + 1e-12))
