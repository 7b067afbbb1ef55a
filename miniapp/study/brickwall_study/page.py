"""A document as one HTML file: no scripts, and nothing is loaded from elsewhere."""
import textwrap
from html import escape

from . import svg, tables
from .tables import Table

STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #222; max-width: 1320px; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.6rem; margin-bottom: 0.3rem; } h2 { font-size: 1.2rem; margin: 2.4rem 0 0.4rem; border-bottom: 2px solid #35124a; }
p { margin: 0.4rem 0; max-width: 62rem; } nav { margin: 0.8rem 0; } nav a { margin-right: 1.2rem; }
a { color: #35124a; } .lead { color: #555; }
.scroll { overflow-x: auto; margin: 0.9rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13.5px; }
caption { text-align: left; white-space: nowrap; font-weight: 600; padding-bottom: 0.25rem; }
th, td { padding: 0.16rem 0.6rem; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0; background: #fff; }
thead th { border-bottom: 1px solid #999; font-weight: 600; } tbody tr:nth-child(even) td { background: #f5f4f7; }
.group { text-align: center; border-bottom: 1px solid #ccc; } .edge { border-left: 1px solid #ccc; }
td.more { color: #a32020; font-weight: 600; } td.less { color: #1d6b2f; font-weight: 600; }
.whole td { font-weight: 600; border-top: 1px solid #ccc; }
.part { padding-left: 1.6rem; }
.charts { display: flex; flex-wrap: wrap; gap: 1.4rem; } figure { margin: 0.6rem 0; flex: 1 1 480px; max-width: 660px; }
figcaption { font-weight: 600; font-size: 13.5px; } svg { width: 100%; height: auto; font: 12px "DejaVu Sans", sans-serif; }
svg text { fill: #333; } .note { color: #555; font-size: 13.5px; }
@media print { body { max-width: none; } .scroll { overflow: visible; } }
"""


def html(document):
    """The text of the page."""
    anchors = [f"s{i}" for i in range(len(document.sections))]
    parts = [f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(document.title)}</title>'
             '<meta name="viewport" content="width=device-width, initial-scale=1">'
             f"<style>{STYLE}</style></head><body>\n<h1>{escape(document.title)}</h1>"]
    parts += [f'<p class="lead">{escape(words)}</p>' for words in document.lead]
    if len(document.sections) > 2:
        parts.append("<nav>" + "".join(f'<a href="#{anchor}">{escape(heading)}</a>'
                                       for anchor, (heading, _) in zip(anchors, document.sections)) + "</nav>")
    for anchor, (heading, blocks) in zip(anchors, document.sections):
        parts.append(f'<h2 id="{anchor}">{escape(heading)}</h2>')
        charts = []
        for block in [*blocks, None]:
            if isinstance(block, (svg.Lines, svg.Bars)):
                charts.append(f"<figure><figcaption>{escape(block.caption)}</figcaption>{svg.draw(block)}</figure>")
                continue
            if charts:
                parts.append(f'<div class="charts">{"".join(charts)}</div>')
                charts = []
            if isinstance(block, Table):
                parts.append(table_html(block))
            elif block is not None:
                parts.append(f"<p>{escape(block)}</p>")
    return "\n".join([*parts, "</body></html>\n"])


def table_html(table):
    begins, column = set(), 1
    for _, columns in table.groups:
        begins.add(column)
        column += columns
    head = ""
    if table.groups:
        names = "".join(f'<th class="group edge" colspan="{columns}">{escape(name)}</th>' for name, columns in table.groups)
        head = f"<tr><th></th>{names}</tr>"
    words = "".join(f"<th{attribute([('edge', c in begins)])}>{escape(word)}</th>" for c, word in enumerate(table.header))
    head += f"<tr>{words}</tr>"
    body = ""
    for r, row in enumerate(table.rows):
        body += f"<tr{attribute([('whole', row[0].startswith('whole '))])}>"
        for c, value in enumerate(row):
            is_part = c == 0 and value.startswith("-") and len(value) > 1
            classes = attribute([("edge", c in begins), ("part", is_part), (table.marks.get((r, c), ""), (r, c) in table.marks)])
            body += f"<td{classes}>{escape(value.lstrip('- ') if is_part else value)}</td>"
        body += "</tr>\n"
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ""
    return (f'<div class="scroll"><table><caption>{escape(table.caption)}</caption><thead>{head}</thead>'
            f"<tbody>\n{body}</tbody></table></div>{note}")


def attribute(classes):
    words = " ".join(word for word, is_on in classes if is_on)
    return f' class="{words}"' if words else ""


def markdown(document):
    parts = [f"# {document.title}\n", *(f"{words}\n" for words in document.lead)]
    for heading, blocks in document.sections:
        parts.append(f"## {heading}\n")
        parts += [tables.table_markdown(block) if isinstance(block, Table) else f"{block}\n"
                  for block in blocks if isinstance(block, (Table, str))]
    return "\n".join(parts)


def plain(document, width):
    def filled(words):
        return textwrap.fill(words, width)

    parts = [document.title, *map(filled, document.lead), ""]
    for heading, blocks in document.sections:
        parts += [heading, "-" * len(heading)]
        parts += [tables.table_text(block, width) if isinstance(block, Table) else f"{filled(block)}\n"
                  for block in blocks if isinstance(block, (Table, str))]
    return "\n".join(parts)
