#!/usr/bin/python3
"""brickwall report on kept reports with known answers, and on faulty ones."""
import io
import json
import random
import unittest
import xml.etree.ElementTree
from contextlib import redirect_stderr, redirect_stdout
from html.parser import HTMLParser

from support import HERE, FolderTest, rows_of
from brickwall_study.configurations import Sample, compare
from brickwall_study.report_command import main
from brickwall_study.tables import change, number

SPEED, PHASES, IMBALANCE, COUNTS = "Speed", "Phases", "Imbalance", "Counts"


class Tables(FolderTest):
    def report(self, *words):
        return self.command(main, self.folder, "--markdown", *words)[0]

    def repeat(self, name, factors, **how):
        for i, factor in enumerate(factors):
            self.write_run(f"{name}_{i}", factor, **how)

    def test_speed_up_and_efficiency_are_those_of_ranks_times_threads(self):
        self.repeat("a", [1.0, 1.0, 1.0])
        self.repeat("b", [0.25, 0.25, 0.25], ranks=2, threads=4)
        rows = rows_of(self.report(), SPEED)
        self.assertEqual(rows[""], ["runs", "ms a step", "noise", "speed-up", "efficiency", "element steps/s", "change"])
        self.assertEqual(rows["1 x 1"], ["3", "100", "0 %", "1.00", "100 %", "10,000", ""])
        # Four times as fast on eight cores.
        self.assertEqual(rows["2 x 4"], ["3", "25.0", "0 %", "4.00", "50.0 %", "40,000", "**-75.0 %, faster**"])

    def test_on_a_gpu_ranks_alone_count_for_the_efficiency(self):
        gpu = lambda report: report.update(device="a GPU")
        self.write_run("a", 1.0, threads=8, change=gpu)
        self.write_run("b", 0.5, ranks=2, threads=1, change=gpu)
        self.assertEqual(rows_of(self.report(), SPEED)["2 x 1"][3:5], ["2.00", "100 %"])

    def test_efficiency_compares_runs_of_the_same_settings_only(self):
        self.write_run("a", 1.0, deck='search.method = "cluster"\n')
        self.write_run("b", 4.0, deck='search.method = "paper"\n')
        self.write_run("c", 2.0, ranks=2, deck='search.method = "paper"\n')
        rows = rows_of(self.report(), SPEED)
        self.assertEqual(rows["1 x 1, method paper"][3:5], ["0.250", "100 %"])
        self.assertEqual(rows["2 x 1, method paper"][3:5], ["0.500", "100 %"])

    def test_a_restarted_run_is_no_repetition_of_a_whole_one(self):
        self.write_run("a", 1.0, deck="time.steps = 11\n")
        self.write_run("b", 3.0, deck="time.steps = 11\n", change=lambda report: report.update(first_step=6))
        rows = rows_of(self.report(), SPEED)
        self.assertEqual((rows["1 x 1, restart none"][:2], rows["1 x 1, restart at step 6"][:2]), (["1", "100"], ["1", "300"]))
        note = "has timed only the steps since its restart"
        self.assertIn(note, self.report())
        self.assertNotIn(note, self.command(main, self.folder / "b", "--markdown")[0])

    def test_runs_with_options_that_change_the_times_are_no_repetitions(self):
        self.write_run("a", 1.0, deck="time.steps = 11\n")
        self.write_run("b", 3.0, deck="time.steps = 11\n", change=lambda report: report.update(options=["--checksums"]))
        rows = rows_of(self.report(), SPEED)
        self.assertEqual((rows["1 x 1, options none"][:2], rows["1 x 1, options --checksums"][:2]), (["1", "100"], ["1", "300"]))

    def test_changes_beyond_the_noise_of_repetitions_are_marked_and_others_are_not(self):
        # Deviation 1.4826 x 0.01 of each, so that 3 sqrt(2) x 0.014826 = 6.3 % is noise.
        self.repeat("a", [0.99, 1.0, 1.01])
        self.repeat("b", [1.05, 1.06, 1.07], threads=2)
        self.repeat("c", [1.055, 1.065, 1.075], threads=3)
        rows = rows_of(self.report(), SPEED)
        self.assertEqual(rows["1 x 1"][2], "4.4 %")
        self.assertEqual(rows["1 x 2"][6], "+6.0 %, in noise")
        self.assertEqual(rows["1 x 3"][6], "**+6.5 %, slower**")

    def test_two_repetitions_allow_no_statement_on_noise(self):
        self.repeat("a", [1.0, 1.0])
        self.repeat("b", [3.0, 3.0], threads=2)
        rows = rows_of(self.report(), SPEED)
        self.assertEqual(rows["1 x 2"][2], "-")
        self.assertEqual(rows["1 x 2"][6], "+200.0 %, noise unknown")
        self.assertNotIn("Marked", self.report())

    def test_phases_stand_side_by_side_with_time_share_and_change(self):
        self.repeat("a", [1.0] * 3)
        self.repeat("b", [0.5] * 3, ranks=2)
        rows = rows_of(self.report(), PHASES)
        self.assertEqual(rows[""], ["1 x 1: s", "1 x 1: ms", "1 x 1: share", "2 x 1: s", "2 x 1: ms", "2 x 1: share", "2 x 1: change"])
        self.assertEqual(rows["search"], ["0.300", "30.0", "30 %", "0.150", "15.0", "30 %", "**-50.0 %**"])
        self.assertEqual(rows["- pairs"][:3], ["0.200", "20.0", "20 %"])
        # The step lasts 1 s; search, enforcement, force and kick 0.95 s.
        self.assertEqual(rows["other"][:3], ["0.0500", "5.00", "5.0 %"])
        self.assertEqual(rows["whole step"][:3], ["1.00", "100", "100 %"])

    def test_imbalance_is_the_slowest_rank_over_the_mean(self):
        def spread(report):
            next(phase for phase in report["phases"] if phase["name"] == "step::contact enforcement")["max"] = 0.5

        self.write_run("a", ranks=2, change=spread)
        self.assertEqual(rows_of(self.report(), IMBALANCE), {"": ["search", "pairs", "enforcement"], "2 x 1": ["1.00", "1.00", "1.25"]})

    def test_imbalance_of_counts_is_that_of_the_report(self):
        def count(report):
            report["imbalance"] = {"faces": {"max": 12, "mean": 10.0, "max_over_mean": 1.2}}

        self.write_run("a", ranks=2, change=count)
        self.assertEqual(rows_of(self.report(), IMBALANCE)["2 x 1"][-1], "1.20")

    def test_a_field_that_imbalance_needs_and_a_report_lacks_is_named(self):
        def without(report):
            del next(phase for phase in report["phases"] if phase["name"] == "search")["max"]

        self.write_run("a", ranks=2, change=without)
        text = self.report()
        self.assertEqual(rows_of(text, IMBALANCE)[""], ["pairs", "enforcement"])
        self.assertIn('the phase "search" has no field "max"', text)

    def test_counts_energy_error_and_bits(self):
        self.write_run("a")
        self.write_run("b", ranks=2)
        self.write_run("c", ranks=3, change=lambda report: report["checksums"].update(nodes="00000000000000cc"))
        rows = rows_of(self.report(), COUNTS)
        self.assertEqual(rows[""], ["steps", "searches", "ghost faces", "pairs", "contacts", "energy error", "state at the end"])
        self.assertEqual(rows["2 x 1"], ["11", "12", "0", "500", "70", "2.50e-04", "same bits"])
        self.assertEqual(rows["3 x 1"][-1], "differs")

    def test_messages_of_a_step_are_counted_where_reports_state_them(self):
        def sent(report):
            report["imbalance"] = {"messages": {"max": 14, "mean": 12.4, "max_over_mean": 1.13},
                                   "bytes_sent": {"max": 5e6, "mean": 4e6, "max_over_mean": 1.25}}

        self.write_run("a")
        self.write_run("b", ranks=2, change=sent)
        rows = rows_of(self.report(), COUNTS)
        self.assertEqual(rows[""][5:7], ["messages a rank and step", "bytes"])
        self.assertEqual((rows["1 x 1"][5:7], rows["2 x 1"][5:7]), (["-", "-"], ["12", "4,000,000"]))

    def test_runs_of_different_decks_are_told_apart(self):
        self.write_run("a")
        self.write_run("b", 2.0, change=lambda report: report.update(case="other"))
        self.write_search("c")
        text = self.report()
        for heading in ("## wall: 1,000 elements", "## other: 1,000 elements", "## wall: 2,000 nodes, 600 faces (search only)"):
            self.assertIn(heading, text)
        self.assertNotIn("+100.0 %", text)
        self.assertIn("These are 3 problems", text)

    def test_sizes_of_one_deck_give_throughput_and_weak_scaling(self):
        larger = lambda report: report.update(elements=2000)
        self.write_run("a", deck="wall.bricks = [1, 1, 1]\n")
        self.write_run("b", 1.25, ranks=2, change=larger, deck="wall.bricks = [2, 1, 1]\n")
        self.write_run("c", 2.5, change=larger, deck="wall.bricks = [2, 1, 1]\n")
        text = self.report()
        self.assertEqual(rows_of(text, "Weak scaling")["2 x 1"], ["2,000", "1,000", "1", "125", "80.0 %"])
        self.assertIn("| wall, 1 x 1 | 2,000 | 50.0 | 1 | 250 |", text)

    def test_the_memory_of_a_gpu_is_that_in_use_with_its_share(self):
        for i in (1, 2):
            self.write_run(f"a{i}", deck=f"wall.bricks = [{i}, 1, 1]\n", change=lambda report: report.update(
                elements=1000 * i, device="a GPU", device_memory={"bytes": 80000000000, "bytes_in_use": 2000000000 * i}))
        self.assertIn("| wall, 1 x 1 | 2,000 | 4,000 (5.0 %) | 1 |", self.report())

    def test_a_search_has_its_own_phases(self):
        self.write_search("a")
        rows = rows_of(self.report(), PHASES)
        self.assertEqual(rows["ghosts"], ["0.0100", "1.00", "25 %"])
        self.assertEqual(rows["- node boxes"], ["0.00600", "0.600", "15 %"])
        self.assertEqual(rows["whole search"], ["0.0400", "4.00", "100 %"])

    def test_a_run_that_failed_is_named(self):
        self.write_run("a", change=lambda report: report.update({"pass": False, "failures": ["energy error too large"]}))
        self.assertIn("energy error too large", self.report())

    def test_the_terminal_gets_the_same_figures_within_its_width(self):
        self.repeat("a", [1.0] * 3)
        self.repeat("b", [0.25] * 3, ranks=4)
        text, _ = self.command(main, self.folder)
        self.assertRegex(text, r"4 x 1 +3 +25.0 +0 % +4.00 +100 % +40,000 +-75.0 %, faster\*")
        self.assertLessEqual(max(map(len, text.split("How to read this")[0].splitlines())), 120)


