#!/usr/bin/python3
"""study_test.py [BRICKWALL]: brickwall study with a program that stands for the real one, and tiny runs of BRICKWALL."""
import csv
import fcntl
import json
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

from support import HERE, ROOT, FolderTest
from json_schema import faults_of
from brickwall_study import process, study_output
from brickwall_study.problem_size import memory_needed
from brickwall_study.report_command import main as report
from brickwall_study.study_command import main

FAKE = HERE / "fake_brickwall.sh"
DECK = 'title = "A deck"\n[wall]\nbricks = [3, 1, 2]\n'
BRICKWALL = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else None


class StudyTest(FolderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "deck.toml").write_text(DECK)
        launcher = self.folder / "mpiexec"  # mpiexec -n RANKS PROGRAM ...
        launcher.write_text('#!/bin/bash\nshift 2\nexec "$@"\n')
        launcher.chmod(0o755)
        patch = mock.patch.dict(os.environ, {"BRICKWALL_MPIEXEC": str(launcher), "FAKE": str(self.folder)})
        patch.start()
        self.addCleanup(patch.stop)
        self.out = self.folder / "out"

    def study(self, text, *words, code=0):
        """What the study prints."""
        (self.folder / "study.toml").write_text(text)
        return self.command(main, self.folder / "study.toml", "--program", FAKE, "-o", self.out, *words, code=code)[0]

    def calls(self):
        path = self.folder / "calls"
        return path.read_text().splitlines() if path.exists() else []

    def json(self):
        return json.loads((self.out / "study.json").read_text())

    def csv(self):
        with open(self.out / "study.csv", newline="") as file:
            return list(csv.DictReader(file))


TWO_CASES = """
repetitions = 3
warmup = 1
ranks = [1, 2]
oversubscribe = true
[[case]]
name = "one"
deck = "deck.toml"
[[case]]
name = "two"
deck = "deck.toml"
command = "search"
"""


class Order(StudyTest):
    def order(self, seed):
        text = self.study(f"seed = {seed}\n{TWO_CASES}", "--list")
        return [tuple(line.split(maxsplit=1)[1].split(", ")) for line in text.splitlines()]

    def test_each_turn_holds_all_cases_in_an_order_of_its_own(self):
        order = self.order(5)
        turns = [order[i:i + 4] for i in range(0, 16, 4)]
        for turn, name in zip(turns, ("warm-up", "run 1", "run 2", "run 3")):
            self.assertEqual(sorted(turn), [(case, name) for case in ("one_1x1", "one_2x1", "two_1x1", "two_2x1")])
        self.assertGreater(len({tuple(case for case, _ in turn) for turn in turns}), 1)

    def test_the_order_follows_from_the_seed(self):
        self.assertEqual(self.order(5), self.order(5))
        self.assertNotEqual(self.order(5), self.order(6))

    def test_the_order_and_a_seed_that_the_file_does_not_give_are_recorded(self):
        self.study(TWO_CASES)
        data, rows = self.json(), self.csv()
        found = [(run["case"], f"run {run['repetition']}" if run["counted"] else "warm-up") for run in data["runs"]]
        self.assertEqual(found, self.order(data["seed"]))
        self.assertEqual([row["case"] for row in rows], [run["case"] for run in data["runs"] if run["counted"]])
        self.assertEqual([int(row["order"]) for row in rows], list(range(5, 17)))
        folders = {Path(call.split(" -o ")[1].split()[0]).parent.name for call in self.calls()[:4]}
        self.assertEqual(folders, {"one_1x1", "one_2x1", "two_1x1", "two_2x1"})


