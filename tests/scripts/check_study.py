#!/usr/bin/python3
"""check_study.py FOLDER: checks the files that the study of study_test.sh writes: W(2), 2
repetitions, methods paper and reference, 1 and 2 ranks."""
import csv
import json
import struct
import sys
from pathlib import Path

folder = Path(sys.argv[1])


def check(condition, what):
    if not condition:
        sys.exit(f"wrong: {what}")


with open(folder / "study.csv", newline="") as file:
    rows = list(csv.DictReader(file))
# Two methods, two ranks, two timings; and the first search of shuffled input, of `paper`.
check(len(rows) == 9, f"{len(rows)} rows")
check(sum(int(row["shuffled"]) for row in rows) == 1, "number of shuffled runs")
check({row["method"] for row in rows} == {"paper", "reference"}, "methods")
check({row["state"] for row in rows} == {"ok"}, "states")
for row in rows:
    who = " ".join(row[key] for key in ("method", "ranks", "timing"))
    check(int(row["faces"]) == 17400, f"faces of {who}")
    for part in ("search", "global_search", "local_search"):
        low, middle, high = (float(row[f"{part}_{what}_ms"]) for what in ("min", "median", "max"))
        check(0 < low <= middle <= high, f"{part} of {who}: {low} {middle} {high}")
        check(float(row[f"{part}_imbalance"]) >= 1, f"imbalance of {part} of {who}")
        check(float(row[f"{part}_cpu_mean_ms"]) > 0, f"CPU time of {part} of {who}")
    if row["ranks"] == "1":  # of several ranks, another one may be the slowest in each part
        check(float(row["global_search_min_ms"]) + float(row["local_search_min_ms"]) <= float(row["search_max_ms"]),
              f"parts and whole of {who}")
    check(float(row["first_search_ms"]) > 0, f"first search of {who}")
    check(float(row["memory_inputs_sum_MB"]) > 1, f"memory of the inputs of {who}")
    check(float(row["memory_peak_sum_MB"]) >= float(row["memory_inputs_sum_MB"]), f"peak memory of {who}")
    check(int(row["candidate_pairs"]) > 17400, f"pairs of {who}")
    check((int(row["ghost_faces"]) > 0) == (row["ranks"] == "2"), f"ghosts of {who}")
    check(float(row["timer_node_boxes_mean_ms"]) > 0, f"node boxes of {who}")
    check(bool(row["timer_search_2_cpu_mean_ms"]) == (row["timing"] == "paper"), f"CPU time of timers of {who}")
# The reference tests all pairs of 37,000 nodes and 17,400 faces; a tree tests a few dozen faces a
# node.
slowest = {method: min(float(row["search_median_ms"]) for row in rows if row["method"] == method)
           for method in ("paper", "reference")}
check(slowest["reference"] > 5 * slowest["paper"], f"all pairs are no slower than a tree: {slowest}")

study = json.loads((folder / "study.json").read_text())
check(study["schema"] == "brickwall-study-1" and len(study["runs"]) == 9, "study.json")
check(study["failures"] == [], "failures")
for name in ("commit", "compiler", "kokkos", "mpi", "cpu"):
    check(bool(study["versions"][name]), name)
check(study["machine"]["physical_cores"] >= 1 and study["machine"]["memory_bytes"] > 1e8, "machine")
for run in study["runs"]:
    timers = run["report"]["timers"]
    check(len(timers) == 13, f"timers of {run['name']}")
    parts = {part: run["report"]["seconds"][part]["mean"] for part in ("search", "local_search")}
    total = sum(timer["mean"] for timer in timers) + parts["local_search"]
    check(abs(total - parts["search"]) <= 1e-6 + 1e-3 * parts["search"], f"timers of {run['name']} add up to {total}")

text = (folder / "study.md").read_text()
for part in ("## Times", "## First search", "## Counts", "## The 13 timers", "| 2 | 17,400 | paper | 1 x 1 |"):
    check(part in text, f"study.md lacks {part!r}")
check("## Failed" not in text, "study.md lists failures")
# One thread count gives no plot of thread scaling.
for name in ("fig08_search_time.png", "fig09_migration.png", "fig11_timers.png"):
    check(f"]({name})" in text, f"study.md does not show {name}")
    data = (folder / name).read_bytes()
    check(data[:8] == b"\x89PNG\r\n\x1a\n" and len(data) > 5000, name)
    width, height = struct.unpack(">II", data[16:24])
    check(width > 500 and height > 300, f"size of {name}")
check(not (folder / "fig10_threads.png").exists(), "a plot of one thread count")
print("the files of the study are right")
