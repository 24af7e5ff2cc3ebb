"""Writes the files of a script that makes scenes; with --check, writes nothing and fails where a file is not what it would write."""

import argparse
import sys


def write_or_check(description, files):
    """`files` has texts by path."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare with the files instead of writing them")
    is_check = parser.parse_args().check
    for path, text in files.items():
        if not is_check:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        elif not path.is_file() or path.read_text(encoding="utf-8") != text:
            sys.exit(f"{path} is not what {sys.argv[0]} writes; run it and commit the result")
