"""The program `pertev` of this package: the command that pip writes calls main(). It loads the module alone, neither the
package around it nor NumPy."""

import glob
import importlib.machinery
import importlib.util
import os
import sys


def main():
    """Runs the program and ends the process."""
    # The package's folder may be a link, so the module is looked for beside the link.
    beside = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "pertev")
    endings = tuple(importlib.machinery.EXTENSION_SUFFIXES)
    path = next(file for file in glob.glob(os.path.join(glob.escape(beside), "_core*.so")) if file.endswith(endings))
    spec = importlib.util.spec_from_file_location("_core", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.exit(module._run_program(["pertev", *sys.argv[1:]]))
