"""Runs the Python code of docs/recipes.md and docs/python.md at small sizes. tests/robust/cli_documents_test.py runs
their commands, and examples_test.py the examples."""

import contextlib
import io
import os
import pathlib
import re
import sys
import tempfile
import unittest
import unittest.mock

import numpy

import pertev

PROGRAM = os.path.abspath(sys.argv.pop(1))
ROOT = pathlib.Path(__file__).resolve().parents[2]


def blocks_of(document):
    return re.findall(r"```python\n(.*?)```", (ROOT / "docs" / document).read_text(encoding="utf-8"), re.S)


def made_small(text):
    """Returns a block that renders few small pictures with few samples."""
    text = re.sub(r"size=\(\d+, \d+\)", "size=(16, 12)", re.sub(r"spp=\d+", "spp=1", text))
    return text.replace("1000", "3")


class Recipes(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.enterContext(contextlib.chdir(folder))
        self.enterContext(unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}))

    def run_block(self, text, **names):
        """Runs a block and returns the names that it defined and its output."""
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(made_small(text), "block", "exec"), names) # pylint: disable=exec-used
        return names, printed.getvalue()

    def test_recipes_run(self):
        views, figure, notebook = blocks_of("recipes.md")
        self.assertEqual(self.run_block(views)[1], "(3, 12, 16, 3)\n")
        names, printed = self.run_block(figure)
        self.assertEqual(pertev.read("figure.png").shape, (12, 64, 3))
        self.assertEqual([line.split()[0] for line in printed.splitlines()], names["names"])
        self.assertIn(names["pictures"][0].hash, printed)
        names, _ = self.run_block(notebook)
        self.assertEqual(names["scene"].params["materials/white/base_color"].tolist(), [numpy.float32(x) for x in (0.4, 0.6, 0.8)])

    def test_the_code_of_the_python_page_runs(self):
        first, cameras = blocks_of("python.md")
        picture = self.run_block(first)[0]["picture"]
        self.assertEqual(pertev.read("box.png").shape, picture.color.shape)
        poses = numpy.tile(picture.pose @ numpy.diag([1, -1, -1, 1]), (2, 1, 1))
        names, _ = self.run_block(cameras.replace("torch.from_dlpack", "numpy.asarray"), pertev=pertev, numpy=numpy, poses=poses, K=picture.K,
                                  N=2, scene=pertev.load("cornell-box"))
        self.assertEqual((names["tensor"].shape, names["batch"].depth.shape), ((2, 12, 16, 3), (2, 12, 16)))


if __name__ == "__main__":
    unittest.main()
