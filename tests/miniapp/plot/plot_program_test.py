#!/usr/bin/python3
"""plot_program_test.py BRICKWALL MPIEXEC CMAKE BUILD: brickwall-plot on the output of tiny runs, and on faulty input."""
import contextlib
import io
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, cubes, np, write_results
from brickwall_plot.command import main
from brickwall_plot.exodus import ExodusResults
from brickwall_plot.history_plot import draw_history, draw_phases
from brickwall_plot.run_folder import RunFiles
from brickwall_plot.scene import Scene
from PIL import Image

brickwall, mpiexec, cmake, build = sys.argv[1:5]
work = Path()  # of all tests
SMALL = ["--size", "240x180"]


def brick_run(folder, ranks=1, settings=()):
    """Nine steps of output of a small wall that is struck; with contact."""
    command = [mpiexec, "-n", str(ranks), "--oversubscribe", brickwall, "run", ROOT / "inputs" / "brick_wall.toml", "-o", folder, "-q"]
    for setting in ("wall.bricks=[2,1,3]", "wall.elements=[4,2,2]", "time.end=4e-4", "output.interval=5e-5", "output.history_interval=5e-5",
                    "load.pressure[0].center=[0.2,0,0.2]", *settings):
        command += ["--set", setting]
    subprocess.run(list(map(str, command)), check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                   env=dict(os.environ, OMP_NUM_THREADS="1"))


