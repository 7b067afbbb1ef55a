"""Kept reports with round figures, changed and written to folders; the commands with their output."""
import contextlib
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "miniapp" / "study"), str(ROOT / "tests" / "support")]


class FolderTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write_run(self, name, factor=1.0, ranks=1, threads=1, change=None, deck=None):
        """The kept report.json, 100 ms a step on one rank, with all times multiplied by `factor`; `change(report)`
        changes it further, `deck` is the resolved deck beside it."""
        report = json.loads((HERE / "report.json").read_text())
        report.update(ranks=ranks, threads_per_rank=threads, loop_seconds=factor * report["loop_seconds"])
        for phase in report["phases"]:
            phase.update({key: factor * phase[key] for key in ("min", "mean", "max")})
        report["fom"] = {key: value / factor for key, value in report["fom"].items()}
        return self.write(name, "report.json", report, change, deck)

    def write_search(self, name, change=None):
        return self.write(name, "search.json", json.loads((HERE / "search.json").read_text()), change)

    def write(self, name, file, report, change=None, deck=None):
        if change:
            change(report)
        folder = self.folder / name
        folder.mkdir(parents=True)
        (folder / file).write_text(json.dumps(report))
        if deck:
            (folder / f"{report['case']}.resolved.toml").write_text(deck)
        return folder

    def command(self, main, *words, code=0):
        """What a command prints on standard output and error; its exit code must be `code`."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            found = main([str(word) for word in words])
        self.assertEqual(found, code, err.getvalue() + out.getvalue())
        return out.getvalue(), err.getvalue()

    def fault(self, main, *words, code=2):
        """The one line of an error."""
        out, err = self.command(main, *words, code=code)
        self.assertEqual(out, "")
        self.assertEqual(err.count("\n"), 1, err)
        return err


def rows_of(markdown, caption):
    """{first cell: [other cells]} of the table with this caption; header under ""."""
    lines = markdown.split(f"**{caption}", 1)[1].split("\n\n")[1].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {"": cells[0][1:], **{row[0]: row[1:] for row in cells[2:]}}
