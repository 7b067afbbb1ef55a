"""The results of a case: values compared with exact ones, tables, notes, comparisons with published
figures."""
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Check:
    """One computed value and the exact one. The check passes if error <= threshold; a NaN fails."""

    name: str  # "" for the case's own line
    computed: float
    exact: float
    error: float
    threshold: float
    orders: tuple = ()  # observed between successive meshes

    @property
    def passed(self):
        return bool(self.error <= self.threshold)

    def text(self):
        line = f"computed={self.computed:.7g} exact={self.exact:.7g} error={self.error:.3g} threshold={self.threshold:.3g}"
        return line + (" order=" + ",".join(f"{order:.2f}" for order in self.orders) if self.orders else "")


@dataclass
class Outcome:
    """All results of a case for the report."""

    name: str  # such as "V7"
    title: str
    text: str  # the description of the case, from its module
    checks: list = field(default_factory=list)
    tables: list = field(default_factory=list)  # (caption, header, rows)
    notes: list = field(default_factory=list)
    weak_spots: list = field(default_factory=list)
    published: list = field(default_factory=list)  # (quantity, computed, published, source)
    figures: list = field(default_factory=list)  # file names
    failure: str = ""  # the reason why there is no result
    seconds: float = 0.0
    program: dict = field(default_factory=dict)  # versions, from a run's report

    @property
    def passed(self):
        return not self.failure and bool(self.checks) and all(check.passed for check in self.checks)

    def lines(self):
        """The case's own line, with its first check, and a line for each further check."""
        if self.failure:
            return [f"{self.name} FAIL {self.failure}"]
        if not self.checks:
            return [f"{self.name} FAIL it has no check"]
        missed = [check.name for check in self.checks[1:] if not check.passed]
        lines = [f"{self.name} {'PASS' if self.passed else 'FAIL'} {self.checks[0].text()}"
                 + (f" missed={','.join(missed)}" if missed else "")]
        return lines + [f"  {self.name}.{check.name} {'pass' if check.passed else 'fail'} {check.text()}"
                        for check in self.checks[1:]]


def fitted_order(sizes, errors):
    """Exponent p of error = C size^p, by least squares of the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])


def observed_orders(sizes, errors):
    """The exponents between successive meshes."""
    return tuple(float(p) for p in np.diff(np.log(np.abs(errors))) / np.diff(np.log(sizes)))
