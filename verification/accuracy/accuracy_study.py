#!/usr/bin/python3
"""Speed against error: `./run.sh --study accuracy`.

Runs a wall under smooth pulses and cases with exact answers over mesh size, time step, penalty,
element, contact scheme, edges and margin of the search, and writes report.md and plots. A second
call in the same folder reuses the finished runs of the same program. The exit code is 1 if a run
fails, or if kept lists change a bit or miss a pair.
"""
import datetime
import shutil
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from framework.needed import need

need("matplotlib", "netCDF4")
import answers
import charts
import congruent
import study_report
from exact_scenes import Cantilever, SmoothWave, SpinningBlock, TwoBars
from brickwall_study import machine
from brickwall_study.options import positive
from framework.checks import Check
from framework.options import add_run_options, study_parser
from framework.program import Program
from measure import Bench
from walls import PushedWall, StruckWall, Wall, audit, predictability

WALLS = (StruckWall, PushedWall)
SCENES = (*WALLS, TwoBars, SmoothWave, Cantilever, SpinningBlock)
QUICK_SCENES = (StruckWall, TwoBars, SmoothWave)


@dataclass
class Result:
    """A scene, its points, and those whose runs failed."""

    scene: object
    points: list
    broken: list

    @property
    def uncertainty(self):
        return getattr(self.scene, "uncertainty", 0.0)


def parse_arguments():
    parser = study_parser("accuracy", __doc__)
    add_run_options(parser, "accuracy", "few meshes and settings, as in ctest", "copy report.md and plots/ to verification/accuracy")
    parser.add_argument("--repetitions", type=positive, help="timed runs of each point; the least time counts (default 3, quick 1)")
    parser.add_argument("--cpu-time", action="store_true", help="CPU time of the time loop, in place of wall-clock time: other work on the "
                                                                "machine disturbs it less; one thread")
    parser.add_argument("--short", action="store_true", help="walls of 12 elements along a brick at most, and a reference of 4, 8 and 16: a "
                                                             "quarter of the time")
    arguments = parser.parse_args()
    arguments.repetitions = arguments.repetitions or (1 if arguments.quick else 3)
    return arguments


def study_scene(scene, bench):
    points = scene.study(bench)
    return Result(scene, [point for point in points if not point.failure], [point for point in points if point.failure])


def interrupt(*_):
    raise KeyboardInterrupt  # also ends the current run


def checks_of(bench, results, audits):
    compared, changed = answers.changed_by_reuse(results)
    broken = sum(not set(dict(point.setting.changes)) - {"search.reuse.margin"} for result in results for point in result.broken)
    return [Check("runs_that_failed", len(bench.failures), 0, len(bench.failures), 0),
            Check("runs_of_the_default_that_broke_down", broken, 0, broken, 0),
            Check("runs_with_kept_lists", compared, compared, 0 if compared else 1, 0),
            Check("runs_changed_by_kept_lists", len(changed), 0, len(changed), 0),
            Check("missed_pairs", sum(audits.values()), 0, sum(audits.values()), 0)]


def keep(output):
    shutil.copy(output / "report.md", HERE / "report.md")
    shutil.rmtree(HERE / "plots", ignore_errors=True)
    shutil.copytree(output / "plots", HERE / "plots")
    print(f"kept     {HERE / 'report.md'}")


def main():
    arguments = parse_arguments()
    signal.signal(signal.SIGTERM, interrupt)
    place, begin = machine.describe(), time.monotonic()
    program = Program(arguments.run_sh, arguments.program, arguments.ranks, arguments.threads)
    if arguments.quick:
        shutil.rmtree(arguments.output / "runs", ignore_errors=True)  # a test reuses nothing
    bench = Bench(program, arguments.output / "runs", arguments.repetitions, arguments.cpu_time)
    Wall.short = arguments.short
    scenes = [scene(arguments.quick) for scene in (QUICK_SCENES if arguments.quick else SCENES)]
    results = [study_scene(scene, bench) for scene in scenes]
    walls = [scene for scene in scenes if isinstance(scene, WALLS)]
    audits = audit(walls[0], bench)
    growths = {wall.name: predictability(wall, bench, arguments.quick) for wall in walls}
    general = congruent.compare(bench, 4 if arguments.quick else 8 if arguments.short else 16)

    plots = [f"{result.scene.name.replace(' ', '_')}.png" for result in results]
    for result, plot in zip(results, plots):
        charts.draw(result.scene, result.points, arguments.output / "plots" / plot, result.uncertainty)
    charts.draw_masses(results, arguments.output / "plots/masses.png")
    charts.draw_growth(growths, arguments.output / "plots/predictability.png")
    study = {"machine": place, "program": bench.versions, "defaults": bench.defaults, "quick": arguments.quick,
             "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"), "ranks": arguments.ranks,
             "threads": arguments.threads, "repetitions": arguments.repetitions, "cpu_time": arguments.cpu_time,
             "seconds": time.monotonic() - begin}
    study_report.write(arguments.output / "report.md", study, results, growths, general, audits, plots)
    print(f"wrote    {arguments.output / 'report.md'}")
    if arguments.keep:
        keep(arguments.output)
    for failure in bench.failures:
        print(f"FAILED   {failure}")
    checks = checks_of(bench, results, audits)
    for check in checks:
        print(f"{check.name} {'PASS' if check.passed else 'FAIL'} {check.text()}")
    return 0 if all(check.passed for check in checks) else 1


if __name__ == "__main__":
    sys.exit(main())
