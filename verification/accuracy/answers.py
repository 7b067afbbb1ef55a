"""The answers of the study from its points: sentences and rows with figures."""
from dataclasses import replace

import numpy as np
from charts import COSTS
from front import by_setting, cheapest, cost_at, digit_cost, error_at, front
from scene import DEFAULT, EVERY_STEP, KEPT, ROW_SUMS

ELEMENT_STEPS, SECONDS = (cost for _, cost in COSTS)
LEAST_RANGE = 3  # smallest ratio of errors that gives an order


def percent(value):
    return f"{100 * value:.3g} %"


def known_points(result):
    """The points whose error is well above the uncertainty of the reference."""
    return [point for point in result.points if point.error > 2 * result.uncertainty]


def bounded_points(result):
    """All points. An error below twice the uncertainty of the reference counts as that, its bound."""
    return [replace(point, errors={**point.errors, "error": max(point.error, 2 * result.uncertainty)}) for point in result.points]


def default_cost(result, error, cost, setting=DEFAULT):
    series = by_setting(bounded_points(result)).get(setting)
    return cost_at(series, error, cost) if series else None


def same_contact(points):
    """The points with edges and the energy-neutral scheme, which other scenes may need."""
    return [point for point in points if not {"contact.edges", "contact.scheme"} & set(dict(point.setting.changes))]


def same_mass(points):
    """The points with the default mass: those with row sums have a wrong inertia."""
    return [point for point in points if "element.mass" not in dict(point.setting.changes)]


def targets(result):
    return [error for error in result.scene.targets if error > 2 * result.uncertainty]


def loss_rows(result):
    """For each error that is reached: the cheapest setting, and the cost of the default relative to
    it."""
    rows, points = [], bounded_points(result)
    for error in (error for error in targets(result) if cheapest(points, error, SECONDS)):
        row = [result.scene.name if not rows else "", percent(error)]
        for among, cost in ((points, SECONDS), (same_contact(points), SECONDS), (points, ELEMENT_STEPS)):
            best, ours = cheapest(among, error, cost), default_cost(result, error, cost)
            row += [best[1].name, f"{best[0]:.3g}", f"{ours / best[0]:.2f}" if ours else "not reached"] if best else ["not reached", "", ""]
        rows.append(row)
    return rows


LOSS_HEADER = ["", "error", "fastest", "s", "default over that", "fastest with edges, energy-neutral", "s", "default over that",
               "fewest element-steps", "element-steps", "default over that"]


def one_percent(result):
    """The fastest setting with an error of 1 %."""
    if not min(result.scene.targets) <= 0.01 <= max(result.scene.targets):
        return f"{result.scene.name}: less than 1 % with all settings and meshes of the study"
    best, ours = cheapest(bounded_points(result), 0.01, SECONDS), default_cost(result, 0.01, SECONDS)
    if best is None:
        return f"{result.scene.name}: no setting on the meshes of the study"
    series = sorted(by_setting(bounded_points(result))[best[1]], key=SECONDS)
    mesh = next((f" (first mesh below 1 %: {point.mesh})" for point in series if point.error <= 0.01), "")
    default = f"the default takes {ours / best[0]:.2f} times as long" if ours else "the default does not reach it"
    return f"{result.scene.name}: {best[1].name}, {best[0]:.3g} s{mesh}; {default}"


def one_digit(result):
    """The cost of a tenth of the error."""
    parts = []
    for label, series in (("along the front", front(known_points(result), SECONDS)),
                          ("with the default", by_setting(known_points(result)).get(DEFAULT, []))):
        errors = [point.error for point in series]
        if len(errors) > 2 and max(errors) > LEAST_RANGE * min(errors):
            parts.append(f"{digit_cost(series, SECONDS):.3g} times the seconds and {digit_cost(series, ELEMENT_STEPS):.3g} times the "
                         f"element-steps {label}")
    return f"{result.scene.name}: " + ("; ".join(parts) or "the range of errors is too small")


def mass_rows(result):
    """For each mesh of the default: its error, and that of row sums of the mass at the same seconds
    and on the same mesh."""
    found = by_setting(result.points)
    ours, old = found.get(DEFAULT, []), found.get(ROW_SUMS[0], [])
    by_mesh, rows = {point.mesh: point for point in old}, []
    for point in ours:
        other, same = error_at(old, SECONDS, point.seconds), by_mesh.get(point.mesh)
        rows.append([result.scene.name if not rows else "", point.mesh, f"{point.seconds:.3g}", percent(point.error),
                     percent(other) if other else "", f"{other / point.error:.2f}" if other else "",
                     *([f"{same.seconds:.3g}", percent(same.error)] if same else ["", ""])])
    return rows


