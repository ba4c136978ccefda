#!/usr/bin/env python3
"""Runs the whole comparison, small, and looks at what comes of it. Usage: compare_test.py BUILD_FOLDER"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import compare

HERE = pathlib.Path(__file__).resolve().parent
BUILD = None
ZOOM = 1.25


def row(name, rate, border):
    return compare.Row(name, pathlib.Path(name), {"rate_above_1hz_deg_s": rate, "border_share": border})


class BestSetting(unittest.TestCase):
    def test_is_the_steadiest_without_a_border(self):
        best = compare.best_of([row("shaky", 3, 0), row("clean", 2, 0.0005), row("bordered", 1, 0.01)])
        self.assertEqual(best.name, "clean")

    def test_is_the_least_bordered_where_all_are(self):
        best = compare.best_of([row("worst", 1, 0.2), row("least", 3, 0.01)])
        self.assertEqual(best.name, "least")


class WholeRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.output = pathlib.Path(cls.folder.name)
        done = subprocess.run(
            [sys.executable, "-B", HERE / "compare.py", BUILD, cls.output, "--sessions", "walk", "--size", "320x180",
             "--duration", "2", "--zoom", str(ZOOM), "--stabilizers", "hann", "gimbalctl", "perfect", "--json",
             cls.output / "more.json"], check=True, capture_output=True, text=True)
        cls.printed = done.stdout
        cls.figures = json.loads((cls.output / "comparison.json").read_text())["comparison"]["walk"]
        cls.rows = cls.figures["rows"]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_prints_a_line_for_each(self):
        self.assertEqual(set(self.rows), {"Hann", "gimbalctl", "gimbalctl, perfect sensors"})
        for name in self.rows:
            self.assertRegex(self.printed, rf"(?m)^  {re.escape(name)} +\d")

    def test_all_show_the_view_that_was_asked_for(self):
        for name, judgement in self.rows.items():
            self.assertAlmostEqual(judgement["against_original"]["zoom"], ZOOM, delta=0.01, msg=name)
            self.assertEqual(judgement["lost_pairs"], 0, name)
            self.assertEqual(judgement["border_share"], 0, name)

    @unittest.skipIf(compare.best_path is None, "no numpy")
    def test_nobody_beats_the_best_path(self):
        least = self.figures["least_rate_above_1hz_deg_s"]
        self.assertGreater(least, 0)
        for name, judgement in self.rows.items():
            self.assertGreater(judgement["rate_above_1hz_deg_s"], least, name)

    def test_adds_the_figures_to_another_file(self):
        more = json.loads((self.output / "more.json").read_text())
        self.assertEqual(more["comparison"]["walk"]["rows"], self.rows)

    def test_writes_a_page_whose_videos_are_there(self):
        page = (self.output / "index.html").read_text(encoding="utf-8")
        videos = re.findall(r'<video src="([^"]+)"', page)
        self.assertEqual(len(videos), len(self.rows))
        for video in videos:
            self.assertTrue((self.output / video).is_file(), video)
        self.assertEqual(page.count("<polyline"), 3 * len(self.rows))


if __name__ == "__main__":
    BUILD = sys.argv.pop(1)
    unittest.main()
