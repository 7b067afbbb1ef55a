"""What the study asks of a scene, and the settings that it is run with."""
from pathlib import Path

from measure import Setting

HERE = Path(__file__).resolve().parent
DEFAULT = Setting()


def setting(group, **changes):
    """setting("penalty", penalty=1.0): short names of the keys below."""
    return Setting(tuple((SHORT[name], value) for name, value in changes.items()), group)


SHORT = {"safety": "time.safety", "penalty": "contact.penalty", "scheme": "contact.scheme", "edges": "contact.edges",
         "element": "element.formulation", "margin": "search.reuse.margin"}
STEPS = [setting("time step", safety=value) for value in (0.5, 0.65, 0.95)]
PENALTIES = [setting("penalty", penalty=value) for value in (0.05, 0.1, 0.25, 0.6, 0.75, 1.0)]
SOFT_AND_LONG = [setting("penalty, longest step", penalty=value, safety=0.95) for value in (0.05, 0.1, 0.25, 0.5)]
FULL = setting("element", element="full")
PLAIN = setting("scheme, edges", scheme="penalty")
NO_EDGES = setting("scheme, edges", edges=False)
EVERY_STEP = setting("reuse", margin=0.0)  # searches
REUSE = [EVERY_STEP, *(setting("reuse", margin=value) for value in (0.25, 0.5))]
KEPT = [DEFAULT, *REUSE[1:]]  # the default keeps lists by a margin of .1
COMBINED = [setting("several", penalty=0.75, margin=0.25), setting("several", safety=0.95, margin=0.25),
            setting("several", penalty=0.75, safety=0.5), setting("several", penalty=0.75, edges=False),
            setting("several", penalty=0.75, edges=False, scheme="penalty", margin=0.25)]
# What finer meshes are run with.
FEW = [DEFAULT, *(setting("penalty", penalty=value) for value in (0.25, 0.75)), *COMBINED[:2]]


class Scene:
    """One problem with an error to measure. Subclasses say how."""

    name = ""
    text = ""  # what it is and what its error is
    deck = None
    sizes = {}  # {mesh: element length}
    targets = (0.1, 0.03, 0.01, 0.003, 0.001)  # errors at which settings are compared

    def settings(self, mesh):
        """Of all its runs on this mesh, over the program's defaults."""
        raise NotImplementedError

    def geometry(self, mesh):
        """A mesh that stands in for the deck's, or None."""

    def variants(self, mesh):
        """The settings to run on a mesh."""
        raise NotImplementedError

    def observe(self, run):
        """{name: numbers} of a run, to be kept."""
        raise NotImplementedError

    def prepare(self, bench):
        """Reference solutions, where no exact one is known."""

    def errors(self, observed):
        """{"error": ..., further figures}."""
        return observed

    def study(self, bench):
        """All points, with the errors of those that came to an end."""
        self.prepare(bench)
        points = [bench.point(self, mesh, variant) for mesh in self.sizes for variant in self.variants(mesh)]
        for point in points:
            point.errors = {} if point.failure else self.errors(point.record["observed"])
        return points
