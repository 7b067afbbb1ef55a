"""Finds the files of a run: from its folder, its Exodus file, one of the files of its ranks, or history.csv."""
import csv
import json
import re
from pathlib import Path

from .errors import PlotError
from .units import SI, SYSTEMS, Units

RANK_FILE = re.compile(r"(.+)\.(\d+)\.(\d+)")


class RunFiles:
    """The files of the run at a path: `folder`, and what the methods find in it."""

    def __init__(self, path):
        path = Path(path)
        self.folder = path if path.is_dir() else path.parent
        self._named = None if path.is_dir() or path.suffix in (".csv", ".json") else path
        if not path.exists():
            self._only_ranks(path)  # or an error

    @property
    def base(self):
        """The path of the Exodus file without its suffix, such as out/brick_wall/brick_wall."""
        path = self.exodus()[0]
        match = RANK_FILE.fullmatch(path.name)
        return path.with_name(Path(match[1] if match else path.name).stem)

    def title(self):
        """The title of the run, or the name of its folder."""
        return self.report().get("title", "") if (self.folder / "report.json").exists() else self.folder.resolve().name

    def units(self, chosen=None):
        """The Units that are chosen, or those of the deck; without a report SI."""
        path = self.folder / "report.json"
        system = chosen or (self.report().get("units", SI) if path.exists() else SI)
        if system not in SYSTEMS:
            raise PlotError(f"{path}: units: found {json.dumps(system)}, expected one of {', '.join(SYSTEMS)}")
        return Units(system)

    def exodus(self):
        """The joined file, or the files of all ranks, in the order of ranks."""
        if self._named:
            match = RANK_FILE.fullmatch(self._named.name)
            if match:
                return self._ranks(self._named.with_name(match[1]), int(match[2]))
            return [self._named] if self._named.exists() else self._only_ranks(self._named)
        joined = sorted({path for suffix in ("exo", "e") for path in self.folder.glob(f"*.{suffix}")})
        joined += [path for path in {p.with_name(RANK_FILE.fullmatch(p.name)[1]) for suffix in ("exo", "e")
                                     for p in self.folder.glob(f"*.{suffix}.*.*") if RANK_FILE.fullmatch(p.name)}
                   if path not in joined]
        if len(joined) > 1:
            case = [path for path in joined if path.stem == self._case()]
            if len(case) != 1:
                raise PlotError(f"{self.folder}: which of {', '.join(sorted(p.name for p in joined))}?")
            joined = case
        if not joined:
            raise PlotError(f"{self.folder}: no Exodus file (*.exo, *.e) here")
        return [joined[0]] if joined[0].exists() else self._only_ranks(joined[0])

    def _case(self):
        return self.report().get("case") if (self.folder / "report.json").exists() else None

    def _only_ranks(self, base):
        counts = {int(RANK_FILE.fullmatch(path.name)[2]) for path in base.parent.glob(f"{base.name}.*.*")
                  if RANK_FILE.fullmatch(path.name)}
        if not counts:
            raise PlotError(f"{base}: there is no such file or folder, and no files {base.name}.N.r of ranks")
        if len(counts) > 1:
            raise PlotError(f"{base}: there are files of {' and of '.join(map(str, sorted(counts)))} ranks; name one of them")
        return self._ranks(base, counts.pop())

    def _ranks(self, base, count):
        paths = [base.with_name(f"{base.name}.{count}.{rank:0{len(str(count))}d}") for rank in range(count)]
        missing = [path.name for path in paths if not path.exists()]
        if missing:
            raise PlotError(f"{base}.{count}.*: {len(missing)} of the {count} files of ranks {'is' if len(missing) == 1 else 'are'} missing: {missing[0]}"
                            + (", ..." if len(missing) > 1 else ""))
        return paths

    def report(self):
        path = self.folder / "report.json"
        try:
            report = json.loads(path.read_text())
        except OSError as error:
            raise PlotError(f"{path}: {error.strerror}") from None
        except ValueError as error:
            raise PlotError(f"{path}: no JSON: {error}") from None
        schema = report.get("schema") if isinstance(report, dict) else None
        if schema != "brickwall-report-1":
            raise PlotError(f"{path}: no report of a run: the schema is {json.dumps(schema)}, expected \"brickwall-report-1\"")
        return report

    def history(self):
        """Columns of history.csv: {name: list}. A last row without an end, of a run that was killed, is left out."""
        path = self.folder / "history.csv"
        try:
            text = path.read_text()
            rows = list(csv.reader(text[:text.rfind("\n") + 1].splitlines()))
            if not rows:
                raise PlotError(f"{path}: is empty, expected the names of columns and a row")
            for number, row in enumerate(rows, 1):
                if len(row) != len(rows[0]):
                    raise PlotError(f"{path}: line {number} has {len(row)} values, expected {len(rows[0])}")
            columns = {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
        except OSError as error:
            raise PlotError(f"{path}: {error.strerror}") from None
        except ValueError as error:
            raise PlotError(f"{path}: no table of numbers: {error}") from None
        if not columns.get("time"):
            raise PlotError(f"{path}: no rows with a time")
        return columns
