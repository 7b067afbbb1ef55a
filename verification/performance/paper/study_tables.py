"""The tables of a study of searches: study.csv with one row a run, study.json with all data, the
tables of study.md."""
import csv
import json

from brickwall_study.tables import markdown as markdown_table

TIMERS = ("initialization", "allocation", "host-device copies", "node boxes", "face boxes", "rank-box exchange",
          "partners", "searches 0 and 1", "node-box exchange", "search 2", "waiting", "migration", "other")
PARTS = ("search", "global_search", "local_search")
COUNTS = ("ghost_faces", "candidate_pairs", "node_boxes_sent", "faces_tested", "overlapping_pairs", "most_partners")


def layout(ranks, threads):
    return f"{counted(ranks, 'rank')} x {counted(threads, 'thread')}"


def counted(number, what):
    return f"{number} {what}" + ("" if number == 1 else "s")


def column(timer, what):
    return f"timer_{timer.replace(' ', '_').replace('-', '_')}_{what}_ms"


def row_of(result):
    """A flat row; times in ms of the slowest rank, or the mean over ranks where the column says so.
    Columns that were not measured are empty."""
    case, report = result.case, result.report
    row = {"n": case.n, "faces": None, "nodes": None, "method": case.method, "ranks": case.ranks, "threads": case.threads,
           "timing": case.timing, "shuffled": int(case.shuffled), "state": result.state, "message": result.message,
           "repetitions": case.repetitions, "run_seconds": round(result.seconds, 3)}
    if result.state != "ok":
        return row
    row.update(faces=report["faces"], nodes=report["nodes"], first_search_ms=1e3 * report["first_search_seconds"])
    for part in PARTS:
        if part != "global_search" and not case.local:
            continue  # the whole search includes the local one
        wall, cpu = report["seconds"][part], report["cpu_seconds"][part]
        for figure in ("min", "median", "max"):
            row[f"{part}_{figure}_ms"] = 1e3 * wall[figure]
        row[f"{part}_imbalance"] = wall["imbalance"]
        row[f"{part}_cpu_median_ms"] = 1e3 * cpu["median"]
        row[f"{part}_cpu_mean_ms"] = 1e3 * cpu["mean"]
        row[f"{part}_cpu_imbalance"] = cpu["imbalance"]
    for timer in report["timers"]:
        row[column(timer["name"], "median")] = 1e3 * timer["median"]
        row[column(timer["name"], "mean")] = 1e3 * timer["mean"]
        if "cpu_seconds" in timer:  # with --timing paper
            row[column(timer["name"], "cpu_mean")] = 1e3 * timer["cpu_seconds"]["mean"]
    row.update({count: report["counts"][count] for count in COUNTS if case.local or count != "candidate_pairs"})
    for what in ("peak", "inputs", "search"):
        row[f"memory_{what}_sum_MB"] = 1e-6 * report["memory"][what]["sum_bytes"]
        row[f"memory_{what}_max_rank_MB"] = 1e-6 * report["memory"][what]["max_rank_bytes"]
    return row


def disagreements(rows):
    """Runs of one wall must have the same counts for all methods and threads; the pairs also for
    all numbers of ranks."""
    faults = []
    for count, equal in (("ghost_faces", ("n", "ranks", "repetitions")), ("candidate_pairs", ("n", "repetitions"))):
        found = {}
        for row in rows:
            if row.get(count) is not None:
                found.setdefault(tuple(row[key] for key in equal), {}).setdefault(row[count], []).append(
                    f"{row['method']} {row['ranks']}x{row['threads']}")
        for key, values in found.items():
            if len(values) > 1:
                found_text = "; ".join(f"{value}: {', '.join(sorted(set(who)))}" for value, who in values.items())
                faults.append(f"W({key[0]}): {count} differ: {found_text}")
    return faults


def write_csv(path, rows):
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)


def write_json(path, study, results):
    runs = [{"name": r.case.name(), **vars(r.case), "state": r.state, "message": r.message, "reused": r.reused,
             "run_seconds": r.seconds, "report": r.report} for r in results]
    with open(path, "w") as file:
        json.dump({**study, "runs": runs}, file, indent=1)
        file.write("\n")


def number(value):
    if value is None or value == "":
        return "-"
    return f"{value:,}" if isinstance(value, int) else f"{value:.3g}" if abs(value) < 100 else f"{value:,.0f}"


def spread(row, part):
    if row.get(f"{part}_median_ms") is None:
        return "-"
    return " / ".join(number(row[f"{part}_{what}_ms"]) for what in ("min", "median", "max"))


def times_table(rows):
    header = ["W(n)", "faces", "method", "ranks x threads", "whole search, ms (min / median / max)", "global search, ms",
              "CPU of a rank: whole, ms", "global, ms", "imbalance of it", "search memory, MB"]
    cpu = {key(row): row for row in rows if row["timing"] == "paper"}
    lines = []
    for row in (r for r in rows if r["timing"] == "normal" and not r["shuffled"]):
        busy = cpu.get(key(row), {})
        lines.append([row["n"], number(row["faces"]), row["method"], f"{row['ranks']} x {row['threads']}",
                      spread(row, "search"), spread(row, "global_search"), number(busy.get("search_cpu_mean_ms")),
                      number(busy.get("global_search_cpu_mean_ms")), number(busy.get("global_search_cpu_imbalance")),
                      number(row["memory_search_sum_MB"])])
    return markdown_table(header, lines)


def key(row):
    return row["n"], row["method"], row["ranks"], row["threads"]


def first_table(rows):
    lines = [[row["n"], number(row["faces"]), row["method"], f"{row['ranks']} x {row['threads']}",
              number(row["first_search_ms"]), number(row["search_median_ms"])] for row in rows if row["shuffled"]]
    return markdown_table(["W(n)", "faces", "method", "ranks x threads", "first search, ms", "later ones, ms"], lines)


def counts_table(rows):
    lines = [[row["n"], row["method"], row["ranks"], *(number(row.get(count)) for count in COUNTS)]
             for row in rows if row["timing"] == "normal" and not row["shuffled"]]
    unique = list(dict.fromkeys(map(tuple, lines)))
    return markdown_table(["W(n)", "method", "ranks", *(count.replace("_", " ") for count in COUNTS)], unique)


def timers_table(rows):
    """Wall-clock and CPU time of the runs with --timing paper, mean over ranks and searches."""
    lines = [[f"W({r['n']}) {r['method']} {r['ranks']} x {r['threads']}",
              *(f"{number(r[column(timer, 'mean')])} ({number(r[column(timer, 'cpu_mean')])})" for timer in TIMERS)]
             for r in rows if r["timing"] == "paper"]
    return markdown_table(["ms: wall clock (CPU)", *TIMERS], lines)