def plot(*arguments, code=0):
    """The text that the program prints."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        found = main(list(map(str, arguments)))
    if found != code:
        raise AssertionError(f"{arguments}: exit code {found}: {err.getvalue()}")
    return out.getvalue() if code == 0 else err.getvalue()


def picture(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


class Program(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        brick_run(work / "run")
        brick_run(work / "ranks", ranks=2)

    def test_draws_rank_files_as_one_file(self):
        self.assertFalse((work / "ranks" / "brick_wall.exo").exists())
        for name, options in (("a", ["--field", "velocity"]), ("b", ["--field", "stress_yy", "--cut", "x=0.17", "--arrows"])):
            plot(work / "run", "-o", work / f"{name}1.png", *SMALL, *options)
            plot(work / "ranks", "-o", work / f"{name}2.png", *SMALL, *options)
            self.assertTrue(np.array_equal(picture(work / f"{name}1.png"), picture(work / f"{name}2.png")))
        files = [work / "ranks" / f"brick_wall.exo.2.{rank}" for rank in (0, 1)]
        for path in (work / "ranks", work / "ranks" / "brick_wall.exo", files[1]):
            self.assertEqual(RunFiles(path).exodus(), files)

    def test_writes_beside_the_results(self):
        self.assertEqual(plot(work / "run", *SMALL).strip(), str(work / "run" / "brick_wall.png"))
        self.assertTrue((picture(work / "run" / "brick_wall.png") < 250).any())

    def test_lists_steps_and_fields(self):
        text = plot(work / "run", "--list")
        for words in ("steps: 0 to 8, times 0 to 0.0004", "displacement, velocity, force_contact", "contact_gap", "stress_xx", "brick_id"):
            self.assertIn(words, text)

    def test_draws_the_step_nearest_to_a_time(self):
        for name, options in (("step", ["--step", "3"]), ("time", ["--time", "1.6e-4"])):
            plot(work / "run", "-o", work / f"{name}.png", "--view", "-30,20", *SMALL, *options)
        self.assertTrue(np.array_equal(picture(work / "step.png"), picture(work / "time.png")))

    def test_draws_fields_that_the_deck_chooses(self):
        brick_run(work / "chosen", settings=['output.fields=["displacement","contact_pressure","slip_velocity","von_mises"]'])
        results = ExodusResults(work / "chosen" / "brick_wall.exo")
        self.assertGreater(results.nodal("contact_pressure", -1).max(), 0)
        self.assertEqual(results.names["elem"], ["von_mises"])
        for field in ("contact_pressure", "slip_velocity", "von_mises"):
            path = Path(plot(work / "chosen", "-o", work / f"{field}.png", "--field", field, *SMALL).strip())
            self.assertTrue((picture(path) < 250).any())

    def test_animates_with_one_range_of_colours(self):
        plot(work / "run", "-o", work / "all.gif", "--steps", "2:-1:3", "--fps", "5", *SMALL)
        bars = []
        with Image.open(work / "all.gif") as animation:
            self.assertEqual((animation.n_frames, animation.size), (3, (240, 180)))
            for frame in range(3):
                animation.seek(frame)
                bars.append(np.asarray(animation.convert("RGB"))[50:130, 213:218])
        self.assertTrue(np.array_equal(bars[0], bars[1]) and np.array_equal(bars[0], bars[2]))

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_animates_as_mp4(self):
        plot(work / "run", "-o", work / "all.mp4", "--steps", "0:2", "--size", "241x180")
        self.assertEqual((work / "all.mp4").read_bytes()[4:8], b"ftyp")

    def test_plots_history_and_phases(self):
        for option in ("--history", "--phases"):
            self.assertGreater(Path(plot(work / "ranks", option).strip()).stat().st_size, 10000)

    def test_the_stages_add_up_to_the_steps(self):
        report = RunFiles(work / "ranks").report()
        stages = draw_phases(report).axes[0]
        step = next(phase["mean"] for phase in report["phases"] if phase["name"] == "step")
        # "other" holds the small ones, and is left out itself below a thousandth of the loop.
        self.assertAlmostEqual(sum(bar.get_width() for bar in stages.patches), step, delta=1e-3 * report["loop_seconds"])

    def test_ledger_curves_say_that_they_are_of_half_steps(self):
        files = RunFiles(work / "run")
        energies, *_ = axes = draw_history(files.history(), "", files.units("m-kg-s")).axes
        dt = files.history()["timestep"]
        lines = {line.get_label(): line.get_xdata() for line in energies.lines}
        behind = lines["external work"] - lines["total energy, one step earlier"]
        self.assertTrue(np.allclose(behind, 1e6 * np.array(dt), rtol=1e-9))  # microseconds
        self.assertEqual([", at half steps" in one.get_xlabel() for one in axes], [True, True, False, True, True, False, False, False])

    def test_labels_have_the_units_of_the_deck_unless_others_are_chosen(self):
        files = RunFiles(work / "run")
        self.assertEqual(files.units().system, files.report()["units"])
        time = draw_history(files.history(), "", files.units("mm-kg-ms")).axes[0].get_xlabel()
        self.assertEqual(time, "time (ms), at half steps")
        self.assertEqual(draw_history(files.history(), "", files.units("none")).axes[0].get_xlabel(), "time, at half steps")

    def test_is_installed_with_the_program(self):
        subprocess.run([cmake, "--install", build, "--prefix", work / "prefix", "--component", "program"], check=True,
                       stdout=subprocess.DEVNULL)
        text = subprocess.run([work / "prefix" / "bin" / "brickwall-plot", work / "run", "--list"], check=True, capture_output=True).stdout
        self.assertIn(b"displacement", text)

    def test_adds_contact_forces_of_a_side(self):
        # Two cubes press on each other: 4 nodes of each with 1 N, and a shear force on one of them.
        mesh = cubes((0, 0, 0), (0, 0, 1))
        force = np.zeros((1, 16, 3))
        force[0, 4:8, 2], force[0, 8:12, 2], force[0, 8, 0] = -1, 1, 0.5
        path = write_results(work / "pressed.exo", mesh, nodal={f"force_contact_{axis}": force[:, :, i] for i, axis in enumerate("xyz")})
        points, vectors = Scene(ExodusResults(path), "force_contact", arrows="force_contact").vectors(0)
        order = np.argsort(vectors[:, 2])
        self.assertTrue(np.allclose(vectors[order], [[0, 0, -4], [0.5, 0, 4]], rtol=0, atol=1e-15))
        # The middle of the side; a force of sqrt(1.25) at one corner moves it towards that corner.
        weight = np.sqrt(1.25)
        shifted = (1 + 1) / (3 + weight)
        self.assertTrue(np.allclose(points[order], [[0.5, 0.5, 1], [(4 - 2) / (3 + weight), shifted, 1]], rtol=0, atol=1e-15))


class FaultyInput(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        (work / "empty").mkdir()
        cls.file = write_results(work / "one.exo", cubes((0, 0, 0)), times=(0.0, 1.0),
                                 nodal={"displacement_x": np.zeros((2, 8)), "displacement_y": np.zeros((2, 8)),
                                        "displacement_z": [[0] * 8, [np.nan] * 8], "heat": np.ones((2, 8))},
                                 element={"pressure": [[1], [2]], "principal_stress_1": [[1], [2]], "principal_stress_2": [[1], [2]]})

    def expect(self, words, *arguments):
        text = plot(*arguments, code=2)
        self.assertTrue(text.startswith("brickwall-plot: ") and text.count("\n") == 1, text)
        self.assertIn(words, text)

    def test_is_one_message_that_says_what_there_is(self):
        for words, *arguments in (
                ("there is no such file or folder", work / "none"),
                ("no Exodus file (*.exo, *.e) here", work / "empty"),
                ("there is no field heart; there are displacement, heat, pressure", self.file, "--field", "heart", "--step", "0"),
                ("principal_stress has the components principal_stress_1, principal_stress_2; choose one",
                 self.file, "--field", "principal_stress", "--step", "0"),
                ("there is no nodal vector force_contact; there are displacement", self.file, "--arrows", "--step", "0"),
                ("there is no step 2; the steps of the file are 0 to 1", self.file, "--step", "2"),
                ("there is no step -3", self.file, "--step", "-3"),
                ("there is no step at time 1.5; times are 0 to 1", self.file, "--time", "1.5"),
                ("the displacements of step 1 are not finite", self.file),
                ("the cut removes everything; undeformed, the bodies reach from 0,0,0 to 1,1,1", self.file, "--step", "0", "--cut", "x=-1"),
                ("the cut removes nothing; undeformed, the bodies", self.file, "--step", "0", "--cut", "x=7"),
                ('--scale: "nan" is not a finite number', self.file, "--step", "0", "--scale", "nan"),
                ('--time: "inf" is not a finite number', self.file, "--time", "inf"),
                ('--outline: "thick" is not a finite number', self.file, "--outline", "thick"),
                ("this view is along the plane", self.file, "--step", "0", "--cut", "x=0.5", "--view", "front"),
                ("is not x=VALUE", self.file, "--cut", "u=1"),
                ("invalid choice: 'inch' (choose from 'm-kg-s', 'mm-t-s'", self.file, "--units", "inch"),
                ("there is no colour map sunset", self.file, "--step", "0", "--colours", "sunset"),
                ("the suffix must be one of", self.file, "-o", "picture.bmp"),
                ("cannot be written: No such file or directory", self.file, "--step", "0", "-o", work / "none" / "a.png", *SMALL),
                ("--steps needs an animation", self.file, "--steps", "0:1"),
                ("the last step is before the first", self.file, "--steps", "1:0", "-o", work / "a.gif"),
                ("unrecognized arguments: --colour-of-night", self.file, "--colour-of-night"),
                ("history.csv: No such file", self.file, "--history"),
                ("report.json: No such file", self.file, "--phases")):
            with self.subTest(words):
                self.expect(words, *arguments)

    def test_of_a_truncated_file_is_found_at_any_length(self):
        data = Path(self.file).read_bytes()
        for length in (0, 3, 100, len(data) // 2, len(data) - 1):
            (work / "short.exo").write_bytes(data[:length])
            with self.subTest(length):
                self.expect("short.exo: ", work / "short.exo", "--list")
        (work / "other.exo").write_text("no netCDF\n")
        self.expect("other.exo: ", work / "other.exo")

    def test_of_damaged_bytes_never_ends_otherwise(self):
        data, random = Path(self.file).read_bytes(), np.random.default_rng(11)
        for _ in range(60):
            damaged = bytearray(data)
            damaged[random.integers(4, len(data))] = random.integers(256)
            (work / "damaged.exo").write_bytes(damaged)
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                self.assertIn(main([str(work / "damaged.exo"), "--list"]), (0, 2))

    def test_of_missing_rank_files_names_them(self):
        for name in ("part.exo.3.0", "part.exo.3.2"):
            shutil.copy(self.file, work / name)
        self.expect("1 of the 3 files of ranks is missing: part.exo.3.1", work / "part.exo.3.0")
        self.expect("1 of the 3 files of ranks is missing", work / "part.exo")

    def test_of_a_missing_ffmpeg_names_the_package(self):
        with mock.patch("shutil.which", return_value=None):
            self.expect("apt-get install ffmpeg", self.file, "--steps", "0:0", "-o", work / "a.mp4")

    def test_of_history_is_reported_too(self):
        (work / "history.csv").write_text("time,kinetic_energy\n0,1\nx,2\n")
        self.expect("no table of numbers", work / "history.csv", "--history")
        (work / "history.csv").write_text("")
        self.expect("history.csv: is empty", work / "history.csv", "--history")
        (work / "history.csv").write_text("time,kinetic_energy\n0,1\n1\n2,2\n")
        self.expect("line 3 has 1 values, expected 2", work / "history.csv", "--history")
        (work / "history.csv").unlink()

    def test_of_phases_names_what_the_report_lacks(self):
        for text, fault in (("[]", "no report of a run: the schema is null"), ("{}", "no report of a run: the schema is null"),
                            ('{"schema": "brickwall-search-1"}', 'the schema is "brickwall-search-1"'),
                            ('{"schema": "brickwall-report-1"}', "report.json: lacks 'phases'"),
                            ('{"schema": "brickwall-report-1", "phases": 3}', "report.json: a field is of another kind")):
            (work / "report.json").write_text(text)
            self.expect(fault, work, "--phases")
        (work / "report.json").unlink()

    def test_of_a_report_in_other_units_names_those_that_are_known(self):
        (work / "history.csv").write_text("time\n0\n")
        (work / "report.json").write_text('{"schema": "brickwall-report-1", "units": "inch"}')
        self.expect('report.json: units: found "inch", expected one of m-kg-s, mm-t-s', work, "--history")
        (work / "report.json").unlink()
        (work / "history.csv").unlink()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        unittest.main(argv=sys.argv[:1])
