"""The arithmetic of the scaling model. The time of a step on the rank that has most to do is

    t = k (c0 + c_f F + c_l K + c_e E) + c_b B + m L + b / W + r A log2(P)

F faces and, of a coupled step, E elements and K element edges on edges of bricks, B items at the boundary (blocks tested, node boxes and
faces sent), m messages, b bytes and r reductions are counts of that rank; P is the number of ranks. The
costs c0, c_f, c_l, c_e, c_b, the latency L, the time of a byte 1/W, of a level of a reduction A, and the factor k by
which cores that all compute slow each other down are measured; each has a least, a usual and a largest value.
"""
import math
from dataclasses import dataclass, fields

TERMS = ("compute", "boundary", "latency", "bandwidth", "reductions")
USUAL = 1  # of a triple (least, usual, largest)


@dataclass(frozen=True)
class Costs:
    """Triples (least, usual, largest): seconds, but `contention`, a factor."""

    fixed: tuple
    face: tuple
    edge: tuple
    element: tuple
    boundary: tuple
    latency: tuple
    byte: tuple
    level: tuple
    contention: tuple = (1, 1, 1)

    def at(self, place):
        return {field.name: getattr(self, field.name)[place] for field in fields(self)}


@dataclass(frozen=True)
class Counts:
    """Of the largest rank in a step."""

    ranks: int
    faces: float
    edges: float = 0
    elements: float = 0
    boundary: float = 0
    messages: float = 0
    bytes: float = 0
    reductions: float = 0


def terms(costs, counts, place=USUAL):
    """{term: seconds}."""
    c = costs.at(place)
    levels = math.log2(counts.ranks) if counts.ranks > 1 else 0
    contention = c["contention"] if counts.ranks > 1 else 1
    work = c["fixed"] + c["face"] * counts.faces + c["edge"] * counts.edges + c["element"] * counts.elements
    return {"compute": contention * work, "boundary": c["boundary"] * counts.boundary,
            "latency": c["latency"] * counts.messages, "bandwidth": c["byte"] * counts.bytes,
            "reductions": c["level"] * counts.reductions * levels}


def seconds(costs, counts):
    """(least, usual, largest)."""
    return tuple(sum(terms(costs, counts, place).values()) for place in range(3))


def triple(values):
    """Least, median and largest."""
    ordered = sorted(values)
    middle = len(ordered) // 2
    median = ordered[middle] if len(ordered) % 2 else 0.5 * (ordered[middle - 1] + ordered[middle])
    return ordered[0], median, ordered[-1]


def fit(points):
    """The costs c >= 0 of y = c . x with the least squares of relative errors; x has one or two components."""
    columns = len(points[0][0])
    if columns == 1:
        return (sum(x[0] / y for x, y in points) / sum((x[0] / y) ** 2 for x, y in points),)
    s = [[sum(x[i] * x[j] / y**2 for x, y in points) for j in range(2)] for i in range(2)]
    r = [sum(x[i] / y for x, y in points) for i in range(2)]
    determinant = s[0][0] * s[1][1] - s[0][1] ** 2
    if determinant > 1e-12 * s[0][0] * s[1][1]:
        found = ((r[0] * s[1][1] - r[1] * s[0][1]) / determinant, (s[0][0] * r[1] - s[0][1] * r[0]) / determinant)
        if min(found) >= 0:
            return found
    alone = [fit([((x[i],), y) for x, y in points])[0] for i in range(2)]
    errors = [sum((alone[i] * x[i] / y - 1) ** 2 for x, y in points) for i in range(2)]
    return (alone[0], 0.0) if errors[0] < errors[1] else (0.0, alone[1])


def fit_triples(samples):
    """The costs as triples, from samples [(x, (least, usual, largest))]: a fit to each."""
    found = [fit([(x, values[place]) for x, values in samples]) for place in range(3)]
    return tuple(triple([costs[i] for costs in found]) for i in range(len(found[0])))


def between(known, ranks, exponent):
    """A count at `ranks` from those at other numbers, {ranks: count}: on the chords of the logarithms; below the smallest
    number by the power `exponent` of the ranks, above the largest by the last chord."""
    places = sorted(known)
    if ranks in known:
        return known[ranks]
    if ranks < places[0] or len(places) == 1:
        return known[places[0]] * (ranks / places[0]) ** exponent
    above = next((i for i, place in enumerate(places) if place > ranks), len(places) - 1)
    low, high = places[above - 1], places[above]
    if known[low] <= 0 or known[high] <= 0:
        return known[high]
    slope = math.log(known[high] / known[low]) / math.log(high / low)
    return known[low] * (ranks / low) ** slope


# Of the perimeter of a rank's part of a wall over the ranks, at the same wall; and of its area.
PERIMETER, AREA = -0.5, -1.0
BYTES_OF_BOX, BYTES_OF_FACE = 48, 240  # 6 and 30 words


def search_counts(rows, ranks):
    """Counts of a search from replayed rows {ranks: row} of one wall: two messages to each partner."""
    of = {name: {place: float(row[name]) for place, row in rows.items()} for name in
          ("faces", "faces_max_over_mean", "partners_max", "node_boxes_sent", "blocks_tested", "faces_sent")}
    boxes = between(of["node_boxes_sent"], ranks, PERIMETER)
    sent = between(of["faces_sent"], ranks, PERIMETER)
    return Counts(ranks,
                  faces=between(of["faces"], ranks, AREA) * max(1, between(of["faces_max_over_mean"], ranks, 0)),
                  boundary=between(of["blocks_tested"], ranks, PERIMETER) + boxes + sent,
                  messages=2 * between(of["partners_max"], ranks, 0),
                  bytes=BYTES_OF_BOX * boxes + BYTES_OF_FACE * sent, reductions=1)
