#!/usr/bin/python3
"""The arithmetic of the scaling model: sums of its terms, fits that return what the samples were made of, interpolation of counts."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "verification" / "performance" / "scale"))
import scale_model as model


def exactly(value):
    return (value, value, value)


COSTS = model.Costs(fixed=exactly(3.0), face=(1.0, 2.0, 4.0), edge=exactly(0.1), element=exactly(5.0), boundary=exactly(0.5), latency=exactly(7.0),
                    byte=exactly(0.25), level=exactly(11.0), contention=exactly(1.5))


class ScaleModel(unittest.TestCase):
    def test_a_time_is_the_sum_of_counts_times_costs(self):
        counts = model.Counts(ranks=8, faces=10, edges=20, elements=100, boundary=6, messages=4, bytes=80, reductions=2)
        self.assertEqual(model.terms(COSTS, counts), {"compute": 1.5 * (3 + 20 + 2 + 500), "boundary": 3, "latency": 28, "bandwidth": 20,
                                                      "reductions": 11 * 2 * 3})
        low, usual, high = model.seconds(COSTS, counts)
        self.assertEqual((low, high), (usual - 1.5 * 10, usual + 1.5 * 20))

    def test_one_rank_waits_for_nobody(self):
        terms = model.terms(COSTS, model.Counts(ranks=1, faces=10, reductions=2))
        self.assertEqual((terms["compute"], terms["reductions"]), (23, 0))

    def test_costs_are_found_and_are_not_negative(self):
        first, second = model.fit([((x, x * x), 2 * x + 0.5 * x * x) for x in (1, 10, 100)])
        self.assertAlmostEqual(first, 2)
        self.assertAlmostEqual(second, 0.5)
        self.assertEqual(model.fit([((4,), 8)]), (2,))
        self.assertEqual(model.fit([((1, 1), 0.5), ((1, 10), 10)])[0], 0)
        self.assertEqual(model.fit([((1, 1), 2), ((1, 10), 1)])[1], 0)

    def test_noise_stays_in_triples_of_costs(self):
        self.assertEqual(model.fit_triples([((1,), (1, 2, 3)), ((10,), (10, 20, 30))]), ((1, 2, 3),))

    def test_a_triple_is_least_median_and_largest(self):
        self.assertEqual(model.triple([3, 1, 2]), (1, 2, 3))
        self.assertEqual(model.triple([4, 1, 2, 3]), (1, 2.5, 4))

    def test_counts_lie_on_chords_and_follow_the_perimeter_below(self):
        known = {100: 40.0, 400: 20.0, 1600: 10.0}
        self.assertEqual(model.between(known, 400, -0.5), 20)
        self.assertAlmostEqual(model.between(known, 200, -0.5), 40 / 2**0.5)
        self.assertAlmostEqual(model.between(known, 6400, -0.5), 5)
        self.assertAlmostEqual(model.between(known, 25, -0.5), 80)
        self.assertAlmostEqual(model.between({100: 40.0}, 400, -1), 10)
        self.assertEqual(model.between({1: 0.0, 4: 0.0}, 2, -0.5), 0)

    def test_a_search_sends_two_messages_to_each_partner(self):
        row = {"faces": "100", "faces_max_over_mean": "1.5", "partners_max": "8", "node_boxes_sent": "20", "blocks_tested": "5",
               "faces_sent": "10"}
        counts = model.search_counts({64: row}, 64)
        self.assertEqual(counts, model.Counts(64, faces=150, boundary=35, messages=16, bytes=48 * 20 + 240 * 10, reductions=1))
        self.assertEqual(model.search_counts({64: row}, 16).boundary, 70)


if __name__ == "__main__":
    unittest.main()
