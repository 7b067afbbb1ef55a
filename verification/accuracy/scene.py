"""The interface of a scene, and the settings of its runs."""
from pathlib import Path

from measure import Setting

HERE = Path(__file__).resolve().parent
DEFAULT = Setting()


def counts_of(mesh):
    """The numbers of elements of a mesh "8x4x4"."""
    return [int(count) for count in mesh.split("x")]


def setting(group, **changes):
    """A setting from the short names of keys below, such as setting("penalty", penalty=1.0)."""
    return Setting(tuple((SHORT[name], value) for name, value in changes.items()), group)


SHORT = {"safety": "time.safety", "penalty": "contact.penalty", "scheme": "contact.scheme", "edges": "contact.edges",
         "element": "element.formulation", "mass": "element.mass", "margin": "search.reuse.margin"}
STEPS = [setting("time step", safety=value) for value in (0.5, 0.65, 0.95)]
PENALTIES = [setting("penalty", penalty=value) for value in (0.05, 0.1, 0.25, 0.6, 0.75, 0.97, 1.0)]
SOFT_AND_LONG = [setting("penalty, longest step", penalty=value, safety=0.95) for value in (0.05, 0.1, 0.25, 0.5)]
FULL = setting("element", element="full")
PLAIN = setting("scheme, edges", scheme="penalty")
NO_EDGES = setting("scheme, edges", edges=False)
EVERY_STEP = setting("reuse", margin=0.0)  # a search in every step
REUSE = [EVERY_STEP, *(setting("reuse", margin=value) for value in (0.25, 0.5))]
KEPT = [DEFAULT, *REUSE[1:]]  # the default keeps lists with a margin of 0.1
COMBINED = [setting("several", penalty=0.75, margin=0.25), setting("several", safety=0.95, margin=0.25),
            setting("several", penalty=0.75, safety=0.5), setting("several", penalty=0.75, edges=False),
            setting("several", penalty=0.75, edges=False, scheme="penalty", margin=0.25)]
# The settings that run with both nodal masses; ROW_SUMS are those with the former ones.
BOTH_MASSES = [DEFAULT, COMBINED[1], COMBINED[2], setting("penalty", penalty=0.75)]
ROW_SUMS = [Setting((*both.changes, ("element.mass", "row_sum")), "row sums") for both in BOTH_MASSES]
# The settings on finer meshes.
FEW = [DEFAULT, *(setting("penalty", penalty=value) for value in (0.25, 0.75, 0.97)), *COMBINED[:2]]


class Scene:
    """A problem with an error to be measured by its subclasses."""

    name = ""
    text = ""  # description of the problem and its error
    deck = None
    rule = DEFAULT  # the setting that README.md recommends
    sizes = {}  # {mesh: element length}
    has_contact = True
    targets = (0.1, 0.03, 0.01, 0.003, 0.001)  # errors at which settings are compared

    def settings(self, mesh):
        """The settings of all runs on this mesh, which override the program's defaults."""
        return {"wall.elements": counts_of(mesh)}

    def geometry(self, mesh):
        """A mesh that replaces that of the deck, or None."""

    def variants(self, mesh):
        """The settings that run on a mesh."""
        raise NotImplementedError

    def observe(self, run):
        """{name: numbers} of a run, which its record keeps."""
        raise NotImplementedError

    def prepare(self, bench):
        """Computes reference solutions if no exact one is known."""

    def errors(self, observed):
        """{"error": ..., further quantities}."""
        return observed

    def study(self, bench):
        """All points, with the errors of those that finished."""
        self.prepare(bench)
        points = [bench.point(self, mesh, variant) for mesh in self.sizes for variant in self.variants(mesh)]
        for point in points:
            point.errors = {} if point.failure else self.errors(point.record["observed"])
        return points
