"""The environment in which a case is evaluated: it runs the program, collects checks and draws
plots."""
import tomllib
from contextlib import contextmanager
from pathlib import Path

from .checks import Check, fitted_order, observed_orders


class Lab:
    """The argument of a case's evaluate(lab)."""

    def __init__(self, program, deck, folder, plots, outcome, quick):
        self.program, self.deck_path, self.folder, self.plots = program, Path(deck), Path(folder), Path(plots)
        self.outcome = outcome
        self.quick = quick  # the short form, for ctest
        self.deck = tomllib.loads(self.deck_path.read_text())  # as in the file, without overrides

    def run(self, label, settings=None, **how):
        """Runs the case's deck into the folder `label` with overrides {key: value}; see Program.run
        for `how`."""
        run = self.program.run(how.pop("deck", self.deck_path), self.folder / label, settings, **how)
        if not self.outcome.program and (run.folder / "report.json").exists():
            self.outcome.program = {key: run.report[key] for key in
                                    ("version", "commit", "compiler", "flags", "kokkos", "mpi", "cpu", "execution_space")}
        return run

    def check(self, computed, exact, threshold, name="", error=None, orders=()):
        """Compares a value with the exact one. The first check is the case's own line; the others
        need names. If `error` is not given, it is relative to `exact`, or absolute if that is
        zero."""
        computed, exact = float(computed), float(exact)
        if error is None:
            error = abs(computed - exact) / (abs(exact) or 1)
        self.outcome.checks.append(Check(name, computed, exact, float(error), float(threshold), tuple(orders)))

    def require(self, condition, name):
        """A check of a condition, such as that bodies have met at all."""
        self.check(bool(condition), 1, 0, name)

    def check_order(self, sizes, errors, least, name="order", exact=None):
        """Checks that the exponent p of error = C size^p, fitted to all meshes, is at least
        `least`. The exponents between successive meshes are printed."""
        order = fitted_order(sizes, errors)
        exact = least if exact is None else exact
        self.check(order, exact, exact - least, name, max(0.0, exact - order), observed_orders(sizes, errors))

    def note(self, text):
        """A paragraph in the case's section of the report."""
        self.outcome.notes.append(text)

    def weak_spot(self, text):
        """An item in the report's section on weak spots of the method."""
        self.outcome.weak_spots.append(text)

    def table(self, caption, header, rows):
        self.outcome.tables.append((caption, list(header), [list(row) for row in rows]))

    def publish(self, quantity, computed, published, source):
        """A comparison with a published figure, for the report."""
        self.outcome.published.append((quantity, computed, published, source))

    @contextmanager
    def figure(self, caption, name="", panels=1, width=7.0):
        """Context of one plot: `with lab.figure("...") as axes`. With panels > 1 there is a list of
        axes."""
        from .figures import new_figure, save

        figure, axes = new_figure(panels, width)
        yield axes
        file = f"{self.folder.name}{'_' + name if name else ''}.png"
        save(figure, self.plots / file)
        self.outcome.figures.append((file, caption))
