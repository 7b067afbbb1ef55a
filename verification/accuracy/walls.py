"""The wall under smooth pulses: errors of the bricks' motion relative to an extrapolated reference,
and the time up to which the wall is predictable."""
import numpy as np
from bricks import at_times, bodies_of, means_of_bodies
from brickwall_study import machine
from scene import COMBINED, DEFAULT, FEW, FULL, HERE, NO_EDGES, PENALTIES, PLAIN, REUSE, ROW_SUMS, SOFT_AND_LONG, STEPS, Scene, counts_of

DENSITY, HEIGHT, PEAK = 2000.0, 0.1, 4.0e6  # of decks/wall.toml
# The reference has short steps and stiff contact, since the compliance of the joints is the larger
# part of the error. Kept lists change no bit.
REFERENCE = {"contact.penalty": 0.75, "time.safety": 0.5, "search.reuse.margin": 0.25}


class Wall(Scene):
    """A wall whose bricks above the fixed base course count."""

    deck = HERE / "decks/wall.toml"
    short = False  # whether meshes end at 12 elements along a brick, those of the reference at 16

    def __init__(self, quick):
        counts = (2, 4) if quick else (2, 4, 6, 8, 12, 16)[:5 if self.short else 6]
        self.sizes = {mesh_name(n): 0.2 / n for n in counts}
        self.quick = quick

    def variants(self, mesh):
        n = counts_of(mesh)[0]
        if self.quick:
            return [DEFAULT, FEW[2], FULL, *REUSE, ROW_SUMS[0]]
        if n == 16:
            return [*FEW, *REUSE, FULL, *ROW_SUMS[:2]]
        if n in (6, 12):
            return [*FEW, *ROW_SUMS[:2]]
        return [DEFAULT, *STEPS, *PENALTIES, *SOFT_AND_LONG, FULL, PLAIN, NO_EDGES, *REUSE, *COMBINED, *ROW_SUMS]

    def observe(self, run):
        results, history = run.results, run.history
        parts = bodies_of(results, DENSITY)
        moving = [results.nodes[nodes, 2].min() > 0.5 * HEIGHT for nodes in parts[0]]
        mass = np.array([masses.sum() for masses in parts[1]])[moving]
        steps = range(len(results.times))
        speeds = [np.linalg.norm(means_of_bodies(results, "velocity", step, parts)[moving], axis=1).max() for step in steps]
        momentum = mass[:, None] * means_of_bodies(results, "velocity", -1, parts)[moving]
        gaps = np.concatenate([results.nodal("contact_gap", step)[results.nodal("contact_status", step) > 0] for step in steps])
        depths = np.maximum(-gaps, 0)
        observed = {
            "displacement": means_of_bodies(results, "displacement", -1, parts)[moving].tolist(),
            "momentum": momentum.tolist(), "peak_velocity": [max(speeds)],
            "energy_error": history["energy_error"][-1], "momentum_error": history["momentum_error"][-1],
            "max_penetration": history["max_penetration"].max(),
            "rms_penetration": np.sqrt(np.mean(depths[depths > 0]**2)) / element_length(results),
            "hourglass_share": history["hourglass_energy"].max() / history["internal_energy"].max(),
            "lost_contacts": history["lost_contacts"][-1]}
        if "missed_pairs" in history:
            observed["missed_pairs"] = history["missed_pairs"][-1]
        return {name: value if isinstance(value, list) else float(value) for name, value in observed.items()}

    def prepare(self, bench):
        counts = (2, 4, 8) if self.quick else (4, 8, 16) if self.short else (8, 16, 32)
        cores = 1 if self.quick or bench.probe else machine.physical_cores() // bench.program.ranks
        records = [bench.needed(self, mesh_name(n), f"reference_{n}", REFERENCE, 1, max(1, cores)) for n in counts]
        self.reference_mesh = mesh_name(counts[-1])
        self.reference = {name: Reference([np.array(record["observed"][name]) for record in records])
                          for name in ("displacement", "momentum", "peak_velocity")}

    def errors(self, observed):
        figures = {name: value for name, value in observed.items() if name not in self.reference}
        displacement, momentum, peak = (self.reference[name].value for name in ("displacement", "momentum", "peak_velocity"))
        return {"error": rms(np.array(observed["displacement"]) - displacement) / rms(displacement),
                "impulse_error": float(np.linalg.norm(np.array(observed["momentum"]) - momentum, axis=1).sum()
                                       / np.linalg.norm(momentum, axis=1).sum()),
                "peak_velocity_error": float(abs(observed["peak_velocity"] - peak)[0] / peak[0]), **figures}

    @property
    def uncertainty(self):
        """The uncertainty of the reference, as an error."""
        return rms(self.reference["displacement"].uncertainty) / rms(self.reference["displacement"].value)