class Noise(unittest.TestCase):
    def test_noise_alone_is_rarely_marked(self):
        """report.md: 8, 1.5 and 1.7 % of equal normal samples of 3, 4 and 5 repetitions, by 200,000 trials. Of 4000 trials,
        the share scatters by less than 0.5 % (one standard deviation)."""
        source = random.Random(1)
        for repetitions, most in ((3, 0.10), (4, 0.03), (5, 0.03)):
            def sample():
                return Sample(tuple(source.gauss(0, 1) for _ in range(repetitions)))

            marked = sum(compare(sample(), sample()) in ("more", "less") for _ in range(4000)) / 4000
            self.assertLess(marked, most)

    def test_five_repetitions_that_are_all_slower_are_beyond_noise_however_they_scatter(self):
        fast, slow = (1.7, 2.0, 3.7, 4.1, 4.4), (10.8, 14.8, 14.9, 19.2, 25.3)
        self.assertEqual(compare(Sample(fast), Sample(slow)), "more")
        self.assertEqual(compare(Sample(slow), Sample(fast)), "less")
        self.assertEqual(compare(Sample((*fast[:4], 11.0)), Sample(slow)), "same")
        self.assertEqual(compare(Sample(fast[:4]), Sample(slow)), "same")

    def test_an_outlier_does_not_hide_a_change(self):
        self.assertEqual(compare(Sample((1.0, 1.01, 0.99, 1.0, 9.0)), Sample((2.0, 2.01, 1.99, 2.0, 2.0))), "more")


