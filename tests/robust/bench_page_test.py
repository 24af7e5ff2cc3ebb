#!/usr/bin/env python3
"""The page of `pertev bench page` in a real headless Chromium: every file of bench/results is drawn, tables sort, and pictures are
magnified at the same place. Skipped where there is no Chromium."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

from chromium import Chromium, find_chromium
from cli_run import PROGRAM, main, write

if find_chromium() is None:
    print("skipped: no Chromium is here")
    sys.exit(77)

RESULTS = sorted((pathlib.Path(__file__).resolve().parents[2] / "bench/results").glob("*.json"))
PIXELS = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR4nGP4zwAE/wEHAAH/4iOeWQAAAABJRU5ErkJggg=="


def measurement(columns, rows, **more):
    columns = [{"key": key, "title": key, "unit": unit} for key, unit in columns]
    return {"format": "pertev-measurement", "version": 1, "title": "T", "tables": [{"name": "t", "title": "t", "columns": columns, "rows": rows}], **more}


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Chromium().__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.browser.__exit__()

    def show(self, *files):
        """Makes a page of the files or measurements and waits until it is drawn."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        names = []
        for k, one in enumerate(files):
            names.append(pathlib.Path(folder.name, f"{k}.json") if isinstance(one, dict) else one)
            if isinstance(one, dict):
                write(names[-1], json.dumps(one))
        page = pathlib.Path(folder.name, "page.html")
        subprocess.run([PROGRAM, "bench", "page", *names, "-o", page, "-q"], check=True)
        self.browser.errors.clear()
        self.browser.go(page.as_uri())
        self.browser.until(f"document.body.dataset.drawn == '{len(files)}'")

    def values(self, script):
        return json.loads(self.browser.value(f"JSON.stringify({script})"))

    def test_every_result_has_its_tables_and_figures_have_a_plot_or_shading(self):
        self.show(*RESULTS)
        drawn = self.values("[...document.querySelectorAll('main')].map((m) => [m.querySelectorAll('table').length, m.querySelectorAll('.plot').length, "
                            "m.querySelectorAll('td[style]').length])")
        self.assertEqual(self.browser.errors, [])
        self.assertEqual(self.values("[...document.querySelectorAll('svg')].filter((s) => /NaN|Infinity|undefined/.test(s.outerHTML)).length"), 0)
        for path, (tables, plots, shades) in zip(RESULTS, drawn):
            with self.subTest(path=path.name):
                many = [table for table in json.loads(path.read_text(encoding="utf-8"))["tables"] if len(table["rows"]) > 1]
                self.assertEqual(tables, len(many))
                has_figures = any(sum(isinstance(row[i], (int, float)) for row in table["rows"]) > 2 for table in many
                                  for i, column in enumerate(table["columns"]) if i > 0 and column["unit"])
                self.assertTrue(plots + shades > 0 or not has_figures)

    def test_curves_have_fitted_slopes_and_dots_match_the_axis(self):
        self.show(measurement([("samples a pixel", None), ("relMSE", None)], [[n, 8 / n] for n in (1, 2, 4, 8)]))
        self.assertEqual(self.values("[...document.querySelectorAll('.key text')].map((t) => t.textContent)"), ["relMSE  (slope -1.00)"])
        self.assertEqual(self.values("document.querySelectorAll('line.guide').length"), 1)
        self.show(measurement([("job", None), ("ours", "s"), ("theirs", "s")], [["a", 1, 2], ["b", 4, "3 ± 1"]]))
        places = self.values("[...document.querySelectorAll('circle')].map((c) => Number(c.getAttribute('cx')))")
        a, b, c, d = places  # Pertev's rates of a and b, then the others'
        self.assertAlmostEqual((b - a) / 3, c - a, 3)
        self.assertAlmostEqual((b - a) / 3 * 2, d - a, 3)

    def test_a_column_header_sorts_numerically_in_both_directions(self):
        self.show(measurement([("job", None), ("ours", "s")], [["a", 9], ["b", 10], ["c", None]]))
        names = "[...document.querySelectorAll('tbody tr td:first-child')].map((t) => t.textContent)"
        for wanted in (["b", "a", "c"], ["a", "b", "c"]):
            self.browser.value("document.querySelectorAll('th')[1].click()")
            self.assertEqual(self.values(names), wanted)

    def test_pictures_and_their_errors_are_magnified_at_the_same_point(self):
        self.show(measurement([("job", None)], [["a"]], kind="transport",
                              pictures=[{"group": "g", "title": "p", "image": PIXELS, "error": PIXELS}] * 2))
        self.browser.until("[...document.querySelectorAll('.inset')].every((i) => i.style.backgroundPosition)")
        look = "document.querySelectorAll('.view img')[1].dispatchEvent(new MouseEvent('mousemove', {bubbles: true, clientX: %s, clientY: %s}))"
        x, y, width, height = self.values("(() => { const b = document.querySelectorAll('.view img')[1].getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
        self.browser.value(look % (x + 0.75 * width, y + 0.5 * height))
        places = self.values("[...document.querySelectorAll('.inset')].map((i) => i.style.backgroundPosition.match(/[0-9.]+/g).map(Number))")
        self.assertEqual(len(places), 4)
        for right, down in places:  # 90 minus 0.75 of 2 pixels and 0.5 of 1 pixel, magnified 8 times
            self.assertAlmostEqual(right, 78, delta=0.1)
            self.assertAlmostEqual(down, 86, delta=0.1)


if __name__ == "__main__":
    main()
