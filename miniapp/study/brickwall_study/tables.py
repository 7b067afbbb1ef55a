"""Tables as text for terminals and as Markdown, and numbers with few digits."""
from dataclasses import dataclass, field

WORDS = {"more": "slower", "less": "faster", "same": "in noise", "unknown": "noise unknown"}


@dataclass
class Table:
    """`rows` of texts, the first of each its name. `marks` holds "more" or "less" for cells (row, column) beyond noise.
    `groups` names runs of columns, [(name, number of columns), ...], after the first column."""

    caption: str
    header: list
    rows: list
    marks: dict = field(default_factory=dict)
    groups: list = field(default_factory=list)
    note: str = ""


def counted(count, what):
    """"1 core", "2 cores"."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def number(value, digits=3):
    """A number with about this many digits; "-" for None."""
    if value is None:
        return "-"
    if isinstance(value, int):
        return f"{value:,}"
    if value == 0:
        return "0"
    magnitude = abs(value)
    if magnitude < 1e-3 or magnitude >= 1e7:
        return f"{value:.{digits - 1}e}"
    decimals = max(0, digits - len(str(int(magnitude)))) if magnitude >= 1 else digits - 1 + max(0, -int(f"{magnitude:e}"[-3:]))
    return f"{value:,.{decimals}f}"


def percent(value, digits=2):
    return "-" if value is None else f"{number(100 * value, digits)} %"


def change(ratio):
    """The change from 1 to `ratio`."""
    return f"{100 * (ratio - 1):+.1f} %" if ratio < 10 else f"x {number(ratio)}"


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(cell(value) for value in row) + " |" for row in rows]) + "\n"


def cell(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def table_markdown(table):
    header, names = list(table.header), iter([name for name, columns in table.groups for _ in range(columns)])
    if table.groups:
        header = [header[0]] + [f"{next(names)}: {word}" for word in header[1:]]
    rows = [[f"**{value}**" if (r, c) in table.marks else value for c, value in enumerate(row)] for r, row in enumerate(table.rows)]
    return f"**{table.caption}**\n\n{markdown(header, rows)}" + (f"\n{table.note}\n" if table.note else "")


def table_text(table, width):
    """The table in lines of at most `width` columns: groups that do not fit stand below each other. Cells beyond noise
    end with a star."""
    cells = [[value + ("*" if (r, c) in table.marks else " " if table.marks else "") for c, value in enumerate(row)]
             for r, row in enumerate(table.rows)]
    widths = [max(len(row[c]) for row in [table.header, *cells]) for c in range(len(table.header))]
    groups = [(name, columns) for name, columns in table.groups] or [("", 1)] * (len(table.header) - 1)
    begins, begin = [], 1
    for name, columns in groups:  # a group is as wide as its name
        widths[begin] += max(0, len(name) - sum(widths[begin:begin + columns]) - 2 * (columns - 1))
        begins.append(begin)
        begin += columns
    lines, g = [table.caption], 0
    while g < len(groups):
        shown, room = [], width - widths[0]
        while g < len(groups):
            columns = range(begins[g], begins[g] + groups[g][1])
            room -= sum(widths[c] + 2 for c in columns)
            if room < 0 and shown:
                break
            shown.append((groups[g][0], list(columns)))
            g += 1
        if table.groups:
            lines.append(" " * (2 + widths[0]) + "".join(
                "  " + name.rjust(sum(widths[c] + 2 for c in columns) - 2) for name, columns in shown))
        for row in [table.header, *cells]:
            words = [row[0].ljust(widths[0])] + [row[c].rjust(widths[c]) for _, columns in shown for c in columns]
            lines.append(("  " + "  ".join(words)).rstrip())
        lines.append("")
    return "\n".join(lines[:-1] + ([f"  {table.note}"] if table.note else [])) + "\n"