class Numbers(unittest.TestCase):
    def test_numbers_have_three_digits(self):
        found = [number(value) for value in (0, 1234567, 123456.7, 1234.5, 12.345, 1.2345, 0.12345, 0.0012345, 0.00012345, 1.2345e9, None)]
        self.assertEqual(found, ["0", "1,234,567", "123,457", "1,234", "12.3", "1.23", "0.123", "0.00123", "1.23e-04", "1.23e+09", "-"])

    def test_large_changes_are_factors(self):
        self.assertEqual([change(ratio) for ratio in (1.0, 0.5, 9.99, 12.0)], ["+0.0 %", "-50.0 %", "+899.0 %", "x 12.0"])


class Faults(FolderTest):
    def broken(self, change):
        return self.fault(main, self.write_run("broken", change=change))

    def test_missing_places_and_empty_folders_are_named(self):
        self.assertIn("there is no such file", self.fault(main, self.folder / "none"))
        self.assertIn("no report.json or search.json here or below", self.fault(main, self.folder))

    def test_a_truncated_file_is_named(self):
        path = self.write_run("a") / "report.json"
        path.write_text(path.read_text()[:500])
        self.assertIn(f"{path}: no JSON, or a truncated file", self.fault(main, self.folder))

    def test_a_file_of_another_program_is_refused(self):
        path = self.folder / "report.json"
        for text, words in (("[1]", "the file is no JSON object"), ('{"schema": "x"}', 'the schema is "x"'), ("{}", "the schema is null")):
            path.write_text(text)
            self.assertIn(words, self.fault(main, path))

    def test_a_missing_field_is_named(self):
        self.assertIn('the field "loop_seconds" is missing', self.broken(lambda report: report.pop("loop_seconds")))

    def test_a_missing_phase_is_named(self):
        self.assertIn('the phase "step" is missing', self.broken(lambda report: report.update(phases=[])))

    def test_values_of_another_kind_are_refused(self):
        self.assertIn('the field "ranks" is "two", expected a number', self.broken(lambda report: report.update(ranks="two")))

    def test_a_report_of_no_ranks_is_refused(self):
        self.assertIn('the field "ranks" is 0', self.broken(lambda report: report.update(ranks=0)))

    def test_negative_times_are_refused(self):
        self.assertIn('"loop_seconds" is -1', self.broken(lambda report: report.update(loop_seconds=-1)))

    def test_times_that_are_not_numbers_are_refused(self):
        self.assertIn('"loop_seconds" is NaN', self.broken(lambda report: report.update(loop_seconds=float("nan"))))

    def test_a_run_without_counted_steps_is_refused(self):
        def short(report):
            report["phases"][0]["calls"] = 0

        self.assertIn("no step was timed", self.broken(short))

    def test_a_faulty_deck_beside_the_report_is_named(self):
        self.assertIn("wall.resolved.toml", self.fault(main, self.write_run("a", deck="[")))

    def test_a_page_that_cannot_be_written_is_named(self):
        folder = self.write_run("a")
        (self.folder / "file").write_text("")
        for name in ("file", "none"):  # no folder is made without a word
            self.assertIn("page.html: ", self.fault(main, folder, "--html", self.folder / name / "page.html", code=4))


