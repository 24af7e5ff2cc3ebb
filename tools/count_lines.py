#!/usr/bin/env python3
"""Counts the lines of the sources that are neither blank nor comment, by top folder.

Without a revision the working tree is counted, formatted as it is; with some, what Git holds of each. Lines of C++, CUDA,
C, JavaScript, shell, Python and CMake; a line with code and a comment counts. Docstrings count as comments.
"""

import argparse
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ["src", "apps", "bench", "tools", "python"]
HASH_COMMENTS = {".py", ".sh", ".cmake", ".txt"}
SLASH_COMMENTS = {".h", ".inl", ".cpp", ".cu", ".c", ".in", ".js"}
STRINGS_OR_COMMENTS = re.compile(r'R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*(?:.|\n)*?\*/')
DOCSTRING = re.compile(r'^[ \t]*(?:"""(?:.|\n)*?""")[ \t]*$', re.MULTILINE)


def code_lines(suffix, text):
    if suffix in SLASH_COMMENTS:
        text = STRINGS_OR_COMMENTS.sub(lambda m: "" if m.group(0).startswith("/") else m.group(0), text)
    elif suffix == ".py":
        text = DOCSTRING.sub("", text)
    lines = (line.strip() for line in text.splitlines())
    return sum(1 for line in lines if line and not (suffix in HASH_COMMENTS and line.startswith("#")))


def files_of(revision):
    """(path, text) of each source file."""
    command = ["git", "-C", ROOT, "ls-files"] if revision is None else ["git", "-C", ROOT, "ls-tree", "-r", "--name-only", revision]
    names = subprocess.run([*command, *(["--"] if revision is None else []), *FOLDERS], capture_output=True, text=True, check=True).stdout
    for name in names.splitlines():
        path = pathlib.PurePath(name)
        if path.suffix not in HASH_COMMENTS | SLASH_COMMENTS or (revision is None and not (ROOT / name).exists()):
            continue
        if revision is None:
            yield path, (ROOT / name).read_text(encoding="utf-8")
        else:
            shown = subprocess.run(["git", "-C", ROOT, "show", f"{revision}:{name}"], capture_output=True, check=True).stdout
            yield path, shown.decode()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision", nargs="*", metavar="REVISION", help="a commit, branch or tag")
    for revision in parser.parse_args().revision or [None]:
        counts = dict.fromkeys(FOLDERS, 0)
        for path, text in files_of(revision):
            counts[path.parts[0]] += code_lines(path.suffix, text)
        folders = ", ".join(f"{folder} {count}" for folder, count in counts.items() if count)
        print(f"{revision or 'working tree'}: {sum(counts.values())} ({folders})")


if __name__ == "__main__":
    main()
