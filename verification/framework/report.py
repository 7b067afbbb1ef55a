"""The report of a study: one table of all cases, then a section for each case with its tables,
plots and notes."""
from brickwall_study.tables import markdown as table


def headline(study):
    place, built = study["machine"], study["program"]
    cores = f"{place['physical_cores']} core{'s' * (place['physical_cores'] != 1)}"
    return (f"{built.get('cpu', 'unknown processor')}, {cores}, {place['system']}; brickwall "
            f"{built.get('version', '?')}, commit {built.get('commit', '?')}, {built.get('compiler', '?')}, Kokkos "
            f"{built.get('kokkos', '?')} {built.get('execution_space', '')}, {built.get('mpi', '?')}; {study['date']}; "
            f"{study['ranks']} rank(s) with {study['threads']} thread(s) each, unless a case says otherwise")


def case_row(outcome):
    verdict = "pass" if outcome.passed else "**FAIL**"
    if outcome.failure or not outcome.checks:
        return [outcome.name, outcome.title, "", "", "", "", "", f"{verdict}: {outcome.failure or 'no check'}"]
    first, held = outcome.checks[0], sum(check.passed for check in outcome.checks)
    return [outcome.name, outcome.title, *figures(first), f"{held} of {len(outcome.checks)}", verdict]


def check_row(outcome, check):
    return [check.name.replace("_", " ") or outcome.title, *figures(check), ", ".join(f"{order:.2f}" for order in check.orders),
            "pass" if check.passed else "**FAIL**"]


def figures(check):
    return [f"{check.computed:.6g}", f"{check.exact:.6g}", f"{check.error:.2g}", f"{check.threshold:.2g}"]


def section(outcome):
    parts = [f"## {outcome.name}: {outcome.title}\n\n{outcome.text}\n",
             table(["check", "computed", "exact", "error", "threshold", "observed orders", ""],
                   [check_row(outcome, check) for check in outcome.checks])]
    parts += [f"{caption}\n\n{table(header, rows)}" for caption, header, rows in outcome.tables]
    parts += [f"![{caption}](plots/{file})\n\n*{caption}*\n" for file, caption in outcome.figures]
    parts += [f"{note}\n" for note in outcome.notes]
    return "\n".join(parts + [f"{outcome.seconds:.0f} s.\n"])


def write(path, study, outcomes):
    passed = sum(outcome.passed for outcome in outcomes)
    parts = [f"# {study['title']}\n\nWritten by `./run.sh --study {study['name']} --keep`: {passed} of {len(outcomes)} cases "
             f"pass{' in their quick forms' if study['quick'] else ''}, in {study['seconds']:.0f} s. {headline(study)}.\n",
             table(["case", "", "computed", "exact", "error", "threshold", "checks", ""], map(case_row, outcomes))]
    published = [line for outcome in outcomes for line in outcome.published]
    if published:
        parts.append("## Published figures\n\n" + table(["quantity", "computed", "published", "source"], published))
    weak_spots = [f"- {outcome.name}: {text}" for outcome in outcomes for text in outcome.weak_spots]
    if weak_spots:
        parts.append("## Weak spots of the method\n\n" + "\n".join(weak_spots) + "\n")
    path.write_text("\n".join(parts + [section(outcome) for outcome in outcomes]))