def places_of(value, place=()):
    """The path of each value inside a JSON value."""
    yield place
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from places_of(inner, (*place, key))


class AnyFault(FolderTest):
    def test_any_wrong_value_gives_a_report_or_one_line(self):
        for name in ("report.json", "search.json"):
            text = (HERE / name).read_text()
            for place in places_of(json.loads(text)):
                for wrong in (None, -1, "x", [], {}):
                    data = json.loads(text)
                    inner = data
                    for key in place[:-1]:
                        inner = inner[key]
                    if place:
                        inner[place[-1]] = wrong
                    (self.folder / name).write_text(json.dumps(data if place else wrong))
                    out, err = io.StringIO(), io.StringIO()
                    with self.subTest(name=name, place=place, wrong=wrong):
                        with redirect_stdout(out), redirect_stderr(err):
                            code = main([str(self.folder), "--html", str(self.folder / "page.html")])
                        self.assertTrue(code == 0 or code == 2 and err.getvalue().count("\n") == 1, err.getvalue())
            (self.folder / name).unlink()


class Balanced(HTMLParser):
    """Checks that tags are closed in order; collects what a browser would load."""

    def __init__(self):
        super().__init__()
        self.open, self.loads = [], []

    def handle_starttag(self, tag, attributes):
        self.loads += [value for name, value in attributes if name in ("src", "href") and not value.startswith("#")]
        if tag not in ("meta",):
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-3:]}"
        self.open.pop()


class Page(FolderTest):
    def test_the_page_is_whole_and_loads_nothing(self):
        for ranks in (1, 2, 4):
            for i in range(3):
                self.write_run(f"{ranks}_{i}", (1 + 0.01 * i) / ranks, ranks=ranks, change=lambda report: report.update(title="<A> & 'B'"))
        self.command(main, self.folder, "--html", self.folder / "page.html")
        text = (self.folder / "page.html").read_text()
        parser = Balanced()
        parser.feed(text)
        self.assertEqual((parser.open, parser.loads), ([], []))
        self.assertNotIn("<script", text)
        self.assertNotIn("url(", text)
        self.assertIn("&lt;A&gt; &amp; &#x27;B&#x27;", text)
        pictures = [part.split("</svg>")[0] for part in text.split("<svg")[1:]]
        self.assertEqual(len(pictures), 2)
        for picture in pictures:
            xml.etree.ElementTree.fromstring(f"<svg{picture}</svg>")
        # Times 1, 1/2, 1/4 lie on the ideal line: each point has the place of the line's corner.
        line = pictures[1].split('<polyline points="')[1].split('"')[0]
        points = [f'{part.split(chr(34))[0]},{part.split("cy=" + chr(34))[1].split(chr(34))[0]}' for part in pictures[1].split('cx="')[1:]]
        self.assertEqual(points, line.split())
        self.assertIn("faster", text)


if __name__ == "__main__":
    unittest.main()
