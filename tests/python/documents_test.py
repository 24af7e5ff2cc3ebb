"""The Python code of README.md and docs/ runs, at small sizes, and the names of the module that it mentions exist."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy
import pertev

PROGRAM = sys.argv.pop(1)
ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted(set((ROOT / "docs").glob("*.md")) - {ROOT / "docs" / "recipes.md"})] # recipes_test.py runs its code
# Objects of the reader: three cameras in front of the Cornell box, and NumPy as a library that reads DLPack.
GIVEN = {"N": 3, "K": numpy.array([[100.0, 0, 64], [0, 100, 64], [0, 0, 1]]),
         "poses": numpy.tile(numpy.diag([-1.0, -1, 1, 1]) + numpy.eye(4)[:, :1] @ [[0, 0, 0, 0.278]], (3, 1, 1)), "torch": numpy}


def made_small(code):
    return re.sub(r"spp=\d+", "spp=1", re.sub(r"size=\([^)]*\)", "size=(24, 16)", code))


class Documents(unittest.TestCase):
    def test_code_of_documents_runs(self):
        ran = 0
        for document in DOCUMENTS:
            names = dict(GIVEN) # one document's blocks follow each other
            for code in re.findall(r"(?ms)^```python\n(.*?)^```", document.read_text(encoding="utf-8")):
                with self.subTest(document=document.name, code=code), tempfile.TemporaryDirectory() as folder:
                    home = os.getcwd()
                    os.chdir(folder)
                    try:
                        exec(compile(made_small(code), document.name, "exec"), names) # pylint: disable=exec-used
                    finally:
                        os.chdir(home)
                    ran += 1
        self.assertGreater(ran, 1)

    def test_the_readmes_command_runs(self):
        commands = re.findall(r"(?m)^venv/bin/python -c '(.*)'$", (ROOT / "README.md").read_text(encoding="utf-8"))
        self.assertEqual(len(commands), 1)
        made = subprocess.run([sys.executable, "-c", made_small(commands[0])], check=True, capture_output=True, text=True)
        self.assertGreater(float(made.stdout), 0.01)

    def test_names_of_the_module_in_documents_exist(self):
        found = 0
        for document in DOCUMENTS:
            text = document.read_text(encoding="utf-8")
            end = "" if "```python" in text else r"\(" # in other documents pertev.NAME is also a key of an EXR's metadata
            for name in re.findall(r"(?<![\w./])pertev\.(\w+)" + end, text):
                with self.subTest(document=document.name, name=name):
                    self.assertTrue(hasattr(pertev, name))
                    found += 1
        self.assertGreater(found, 8)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
