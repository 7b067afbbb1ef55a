"""Speed against error: the Pareto front, the cost of an error, the cost of a digit."""
import numpy as np


def settled(points):
    """The points whose error no finer mesh of the same setting exceeds. Other errors are
    accidentally small, since they cross zero."""
    kept = []
    for series in by_setting(points).values():
        largest = 0
        for point in sorted(series, key=lambda p: -p.element_steps):
            largest = max(largest, point.error)
            kept += [point] if point.error == largest else []
    return kept


def front(points, cost):
    """The settled points that no other point beats in both error and cost, in the order of cost."""
    best, kept = np.inf, []
    for point in sorted(settled(points), key=lambda p: (cost(p), p.error)):
        if point.error < best:
            best = point.error
            kept.append(point)
    return kept


def cost_at(series, error, cost):
    """The cost of a setting at an error, by linear interpolation of the logarithms along its
    meshes. None if it is not reached. Since errors may cross zero, the most expensive mesh above
    the error decides."""
    series = sorted(series, key=cost)
    above = [i for i, point in enumerate(series) if point.error > error]
    if not above:
        return cost(series[0])
    if above[-1] + 1 == len(series):
        return None
    a, b = series[above[-1]], series[above[-1] + 1]
    share = np.log(a.error / error) / np.log(a.error / b.error)
    return float(cost(a) * (cost(b) / cost(a))**share)


def error_at(series, cost_of, seconds):
    """The error of a setting at a cost, by the same interpolation; None outside its meshes."""
    series = sorted(series, key=cost_of)
    for a, b in zip(series, series[1:]):
        if cost_of(a) <= seconds <= cost_of(b):
            share = np.log(seconds / cost_of(a)) / np.log(cost_of(b) / cost_of(a))
            return float(a.error * (b.error / a.error)**share)
    return None


def digit_cost(series, cost):
    """The factor of cost for a tenth of the error, by least squares over the meshes."""
    slope = np.polyfit(np.log([point.error for point in series]), np.log([cost(point) for point in series]), 1)[0]
    return float(10**-slope)


def by_setting(points):
    """{setting: points}."""
    families = {}
    for point in points:
        families.setdefault(point.setting, []).append(point)
    return families


def cheapest(points, error, cost):
    """(cost, setting) of the setting that reaches an error at the least cost; None if none does."""
    costs = [(cost_at(series, error, cost), setting.name, setting) for setting, series in by_setting(points).items()]
    costs = sorted(entry for entry in costs if entry[0] is not None)
    return (costs[0][0], costs[0][2]) if costs else None
