"""Plots of history.csv over time (columns: miniapp/output.md), and of the phases in report.json."""
import numpy as np

from .style import COLOURS, new_figure

TOTAL = "total energy, one step earlier"
# Panels: title, quantity, logarithmic, {column or vector: label}. Columns that a run lacks, or that are zero throughout, are
# left out, and components below a thousandth of the largest.
PANELS = (
    ("Energy balance", "energy", False, {"external_work": "external work", "total_energy": TOTAL, "kinetic_energy": "kinetic",
                                    "internal_energy": "internal", "dissipated_energy": "dissipated"}),
    ("Stored and dissipated energies", "energy", True, {
        "internal_energy": "internal", "hourglass_energy": "hourglass, part of internal", "contact_energy": "contact",
        "friction_energy": "friction springs", "edge_energy": "edge contact", "dissipated_energy": "dissipated"}),
    ("Error measures: largest difference over scale, so far", "", True, {"energy_error": "energy", "stored_error": "stored energy",
                                                  "contact_error": "contact energy", "momentum_error": "momentum",
                                                  "angular_momentum_error": "angular momentum"}),
    ("Momentum and impulses", "momentum", False, {"momentum": "momentum", "impulse_load": "loads", "impulse_gravity": "gravity",
                                             "impulse_reaction": "reactions", "impulse_damping": "damping"}),
    ("Angular momentum", "angular momentum", False, {"angular_momentum_x": "x", "angular_momentum_y": "y", "angular_momentum_z": "z"}),
    ("Contacts", "", False, {"contacts": "under load", "lost_contacts": "lost since the start",
                             "missed_pairs": "missed pairs since the start"}),
    ("Largest penetration over face size", "", True, {"max_penetration": ""}),
    ("Length of the step", "time", False, {"timestep": ""}),
)
STYLES = {"external work": {"color": "#c9c4be", "linewidth": 5.0}, TOTAL: {"color": "#1a1717", "linestyle": "--"}}


def draw_history(columns, title, units):
    """The figure of {column: list}."""
    figure, panels = new_figure(4, 2, (11, 13))
    columns = {name: np.array(values) for name, values in columns.items()}
    factor, unit = units.scaled("time", columns["time"].max())
    time_label = f"time ({unit})" if unit else "time"
    time = columns["time"] * factor
    half = columns["timestep"] / 2 * factor if "timestep" in columns else 0 * time
    for axes, (name, quantity, logarithmic, lines) in zip(panels, PANELS):
        drawn, is_ledger = _lines(columns, lines), quantity not in ("", "time")
        largest = max((abs(v).max() for v, *_ in drawn), default=0)
        scale, axis_unit = (1, units.of(quantity)) if logarithmic else units.scaled(quantity, largest)
        for values, label, style in drawn:
            # The ledger is that of the half step after t, but its total energy that of the one before (miniapp/output.md).
            shift = 0 * half if not is_ledger else -half if label == TOTAL else half
            axes.plot(time + shift, np.where(values > 0, values, np.nan) if logarithmic else values * scale, label=label, **style)
        if logarithmic and drawn:
            axes.set_yscale("log")
        elif drawn and min(values.min() for values, *_ in drawn) >= 0:
            axes.set_ylim(0, 1.05 * scale * max(values.max() for values, *_ in drawn))
        axes.set_title(name, fontsize=11, loc="left")
        axes.set(xlabel=time_label + ", at half steps" * is_ledger, ylabel=axis_unit)
        if time[-1] > time[0]:
            axes.set_xlim(time[0], time[-1])
        if not drawn:
            axes.text(0.5, 0.5, "none in this run", transform=axes.transAxes, ha="center", color="#8a8a8a")
        elif any(label for _, label, _ in drawn):
            axes.legend(frameon=False, fontsize=8)
    figure.suptitle(title, fontsize=13, weight="semibold", x=0.02, ha="left")
    figure.tight_layout(rect=(0, 0, 1, 0.985))
    return figure


def _lines(columns, lines):
    """[(values, label, style)]; the components of a vector have one colour."""
    drawn, vectors = [], 0
    for column, label in lines.items():
        if column in columns:
            if columns[column].any():
                drawn.append((columns[column], label, STYLES.get(label, {})))
        elif f"{column}_x" in columns:
            drawn += [(columns[f"{column}_{axis}"], f"{label} {axis}", {"color": COLOURS[vectors % len(COLOURS)], "linestyle": style})
                      for axis, style in zip("xyz", ("-", "--", ":"))]
            vectors += 1
    largest = max((abs(values).max() for values, *_ in drawn), default=0)
    return [line for line in drawn if "linestyle" not in line[2] or abs(line[0]).max() > 1e-3 * largest]


def draw_phases(report):
    """The figure of report.json: times of the stages of a step, and of the search."""
    figure, panels = new_figure(1, 2, (12, 5.5))
    phases, loop = {phase["name"]: phase for phase in report["phases"]}, report["loop_seconds"]
    stages = [dict(phase, name=name[6:]) for name, phase in phases.items() if name.startswith("step::")]
    stages += [phases["search"]] if "search" in phases else []
    step = phases.get("step", {"mean": loop})["mean"]
    stages = [stage for stage in stages if stage["max"] > 1e-3 * loop]
    other = max(0.0, step - sum(stage["mean"] for stage in stages))
    stages.append({"name": "other", "mean": other, "min": other, "max": other})
    search = report["search_timers"] + [dict(phases[name], name=name[8:]) for name in ("search::local search",) if name in phases]
    for axes, entries, title in ((panels[0], stages, "Stages of a step"), (panels[1], search, "The search")):
        entries = sorted((entry for entry in entries if entry["max"] > 1e-3 * loop), key=lambda entry: entry["mean"])
        mean, low, high = (np.array([entry[key] for entry in entries]) for key in ("mean", "min", "max"))
        places = np.arange(len(entries))
        axes.barh(places, mean, color="#d1603d", height=0.68)
        if report["ranks"] > 1:
            axes.errorbar(mean, places, xerr=[mean - low, high - mean], fmt="none", ecolor="#35124a", capsize=2, linewidth=1)
        for place, value, end in zip(places, mean, high):
            axes.text(end, place, f"  {value:.3g} s, {100 * value / loop:.1f} %", va="center", fontsize=8)
        axes.set_yticks(places, [entry["name"] for entry in entries], fontsize=9)
        axes.grid(False, axis="y")
        axes.set_xlim(0, 1.3 * high.max(initial=1e-3 * loop))
        axes.set_title(title, fontsize=11, loc="left")
        axes.set_xlabel("time (s), mean over ranks" + ("; lines from the least to the largest" if report["ranks"] > 1 else ""))
    figure.suptitle(f"{report['title']}: {report['elements']:,} elements, {report['steps']:,} steps, {report['ranks']} x "
                    f"{report['threads_per_rank']} ranks x threads, {loop:.4g} s", fontsize=12, weight="semibold", x=0.02, ha="left")
    figure.tight_layout(rect=(0, 0, 1, 0.97))
    return figure
