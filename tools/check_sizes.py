#!/usr/bin/env python3
"""Fails on a source file longer than 500 lines, on one of 12 lines or fewer, on a header of fewer than 12 lines of code
that serves one neighbour alone, and on a header that does not open with a comment that says what it is.

A header with a source file of its name is an interface, which may have little code. Short files that only instantiate
templates are rows of src/instances.cmake.
"""

import collections
import pathlib
import re
import sys

LIMIT = 500
FLOOR = 12
SHORT = {  # files that may have so few lines, and why
    "src/base/error.cpp": "keeps {fmt} out of a header that every file includes",
    "src/device/cuda/probe_architecture.h": "its source is CUDA, and those who ask are C++",
    "src/image/srgb_table.h": "those who decode need no function that encodes",
    "src/math/double_pi.h": "every file includes math/scalar.h, and few compute in double",
    "src/scene/node_number.h": "device code need not include nodes",
}
FOLDERS = ["src", "apps", "tests", "tools", "bench", "python", "cmake"]
C_SUFFIXES = {".h", ".inl", ".cpp", ".cu"}
SUFFIXES = C_SUFFIXES | {".py", ".js", ".cmake"}


def users_of_headers(root):
    users = collections.defaultdict(set)
    for folder in FOLDERS:
        for file in (root / folder).rglob("*"):
            if file.suffix in {".h", ".cpp", ".cu"}:
                for name in re.findall(r'^#include "([^"]+)"', file.read_text(encoding="utf-8"), re.MULTILINE):
                    users[name].add(file.relative_to(root))
    return users


def faults_in(root):
    users = users_of_headers(root)
    for name in SHORT:
        file = root / name
        if not file.is_file() or len(file.read_text(encoding="utf-8").splitlines()) > FLOOR:
            yield f"{name}: is not short; tools/check_sizes.py need not name it"
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in SUFFIXES:
                continue
            lines = file.read_text(encoding="utf-8").splitlines()
            name = file.relative_to(root)
            if len(lines) > LIMIT:
                yield f"{name}: {len(lines)} lines; the limit is {LIMIT}: which two ideas does it hold?"
            if folder in ("src", "apps") and file.suffix in C_SUFFIXES and len(lines) <= FLOOR and str(name) not in SHORT:
                yield f"{name}: {len(lines)} lines: what does it belong to? (SHORT names exceptions)"
            if folder == "src" and file.suffix == ".h":
                code = [line for line in lines if line.strip() and not line.strip().startswith("//")]
                using = users[str(name.relative_to("src"))]
                is_interface = any(file.with_suffix(suffix).exists() for suffix in (".cpp", ".cu"))
                if len(code) < FLOOR and len(using) == 1 and not is_interface:
                    yield f"{name}: {len(code)} lines of code, for {min(using)} alone: they belong there"
                text = [line for line in lines if line.strip()]
                if not text or text[0].strip() != "#pragma once":
                    yield f"{name}:1: a header starts with #pragma once"
                elif len(text) < 2 or not text[1].startswith("//"):
                    yield f"{name}:3: a header opens with a comment: what it is, its source, the one thing to know"


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    faults = list(faults_in(root))
    print("\n".join(faults) or "no file is too long and each header says what it is")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