MASS_HEADER = ["", "mesh", "s", "error", "row sums in the same seconds", "that over the error", "row sums on the same mesh: s", "error"]


def reuse_rows(result):
    """For each mesh: the time with kept lists over that with a search in every step, and whether
    the bits are the same."""
    found = {(point.setting, point.mesh): point for point in result.points}
    rows = []
    for mesh in result.scene.sizes:
        base, kept = found.get((EVERY_STEP, mesh)), [found.get((setting, mesh)) for setting in KEPT]
        if base is None or None in kept:
            continue
        rows.append([f"{result.scene.name}, {mesh}", f"{base.seconds:.3g}",
                     *(f"{point.seconds / base.seconds:.3f} ({base.record['searches'] / point.record['searches']:.3g})" for point in kept),
                     "yes" if all(same_course(base, point) for point in kept) else "**NO**"])
    return rows


REUSE_HEADER = ["", "search in every step, s", "margin 0.1: time over that (steps a search)", "margin 0.25", "margin 0.5", "same bits"]


def same_course(one, other):
    return one.record["course"] == other.record["course"] != ""


def changed_by_reuse(results):
    """The number of pairs of runs compared, and the points whose kept lists changed a bit."""
    bases = {(id(result), point.mesh): point for result in results for point in result.points if point.setting == EVERY_STEP}
    kept = [(bases[id(result), point.mesh], point) for result in results for point in result.points
            if point.setting in KEPT and (id(result), point.mesh) in bases]
    return len(kept), [point for base, point in kept if not same_course(base, point)]


def losses(results, choose=lambda points: points, by_rule=False):
    """(default / fastest in seconds, scene, error) for the errors that both reach; `by_rule`: with
    the recommended setting of each scene in place of the default."""
    found = []
    for result in results:
        for error in targets(result):
            best = cheapest(choose(bounded_points(result)), error, SECONDS)
            ours = default_cost(result, error, SECONDS, result.scene.rule if by_rule else DEFAULT)
            if best and ours:
                found.append((ours / best[0], result.scene.name, error))
    return found


def acting(scene, changes):
    """The changes that act in a scene."""
    return tuple(change for change in changes if scene.has_contact or change[0].split(".")[0] not in ("contact", "search"))


def single_rows(results):
    """For each setting that ran in all scenes: its seconds over those of the fastest at the errors of
    losses(), by their median. An error that it does not reach counts as infinite."""
    compared = [(result, error) for result in results for error in targets(result)
                if cheapest(bounded_points(result), error, SECONDS) and default_cost(result, error, SECONDS)]
    series = {id(result): {setting.changes: points for setting, points in by_setting(bounded_points(result)).items()} for result in results}
    rows = []
    for setting in {point.setting.changes: point.setting for result in results for point in result.points}.values():
        ratios, ratios_of_same = [], []
        for result, error in compared:
            ours = series[id(result)].get(setting.changes) or series[id(result)].get(acting(result.scene, setting.changes))
            if not ours:
                break
            seconds = cost_at(ours, error, SECONDS) or np.inf
            ratios.append(seconds / cheapest(bounded_points(result), error, SECONDS)[0])
            ratios_of_same.append(seconds / cheapest(same_contact(bounded_points(result)), error, SECONDS)[0])
        if len(ratios) == len(compared) > 0:
            reached = [ratio for ratio in ratios if ratio < np.inf]
            rows.append([np.median(ratios), setting.name, np.median(ratios_of_same), sum(ratio <= 1.1 for ratio in ratios),
                         max(reached, default=np.inf), len(ratios) - len(reached)])
    return [[row[1], f"{row[0]:.2f}", f"{row[2]:.2f}", row[3], f"{row[4]:.2f}", row[5]] for row in sorted(rows)]


SINGLE_HEADER = ["one setting for all scenes", "median over the fastest", "over the fastest with edges, energy-neutral", "within 10 % of the fastest",
                 "at worst, of errors reached", "errors not reached"]


def rule_text(results):
    return ", ".join(f"{result.scene.name}: {result.scene.rule.name}" for result in results if result.scene.rule != DEFAULT)


def losses_text(found):
    if not found:
        return "nothing to compare"
    within, (loss, name, error) = sum(loss <= 1.1 for loss, _, _ in found), max(found)
    return (f"within 10 % of the fastest at {within} of {len(found)} errors, median {np.median([loss for loss, _, _ in found]):.2f} times "
            f"the seconds, at worst {loss:.3g} times ({name} at {percent(error)})")
