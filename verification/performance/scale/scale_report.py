"""scale.md, scale.csv, scale.json and the plots of the scaling study."""
import csv
import json

import scale_model as model
from brickwall_study.tables import markdown, number, percent

KINDS = {"search": "search", "step": "coupled step, all bricks pressed"}


def ms(values):
    return f"{number(1e3 * values[1])} ({number(1e3 * values[0])} to {number(1e3 * values[2])})"


def measured_table(study):
    measured, rows = study["measured"], []
    for kind, n, ranks, threads, length in sorted(measured.seconds):
        if kind not in KINDS or n == 0:
            continue
        values = measured.triple(kind, n, ranks, threads, length)
        alone = measured.seconds.get((kind, n, 1, 1, 1))
        speed = length * model.triple(alone)[1] / values[1] if alone else None
        wall = f"W({n})" + (f", {length} times as long" if length > 1 else "")
        size = measured.faces if kind == "search" else measured.elements
        rows.append([KINDS[kind], wall, ranks, threads, f"{size[n, length]:,}", ms(values), number(speed),
                     percent(speed / (ranks * threads) if speed else None)])
    return markdown(["", "wall", "ranks", "threads", "faces or elements", "ms", "speed over 1 core", "efficiency"], rows)


def costs_table(study):
    names = {"fixed": "of a search or step, s", "face": "of a face, s", "edge": "of an element edge on a brick's edge, s", "element": "of an element, s", "boundary": "of an item at the boundary, s",
             "latency": "latency of a message, s", "byte": "of a byte, s", "level": "of a level of a reduction, s",
             "contention": "slower if all cores compute, factor"}
    rows = [[text] + [f"{getattr(study['costs'][kind], name)[1]:.3g} ({getattr(study['costs'][kind], name)[0]:.3g} to "
                      f"{getattr(study['costs'][kind], name)[2]:.3g})" for kind in KINDS] for name, text in names.items()]
    return markdown(["cost", *KINDS.values()], rows)


def checks_table(study):
    return markdown(["", "ranks", "faces", "predicted, ms", "measured, ms", "error"],
                    [[KINDS[row["kind"]], row["ranks"], f"{row['faces']:,.0f}", ms(row["predicted"]), ms(row["measured"]),
                      f"{100 * row['error']:+.1f} %"] for row in study["checks"]])


def counted_table(study):
    rows = []
    for (kind, ranks), counts in sorted(study["counted"].items()):
        rows.append([KINDS[kind], ranks] + [number(counts[name][part]) for name, part in (
            ("messages", "max"), ("bytes", "max"), ("reductions", "max"), ("collectives", "max"))] + [f"{counts['ghosts']:,}"])
    return markdown(["", "ranks", "messages", "bytes", "reductions", "other collectives", "ghosts of all ranks"], rows)


def replay_check_table(study):
    return markdown(["ranks", "ghosts a rank", "replayed", "node boxes sent", "replayed", "most partners", "replayed"],
                    [[row["ranks"]] + [number(row[name]) for name in ("ghosts", "replayed_ghosts", "node_boxes", "replayed_node_boxes",
                                                                      "partners", "replayed_partners")] for row in study["replay"]])


def weak_table(study):
    columns = {"scene": "scene", "ranks": "ranks", "tree_messages": "messages of the tree", "tree_bytes": "bytes of the tree, mean",
               "tree_bytes_max": "largest", "box_tests": "box tests, mean", "box_tests_max": "largest", "partners": "partners, mean",
               "partners_max": "largest", "tree_us": "phase 2, us", "boxes_us": "phase 1, us", "candidates_us": "phase 3, us",
               "node_boxes_us": "phase 4, us", "node_boxes_sent": "node boxes", "faces_sent": "faces sent"}
    return markdown(list(columns.values()), [[row[name] for name in columns] for row in sorted(study["weak"], key=lambda r: r["scene"])])


def predicted_table(study):
    rows = []
    for row in study["predicted"]:
        if row["ranks"] in (1, 16, 256, 4096, 65536, 100000):
            parts = " / ".join(f"{100 * row[name] / row['usual_s']:.0f}" for name in model.TERMS)
            rows.append([KINDS[row["kind"]], row["wall"], f"{row['ranks']:,}", ms((row["least_s"], row["usual_s"], row["largest_s"])),
                         f"{row['faces_of_rank']:,.0f}", parts])
    return markdown(["", "wall", "ranks", "ms", "faces of the largest rank", "share of " + " / ".join(model.TERMS) + ", %"],
                    rows)


def spheres_table(study):
    return markdown(["ranks", "rows", "looking boxes a rank", "boxes a rank", "pairs", "ghosts", "node boxes sent", "first search, s",
                     "steady search, s"],
                    [[row["ranks"], row["rows"], f"{row['looking_boxes']:,}", f"{row['boxes']:,}", f"{row['pairs']:,}",
                      f"{row['ghosts']:,}", f"{row['node_boxes_sent']:,}", number(row["first_seconds"]),
                      f"{number(row['steady_seconds']['median'])} ({number(row['steady_seconds']['min'])} to "
                      f"{number(row['steady_seconds']['max'])})"] for row in study["spheres"]])


