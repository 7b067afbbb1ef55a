"""Writes report.md: answers first, then a section for each scene."""
import answers
import numpy as np
from front import by_setting
from brickwall_study.tables import cell
from framework.report import headline, table
from scene import DEFAULT


def settings_table(result, mesh):
    """All settings on one mesh."""
    points = sorted((point for point in result.points if point.mesh == mesh), key=lambda point: (point.error, point.seconds))
    names = list(dict.fromkeys(name for point in points for name in point.errors))
    rows = [[f"**{point.setting.name}**" if point.setting == DEFAULT else point.setting.name, f"{point.element_steps:.4g}",
             f"{point.seconds:.3g}", *(cell(point.errors.get(name, "")) for name in names)] for point in points]
    return table(["setting", "element-steps", "s", *(name.replace("_", " ") for name in names)], rows)


def mesh_table(result):
    """The errors of each setting on all meshes."""
    meshes = list(result.scene.sizes)
    rows = []
    for setting, series in by_setting(result.points).items():
        errors = {point.mesh: answers.percent(point.error) for point in series}
        rows.append([f"**{setting.name}**" if setting == DEFAULT else setting.name, *(errors.get(mesh, "") for mesh in meshes)])
    return table(["error", *meshes], rows)


def middle_mesh(result):
    """The mesh with the most settings; of several, the finest."""
    counts = {mesh: sum(point.mesh == mesh for point in result.points) for mesh in result.scene.sizes}
    return max(counts, key=lambda mesh: (counts[mesh], -result.scene.sizes[mesh]))


def reference_text(scene):
    reference = getattr(scene, "reference", None)
    if reference is None:
        return ""
    lines = [f"- {name.replace('_', ' ')}: order {value.order:.2f}, "
             + ("extrapolated" if value.extrapolated else "outside 0.7 to 1.3, so the finest mesh itself")
             + f"; uncertainty {answers.percent(np.linalg.norm(value.uncertainty) / np.linalg.norm(value.value))}\n"
             for name, value in reference.items()]
    return (f"Reference: three meshes at ratio 2, the finest {scene.reference_mesh}, with the same penalty and share of the stable step "
            "(penalty 0.75, 0.5 of the stable step; Richardson with the observed order):\n\n" + "".join(lines)
            + "\nErrors below twice the uncertainty are drawn; in the answers they count as twice the uncertainty, or not at all.\n")


def broken_text(result):
    lines = [f"- {point.setting.name}, {point.mesh}: {point.failure}\n" for point in result.broken]
    return "Failed, and not in the tables:\n\n" + "".join(lines) if lines else ""


def section(result, plot):
    mesh = middle_mesh(result)
    return "\n".join([f"## {result.scene.name.capitalize()}\n\n{result.scene.text}\n", reference_text(result.scene),
                      f"![{result.scene.name}](plots/{plot})\n", mesh_table(result), broken_text(result), f"On {mesh}:\n", settings_table(result, mesh)])


def growth_text(growths):
    lines = []
    for name, growth in growths.items():
        share = (growth["change"][1:] / growth["error"][1:]).max()
        result = (f"t* = {1e3 * growth['time']:.3g} ms" if growth["time"] else
                f"t* lies beyond {1e3 * growth['times'][-1]:.3g} ms; up to then the change is at most {share:.1e} of the error")
        lines.append(f"- {name}, {growth['mesh']}: {result}.\n")
    return ("## Predictability of the wall\n\nThe peak of the push is changed by a relative 1e-12. At t* the displacements of the bricks "
            "have changed by a tenth of the error (the difference to the mesh of twice the element length).\n\n"
            + "".join(lines) + "\n![growth](plots/predictability.png)\n")


def answers_text(study, results, general, audits):
    def listed(sentence):
        return "".join(f"- {sentence(result)}.\n" for result in results)

    compared, changed = answers.changed_by_reuse(results)
    reuse = [row for result in results for row in answers.reuse_rows(result)]
    losses = [row for result in results for row in answers.loss_rows(result)]
    default = ", ".join(f"{key} = {str(value).lower()}" for key, value in study["defaults"].items())
    parts = [f"## Answers\n\nThe default is {default}.\n",
             f"**Which setting reaches 1 % fastest?**\n\n{listed(answers.one_percent)}",
             f"**What does one digit more cost?**\n\n{listed(answers.one_digit)}",
             f"**What does the default lose against the front?** Compared with all settings it is "
             f"{answers.losses_text(answers.losses(results))}; compared with those with edges and the energy-neutral scheme "
             f"{answers.losses_text(answers.losses(results, answers.same_contact))}; compared with those of these with the default mass "
             f"{answers.losses_text(answers.losses(results, lambda points: answers.same_mass(answers.same_contact(points))))}; "
             "compared with all with the default mass "
             f"{answers.losses_text(answers.losses(results, answers.same_mass))}.\n\n"
             f"With the recommended setting of each scene ({answers.rule_text(results)}; the default elsewhere) the first is "
             f"{answers.losses_text(answers.losses(results, by_rule=True))}; the second "
             f"{answers.losses_text(answers.losses(results, answers.same_contact, by_rule=True))}.\n\n"
             + table(answers.LOSS_HEADER, losses),
             "**Which single setting is the fastest?** Seconds over those of the fastest setting at the same errors; an error that is not "
             "reached counts as infinite. Keys of contact do not act in scenes without.\n\n"
             + table(answers.SINGLE_HEADER, answers.single_rows(results)),
             "**What do nodal masses with the inertia of the bodies gain?** The default beside `element.mass = \"row_sum\"`.\n\n"
             + table(answers.MASS_HEADER, [row for result in results for row in answers.mass_rows(result)])
             + "\n![fronts of both masses](plots/masses.png)\n",
             f"**What does reuse of lists gain at zero error?** Of {compared} runs with kept lists, {len(changed)} differ in a bit of the history or "
             f"of the fields from a run with a search in every step. {audit_text(audits)}\n\n" + table(answers.REUSE_HEADER, reuse),
             "**What does the congruent path gain at zero error?** The same wall with an inner node of each brick shifted by 1e-10 of an "
             f"edge takes the general path. It needs {general['elements']:.2f} times the time for the elements' forces and "
             f"{general['loop']:.2f} times that of the whole loop; displacements differ by {general['difference']:.1e} of their size.\n"]
    return "\n".join(parts)


def audit_text(audits):
    missed = sum(audits.values())
    return f"Compared with all pairs in every tenth step of {len(audits)} runs, the lists missed {missed:g} pairs."


def write(path, study, results, growths, general, audits, plots):
    head = (f"# Speed against error\n\nWritten by `./run.sh --study accuracy --keep`. {headline(study)}; load average at the start "
            f"{study['machine']['load_average']:.2f}; {'CPU ' if study['cpu_time'] else ''}seconds are those of the time loop, least of {study['repetitions']} runs. "
            f"{study['seconds']:.0f} s.{' The quick form.' if study['quick'] else ''}\n")
    path.write_text("\n".join([head, answers_text(study, results, general, audits),
                               *(section(result, plot) for result, plot in zip(results, plots)), growth_text(growths)]))
