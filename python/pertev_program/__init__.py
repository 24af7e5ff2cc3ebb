"""The program `pertev` of this package, and its start by the command that pip writes. The module is not imported for that."""

import os
import sys

PATH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pertev")


def main():
    """Becomes the program."""
    os.execv(PATH, ["pertev", *sys.argv[1:]])
