"""Hidden surfaces by a depth buffer, in numpy: which triangle is seen at each sample of a picture."""
import numpy as np

TRIANGLES_AT_ONCE, SAMPLES_AT_ONCE = 1 << 15, 1 << 19  # so that arrays stay in the cache


def visible_triangles(corners, width, height):
    """The nearest triangle at each sample [row][column], or -1. Corners are [triangle][corner][x, y, nearness] with
    samples at the integers 0 .. width - 1 and 0 .. height - 1; nearness is affine on a triangle. Common edges leave
    no gap: the rows of both triangles end at the same number."""
    buffer = np.full(width * height, -np.inf)
    seen = np.full(width * height, -1, dtype=np.int32)
    order = np.argsort(-corners[:, :, 2].max(axis=1), kind="stable")  # the nearest first: most others then fail at once
    for first in range(0, len(order), TRIANGLES_AT_ONCE):
        chosen = order[first:first + TRIANGLES_AT_ONCE]
        _draw(buffer, seen, corners[chosen], chosen, width, height)
    return seen.reshape(height, width)


def _draw(buffer, seen, corners, number, width, height):
    triangle, row, low, high = _spans(corners, width, height)
    count = (high - low + 1).astype(np.int64)
    slope_x, slope_y = gradients(corners, corners[:, :, 2])
    start = corners[triangle, 0]
    step = slope_x[triangle]
    nearness = start[:, 2] + step * (low - start[:, 0]) + slope_y[triangle] * (row - start[:, 1])
    place, ends = (row * width + low).astype(np.int64), np.cumsum(count)
    first = 0
    while first < len(count):
        begin = ends[first] - count[first]
        last = max(np.searchsorted(ends, begin + SAMPLES_AT_ONCE), first + 1)
        span = np.repeat(np.arange(first, last), count[first:last])
        along = np.arange(begin, ends[last - 1]) - (ends - count)[span]
        _keep_nearest(buffer, seen, place[span] + along, nearness[span] + step[span] * along, number[triangle[span]])
        first = last


def gradients(corners, values):
    """d/dx and d/dy [triangle] of a field that is affine on triangles; zero on triangles without area."""
    (x1, y1), (x2, y2) = ((corners[:, i, :2] - corners[:, 0, :2]).T for i in (1, 2))
    v1, v2 = (values[:, i] - values[:, 0] for i in (1, 2))
    area = x1 * y2 - x2 * y1
    scale = np.divide(1.0, area, out=np.zeros_like(area), where=area != 0)
    return (v1 * y2 - v2 * y1) * scale, (v2 * x1 - v1 * x2) * scale


def _spans(corners, width, height):
    """Rows of samples inside of triangles: (triangle, row, first column, last column) of each."""
    x, y = corners[:, :, 0], corners[:, :, 1]
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    low_row = np.maximum(np.ceil(y.min(axis=1)), 0)
    rows = (np.minimum(np.floor(y.max(axis=1)), height - 1) - low_row + 1).astype(np.int64)
    rows[(rows < 0) | (area == 0)] = 0
    triangle = np.repeat(np.arange(len(corners)), rows)
    row = low_row[triangle] + np.arange(len(triangle)) - (np.cumsum(rows) - rows)[triangle]
    low, high = np.zeros(len(triangle)), np.full(len(triangle), width - 1.0)
    sign = np.sign(area)
    for i in range(3):
        j = (i + 1) % 3
        # Inside where a x + b y + c >= 0. The neighbour has exactly the negative numbers, thus the same bound.
        a = (y[:, i] - y[:, j]) * sign
        b = (x[:, j] - x[:, i]) * sign
        c = (x[:, i] * y[:, j] - x[:, j] * y[:, i]) * sign
        a, rest = a[triangle], b[triangle] * row + c[triangle]
        bound = np.divide(-rest, a, out=np.zeros_like(rest), where=a != 0)
        low = np.where(a > 0, np.maximum(low, bound), low)
        high = np.where(a < 0, np.minimum(high, bound), high)
        high[(a == 0) & (rest < 0)] = -1
    low, high = np.ceil(low), np.floor(high)
    some = high >= low
    return triangle[some], row[some], low[some], high[some]


def _keep_nearest(buffer, seen, place, nearness, triangle):
    nearer = nearness > buffer[place]
    while nearer.any():
        place, nearness, triangle = place[nearer], nearness[nearer], triangle[nearer]
        buffer[place] = nearness  # one of those at the same place; the loop goes on with those before it
        kept = buffer[place] == nearness
        seen[place[kept]] = triangle[kept]
        nearer = nearness > buffer[place]