class StruckWall(Wall):
    name = "struck wall"
    text = ("Bricks on a fixed base course, pushed from the front by a smooth pulse and struck from above by another "
            "(`decks/wall.toml`). Error: root mean square over the bricks of the error of the centres' displacements at 2 ms, over that of "
            "the reference's displacements. The courses press each other and rebound, so the compliance of the joints matters.")
    rule = STEPS[0]
    targets = (0.1, 0.05, 0.03, 0.02, 0.01)


class PushedWall(Wall):
    name = "pushed wall"
    text = ("The same without the blow from above, as in `inputs/brick_wall.toml`: bricks turn, and push each other aside.")
    targets = (0.05, 0.03, 0.02, 0.01, 0.005)

    def settings(self, mesh):
        return {**super().settings(mesh), "load.pressure[1].peak": 0.0}


class Reference:
    """A reference from three meshes at ratio 2: Richardson's extrapolation with the observed order
    if that is near 1, otherwise the finest mesh, with the last difference as its uncertainty."""

    def __init__(self, values):
        coarse, middle, fine = values
        last = fine - middle
        self.order = float(np.log2(np.linalg.norm(middle - coarse) / np.linalg.norm(last)))
        self.extrapolated = 0.7 <= self.order <= 1.3
        self.value = fine + last / (2**self.order - 1) if self.extrapolated else fine
        self.uncertainty = self.value - fine if self.extrapolated else last


def predictability(wall, bench, quick):
    """The growth of a relative change of 1e-12 in the peak of the push, beside the error: {times,
    change, error, t*}. The error is the difference to the mesh of twice the element length. t* is
    None if the change stays below a tenth of it."""
    fine, coarse, end = (mesh_name(4), mesh_name(2), 4e-3) if quick else (mesh_name(8), mesh_name(4), 40e-3)
    times = np.linspace(0, end, 101)
    long = {"time.end": end, "output.interval": end / 100, "output.history_interval": end / 100}
    changed = {**long, "load.pressure[0].peak": PEAK * (1 + 1e-12)}
    runs = [bench.needed(wall, mesh, label, settings, 1, observe=observe_course)["observed"]
            for mesh, label, settings in ((fine, f"{fine}_long", long), (fine, f"{fine}_changed", changed), (coarse, f"{coarse}_long", long))]
    course, other, coarser = (at_times(np.array(run["times"]), np.array(run["displacement"]), np.array(run["velocity"]), times)
                              for run in runs)
    change, error = rms_by_time(course - other), rms_by_time(course - coarser)
    grown = np.flatnonzero((change > 0.1 * error) & (times > 0))
    return {"mesh": fine, "times": times, "change": change, "error": error, "size": rms_by_time(course),
            "time": float(times[grown[0]]) if len(grown) else None}


def audit(wall, bench):
    """{margin of kept lists: pairs that the lists missed}, compared with all pairs in every tenth
    step."""
    mesh = mesh_name(4 if wall.quick else 8)
    missed = {}
    for variant in (DEFAULT, *REUSE):
        changes = {**dict(variant.changes), "search.audit": 10}
        observed = bench.needed(wall, mesh, f"audit_{variant.name}", changes, 1)["observed"]
        missed[variant.name] = observed["missed_pairs"]
    return missed


def observe_course(run):
    parts = bodies_of(run.results)
    return {"times": run.results.times.tolist(),
            **{name: [means_of_bodies(run.results, name, step, parts).tolist() for step in range(len(run.results.times))]
               for name in ("displacement", "velocity")}}


def rms(values):
    """Root mean square over bricks of vectors [brick][xyz]."""
    return float(np.sqrt((values**2).sum(axis=-1).mean()))


def rms_by_time(values):
    return np.sqrt((values**2).sum(axis=-1).mean(axis=-1))


def mesh_name(n):
    return f"{n}x{n // 2}x{n // 2}"


def element_length(results):
    corners = results.nodes[results.hexes[0]]
    return np.linalg.norm(corners[1] - corners[0])