class Resume(StudyTest):
    def test_a_run_whose_report_was_removed_is_made_again(self):
        self.study(TWO_CASES)
        next(self.out.glob("runs/*/run-1/*report.json")).unlink()
        self.assertEqual(self.study(TWO_CASES).count("(finished before)"), 15)

    def test_an_interrupted_study_continues_without_repeating_finished_runs(self):
        (self.folder / "stop_at").write_text("6")
        (self.folder / "study.toml").write_text(TWO_CASES)
        words = [sys.executable, ROOT / "miniapp/study/brickwall-study", self.folder / "study.toml", "--program", FAKE, "-o", self.out]
        first = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=60)
        self.assertEqual(first.returncode, 5, first.stderr)
        self.assertEqual(first.stdout.splitlines()[-1], "STOPPED: 5 of 16 runs are finished; the same command continues")
        before = self.json()
        self.assertEqual((before["state"], len(before["runs"])), ("interrupted", 5))
        (self.folder / "stop_at").unlink()
        text = self.study(TWO_CASES)
        self.assertEqual(text.count("(finished before)"), 5)
        self.assertEqual(len(self.calls()), 6 + 11)  # the sixth was interrupted
        after = self.json()
        self.assertEqual((after["state"], after["seed"], len(after["runs"])), ("complete", before["seed"], 16))
        self.assertEqual([run["case"] for run in after["runs"][:5]], [run["case"] for run in before["runs"]])
        self.assertEqual(text.splitlines()[-1], "PASS")

    def test_runs_that_have_changed_are_made_again(self):
        text = 'repetitions = 1\nwarmup = 0\n[[case]]\ndeck = "deck.toml"\n'
        self.study(text)
        self.study(text)
        self.assertEqual(len(self.calls()), 1)
        (self.folder / "deck.toml").write_text(DECK + "# changed\n")
        self.study(text)
        self.assertEqual(len(self.calls()), 2)
        self.study(text + 'set = { "time.steps" = 5 }\n')
        self.assertEqual(len(self.calls()), 3)

    def test_two_studies_do_not_write_to_one_folder(self):
        self.out.mkdir()
        with open(self.out / ".lock", "w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            (self.folder / "study.toml").write_text(TWO_CASES)
            self.assertIn("another study", self.fault(main, self.folder / "study.toml", "--program", FAKE, "-o", self.out, code=4))


class Cases(StudyTest):
    def test_sweeps_make_all_combinations(self):
        self.study("""
repetitions = 1
warmup = 0
ranks = [1, 2]
threads = [1, 3]
oversubscribe = true
[set]
time.steps = 20
"load.pressure[0].peak" = 0.0
[sweep]
search.method = ["cluster", "paper"]
search.reuse.margin = [0.0, 0.1]
[[case]]
deck = "deck.toml"
""")
        cases = self.json()["cases"]
        self.assertEqual(len(cases), 16)
        self.assertEqual({(case["ranks"], case["threads"]) for case in cases}, {(1, 1), (1, 3), (2, 1), (2, 3)})
        self.assertEqual({(case["settings"]["search.method"], case["settings"]["search.reuse.margin"]) for case in cases},
                         {("cluster", 0.0), ("cluster", 0.1), ("paper", 0.0), ("paper", 0.1)})
        for call in self.calls():
            self.assertIn("--set time.steps=20 --set load.pressure[0].peak=0.0", call)
            self.assertIn("--set output.interval=0.0", call)

    def test_grow_multiplies_a_number_by_ranks_times_threads(self):
        self.study('repetitions = 1\nwarmup = 0\nranks = [1, 2]\nthreads = [1, 2]\noversubscribe = true\n'
                   '[[case]]\ndeck = "deck.toml"\ngrow = "wall.bricks[0]"\n')
        self.assertEqual({case["case"]: case["settings"]["wall.bricks"][0] for case in self.json()["cases"]},
                         {"deck_1x1": 3, "deck_1x2": 6, "deck_2x1": 6, "deck_2x2": 12})

    def test_sizes_by_share_of_the_memory_are_the_largest_that_fit(self):
        text = 'repetitions = 1\nwarmup = 0\n[[case]]\ndeck = "deck.toml"\ngrow = "wall.bricks[0]"\n'
        # The deck has 3 bricks along: 250 MB, and 150 MB more for each further 3.
        with mock.patch("brickwall_study.machine.memory_bytes", return_value=10e9):
            left_out = self.study(text + "memory = [0.01, 0.025, 0.1, 0.5]\n")
        self.assertEqual([case["settings"]["wall.bricks"] for case in self.json()["cases"]], [[3, 1, 2], [18, 1, 2], [3 * 32, 1, 2]])
        self.assertIn("left out deck_memory=0.01_1x1: the smallest size needs more", left_out)
        # 60 MB on the device for each 3 bricks.
        self.study(text + "memory = [0.5]\ngpu_memory = 1.21e9\n")
        self.assertEqual(self.json()["cases"][0]["settings"]["wall.bricks"], [30, 1, 2])

    def test_layouts_beyond_the_cores_are_left_out_with_the_reason(self):
        text = self.study('repetitions = 1\nranks = [1, 4096]\n[[case]]\ndeck = "deck.toml"\n')
        self.assertIn("left out deck, 4096 x 1: more than the", text)
        self.assertEqual(len(self.json()["left_out"]), 1)

    def test_options_of_the_command_line_replace_ranks_and_threads_of_the_file(self):
        self.study('repetitions = 1\nranks = [1, 2]\noversubscribe = true\n[[case]]\ndeck = "deck.toml"\n', "-n", "3", "-t", "2,4")
        self.assertEqual([case["case"] for case in self.json()["cases"]], ["deck_3x2", "deck_3x4"])

    def test_programs_are_compared(self):
        other = self.folder / "other.sh"
        other.write_text(f'#!/bin/bash\nexec "{FAKE}" "$@"\n')
        other.chmod(0o755)
        self.study(f'repetitions = 1\nwarmup = 0\nprograms = {{ new = "{FAKE}", old = "other.sh" }}\n[[case]]\ndeck = "deck.toml"\n')
        self.assertEqual([case["case"] for case in self.json()["cases"]], ["deck_1x1_new", "deck_1x1_old"])
        self.assertEqual(len({program["sha256"] for program in self.json()["programs"]}), 2)


class Failures(StudyTest):
    def test_a_failed_run_is_recorded_and_the_others_continue(self):
        text = 'repetitions = 1\nwarmup = 0\n[[case]]\nname = "good"\ndeck = "deck.toml"\n' \
               '[[case]]\nname = "bad"\ndeck = "deck.toml"\nset = { fake.fail = true }\n'
        self.assertIn("FAIL: 1 of 2 runs failed", self.study(text, code=3))
        states = {row["name"]: (row["state"], row["message"]) for row in self.csv()}
        self.assertEqual(states, {"good": ("ok", ""), "bad": ("failed", "exit code 3: brickwall: error: it broke")})
        self.assertIn("bad_1x1, run 1: failed", (self.out / "report.md").read_text())
        self.study(text, code=3)
        self.assertEqual(len(self.calls()), 3)  # the failed run is made again

    def test_a_run_without_a_whole_report_has_failed(self):
        self.study('repetitions = 1\nwarmup = 0\n[[case]]\ndeck = "deck.toml"\nset = { fake.torn = true }\n', code=3)
        self.assertIn("no JSON, or a truncated file", self.csv()[0]["message"])

    def test_a_run_beyond_the_limit_is_ended(self):
        self.study('repetitions = 1\nwarmup = 0\nlimit = 0.5\n[[case]]\ndeck = "deck.toml"\nset = { fake.hang = true }\n', code=3)
        self.assertEqual(self.csv()[0]["state"], "out of time")

    def test_faults_of_decks_are_found_together_before_the_first_run(self):
        text = ('ranks = [1, 2]\noversubscribe = true\n[[case]]\nname = "good"\ndeck = "deck.toml"\n'
                '[[case]]\nname = "bad"\ndeck = "deck.toml"\nset = { bad.key = 1 }\n'
                '[[case]]\nname = "worse"\ndeck = "deck.toml"\ncommand = "search"\nsweep = { bad.key = [2, 3] }\n')
        (self.folder / "study.toml").write_text(text)
        for more in ([], ["--list"]):
            words = [self.folder / "study.toml", "--program", FAKE, "-o", self.out, *more]
            out, err = self.command(main, *words, code=2)
            self.assertEqual(out, "")
            self.assertIn("brickwall check refuses 6 of 8 cases", err)
            self.assertIn("bad_1x1 and 5 more: --set bad.key: found unknown key\n", err)
        self.assertEqual(self.calls(), [])
        self.assertFalse(self.out.exists())

    def test_the_folder_of_the_results_is_named_before_the_runs(self):
        text = self.study('repetitions = 1\nwarmup = 0\n[[case]]\ndeck = "deck.toml"\n')
        self.assertEqual(text.splitlines()[0], f"results in {self.out}")

    def test_faulty_files_give_one_clear_error(self):
        case = '[[case]]\ndeck = "deck.toml"\n'
        for text, words in (
                ("", "found no [[case]]"), ("[[case]]\n", 'the key "deck" is missing'), ("case = []\n", "at least one [[case]]"),
                ("repetitions = 0\n" + case, "repetitions is 0, expected an integer from 1"), ("warmup = true\n" + case, "warmup is True"),
                ("repetition = 3\n" + case, 'unknown key "repetition", expected one of'), ("ranks = [1, 1]\n" + case, "ranks is [1, 1]"),
                ("ranks = 2\n" + case, "ranks is 2, expected a list"), ('command = "check"\n' + case, "expected run or search"),
                ('[[case]]\ndeck = "none.toml"\n', "there is no deck"), ('programs = { a = "none" }\n' + case, "there is no program"),
                ("sweep = { time.steps = 3 }\n" + case, "expected a list of values"), (case + case, "there are two cases deck_1x1"),
                (case + 'grow = "wall.none"\n', "has no wall.none"), (case + 'grow = "wall.bricks[9]"\n', "no number at [9]"),
                (case + 'grow = "title[0]"\n', "no number"), (case + "memory = [0.1]\n", 'memory needs the key "grow"'),
                (case + 'grow = "wall.bricks[0]"\nmemory = [2]\n', "a list of shares"),
                ("[wall]\nbricks = [1, 1, 1]\n", "found a deck, expected a study file with [[case]]; brickwall run"),
                ("ranks = [4096]\n" + case, "no case is left"), ("a = [\n", "study.toml: ")):
            (self.folder / "study.toml").write_text(text)
            with self.subTest(text=text):
                self.assertIn(words, self.fault(main, self.folder / "study.toml", "--program", FAKE, "-o", self.out))
        self.assertIn("No such file", self.fault(main, self.folder / "none.toml", "--program", FAKE))


class Processes(FolderTest):
    def test_a_run_out_of_time_gets_a_second_signal_which_ends_its_launcher(self):
        script = 'trap "trap \\"echo ended; exit\\" TERM" TERM; while true; do sleep 0.05; done'  # as run.sh
        with mock.patch.object(process, "PATIENCE", 3):
            self.assertEqual(process.execute(["bash", "-c", script], self.folder / "log", 2)[0], "out of time")
        self.assertIn("ended", (self.folder / "log").read_text())


class Schema(StudyTest):
    def test_the_files_have_the_documented_columns_and_fields(self):
        self.study(TWO_CASES)
        page = (ROOT / "miniapp/study/study.md").read_text()

        def documented(heading):
            section = page.split(f"### {heading}\n", 1)[1].split("\n#", 1)[0]
            return [name for line in section.splitlines() if line.startswith("| `") for name in re.findall(r"`([^`]+)`", line.split("|")[1])]

        columns = list(self.csv()[0])
        fixed = [name for name in columns if ":" not in name]
        self.assertEqual(fixed, list(study_output.COLUMNS))
        self.assertEqual([name for name in documented("study.csv") if ":" not in name], fixed)
        self.assertIn("phase:contact enforcement", columns)
        self.assertIn("set:output.interval", columns)
        data = self.json()
        self.assertEqual(data["schema"], "brickwall-sweep-1")
        self.assertEqual(documented("study.json"), list(data))
        for row in self.csv():
            self.assertAlmostEqual(float(row["seconds_per_step"]), 0.1 if row["command"] == "run" else 0.004)
            self.assertEqual(row["commit"], "0123456789ab")
        for name in ("host", "system", "kernel", "physical_cores", "logical_cpus", "memory_bytes", "load_average", "cpu", "device"):
            self.assertIn(name, data["machine"])
        for name in ("version", "commit", "compiler", "flags", "kokkos", "mpi", "execution_space", "sha256"):
            self.assertTrue(data["programs"][0][name], name)

    def test_only_counted_reports_are_left_and_the_report_finds_them(self):
        self.study(TWO_CASES)
        self.assertEqual(len(list(self.out.rglob("report.json"))), 6)
        self.assertEqual(list(self.out.rglob("*.exo")), [])
        text, _ = self.command(report, self.out, "--markdown")
        self.assertIn("## one: 1,000 elements", text)
        self.assertIn("## two: 2,000 nodes", text)


@unittest.skipUnless(BRICKWALL, "no program was given")
class Program(FolderTest):
    def brickwall(self, *words, code=0):
        done = subprocess.run([BRICKWALL, *map(str, words)], capture_output=True, text=True, cwd=self.folder, timeout=120)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_the_program_starts_study_and_report(self):
        (self.folder / "tiny.toml").write_text(
            f'title = "Tiny"\nrepetitions = 2\nwarmup = 0\n[[case]]\ndeck = "{ROOT}/inputs/one_brick.toml"\nset = {{ time.steps = 20 }}\n')
        lines = self.brickwall("study", "tiny.toml").splitlines()
        self.assertRegex(lines[-2], r"^FOM element_steps_per_second=\S+ case=one_brick_1x1$")
        self.assertEqual(lines[-1], "PASS")
        study = json.loads((self.folder / "out/study_tiny/study.json").read_text())
        self.assertEqual(faults_of(study, "miniapp/study/study.schema.json"), [])
        study["runs"][0]["reuse"] = study["runs"][0].pop("reused")
        self.assertEqual(len(faults_of(study, "miniapp/study/study.schema.json")), 2)
        text = self.brickwall("report", "out/study_tiny", "--html", "page.html")
        self.assertRegex(text, r"1 x 1 +2 +\S+ +- +1.00 +100 %")
        self.assertIn("<svg", (self.folder / "page.html").read_text())
        self.assertIn("no such file", self.brickwall("report", "none", code=2))
        self.assertIn("usage: brickwall study", self.brickwall("study", "-h"))

    def test_check_names_a_device_only_where_there_is_one_and_the_study_reads_its_memory(self):
        deck = ROOT / "inputs/one_brick.toml"
        self.brickwall("run", deck, "-o", "run", "--steps", "1")
        device = json.loads((self.folder / "run/report.json").read_text())["device"]
        self.assertEqual("on the device" in self.brickwall("check", deck), device != "none")
        self.assertGreater(memory_needed("here", BRICKWALL, deck, {}, False), 1e6)


if __name__ == "__main__":
    unittest.main()