def draw(folder, study):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"axes.grid": True, "grid.color": "#dddddd", "axes.spines.top": False, "axes.spines.right": False,
                         "legend.frameon": False, "legend.fontsize": 7, "font.size": 9, "axes.axisbelow": True})
    figure, panels = plt.subplots(1, 2, figsize=(12, 5), sharex=True)
    for panel, kind in zip(panels, KINDS):
        walls = list(dict.fromkeys(row["wall"] for row in study["predicted"]))
        for i, wall in enumerate(walls):
            rows = [row for row in study["predicted"] if row["wall"] == wall and row["kind"] == kind]
            ranks, colour = [row["ranks"] for row in rows], plt.cm.viridis(i / max(1, len(walls)))
            usual = [1e3 * row["usual_s"] for row in rows]
            bars = [[1e3 * (row["usual_s"] - row["least_s"]) for row in rows], [1e3 * (row["largest_s"] - row["usual_s"]) for row in rows]]
            panel.errorbar(ranks, usual, yerr=bars, color=colour, marker=".", markersize=4, linewidth=1, capsize=2, label=wall)
            measured = study["measured"]
            points = [case for case in measured.seconds if case[0] == kind and f"W({case[1]})" == wall and case[3:] == (1, 1)]
            panel.plot([case[2] for case in points], [1e3 * measured.triple(*case)[1] for case in points], "x", color=colour)
        panel.set(xscale="log", yscale="log", xlabel="ranks", ylabel=f"ms of a {KINDS[kind].split(',')[0]}", title=KINDS[kind])
    panels[1].legend(ncol=2)
    save(figure, folder / "predicted.png", study)

    figure, panels = plt.subplots(1, 3, figsize=(13, 4))
    for scene in dict.fromkeys(row["scene"] for row in study["weak"]):
        rows = [row for row in study["weak"] if row["scene"] == scene]
        ranks = [int(row["ranks"]) for row in rows]
        for panel, name, title in zip(panels, ("tree_messages", "box_tests", "partners_max"),
                                      ("messages of an exchange of rank boxes", "box tests of a rank in it, mean", "partners, largest rank")):
            panel.plot(ranks, [float(row[name]) for row in rows], marker=".", label=scene)
            panel.set(xscale="log", yscale="log", xlabel="virtual ranks", title=title)
    panels[0].legend()
    save(figure, folder / "replayed.png", study)
    return ["predicted.png", "replayed.png"]


def save(figure, path, study):
    import matplotlib.pyplot as plt

    figure.text(0.01, 0.01, headline(study), fontsize=7, color="#555555")
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    figure.savefig(path, dpi=110)
    plt.close(figure)


def headline(study):
    built, place = study["measured"].versions, study["machine"]
    return (f"{built['cpu']}, {place['physical_cores']} cores, {place['system']}; brickwall {built['commit']}, {built['compiler']}, "
            f"Kokkos {built['kokkos']}, {built['mpi']}; {study['date']}; load average at the start {place['load_average']:.2f}")


def write(folder, study):
    figures = draw(folder, study)
    n = study["counted_wall"]
    sections = [
        "# Scaling, measured and modelled", headline(study) + ".",
        "Times are medians (least to largest) of the turns. `scale_model.py` states the model; README.md in this folder explains it.",
        "![Predicted times](predicted.png)", "## Measured", measured_table(study),
        "## The costs of the model", costs_table(study),
        "## Predictions of runs that are in no fit\n\nThe wall twice as long as the largest one on each number of ranks.", checks_table(study),
        f"## Messages of a rank in a search and in a step\n\nW({n}), the rank that sends most, counted in the program by a library that "
        "stands before MPI.", counted_table(study),
        f"## The replay beside real runs, W({n})\n\nMeans over ranks; of the replay, over the ranks that it builds.", replay_check_table(study),
        "## Virtual ranks, 16 bricks of W(8) each\n\n![Counts](replayed.png)", weak_table(study),
        "## Predicted\n\nErrors are the noise of the measured costs; crosses in the plot are measured.", predicted_table(study),
        "## Touching spheres", spheres_table(study)]
    (folder / "scale.md").write_text("\n\n".join(section.rstrip("\n") for section in sections) + "\n")
    with open(folder / "scale.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, study["predicted"][0].keys())
        writer.writeheader()
        writer.writerows(study["predicted"])
    plain = {name: study[name] for name in ("machine", "date", "messages", "weak", "predicted", "checks", "replay", "spheres")}
    plain["arguments"] = {name: str(value) for name, value in study["arguments"].items()}
    plain["versions"] = study["measured"].versions
    plain["costs"] = {kind: vars(costs) for kind, costs in study["costs"].items()}
    plain["measured"] = [{"kind": kind, "n": n, "ranks": ranks, "threads": threads, "length": length, "seconds": values}
                         for (kind, n, ranks, threads, length), values in study["measured"].seconds.items()]
    plain["counted"] = [{"kind": kind, "ranks": ranks, **counts} for (kind, ranks), counts in study["counted"].items()]
    (folder / "scale.json").write_text(json.dumps({"schema": "brickwall-scale-1", **plain}, indent=1) + "\n")
    return ["scale.md", "scale.csv", "scale.json", *figures]
