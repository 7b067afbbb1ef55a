"""Comparison of two results files, or of two histories, bit by bit."""
import numpy as np

# Variables of the mesh that are compared. Side sets are not: epu joins those that ranks cut in
# another order. Nor are maps, which only count up.
MESH = ("coord", "connect")


def different_bits(one, other, without=()):
    """(values compared, values whose bits differ) over mesh, times and all result variables of two
    `Results`, except for the global variables named in `without`."""
    count = differing = 0
    for name in one.variables:
        if not (name.startswith(("vals_", *MESH)) or name == "time_whole"):
            continue
        if name not in other.variables:
            return count + 1, differing + 1
        a, b = (np.asarray(results.variables[name][:], dtype=np.float64) for results in (one, other))
        if name == "vals_glo_var":
            kept = [column for column, word in enumerate(one.names["glo"]) if word not in without]
            a, b = a[..., kept], b[..., kept]
        count += a.size
        differing += a.size if a.shape != b.shape else np.count_nonzero(a.view(np.int64) != b.view(np.int64))
    return count, differing


def history_text(path, without=()):
    """The text of a history.csv without some of its columns."""
    lines = path.read_text().splitlines()
    names = lines[0].split(",")
    kept = [column for column, name in enumerate(names) if name not in without]
    return "\n".join(",".join(line.split(",")[column] for column in kept) for line in lines)
