#!/usr/bin/env python3
"""Fails where a file is compiled with arithmetic of its own: one contracted a * b + c anywhere, and the picture is no
longer the same on every machine (cmake/compiler_flags.cmake).

`check_flags.py COMPILE_COMMANDS_JSON` looks at each command; `--self-test` feeds it commands that break each rule.
"""

import json
import pathlib
import shlex
import sys

REQUIRED = ["-ffp-contract=off", "-fno-math-errno", "-march=x86-64-v3"]
# Files for processors with more instructions, which keep their copies of inline functions to themselves.
WIDER, KEPT = "-march=x86-64-v4", "-fno-weak"
FORBIDDEN = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-fassociative-math", "-freciprocal-math",
             "-ffinite-math-only", "-mfpmath=387", "--use_fast_math", "-use_fast_math", "-ftz=true", "--ftz=true",
             "-prec-div=false", "--prec-div=false", "-prec-sqrt=false", "--prec-sqrt=false", "-fmad=true", "--fmad=true"}


def faults_of(command):
    words = shlex.split(command)
    cuda = "nvcc" in pathlib.PurePath(next((w for w in words if "ccache" not in w), "")).name or "-fmad=false" in words
    host = []
    following = False
    for word in words: # nvcc hands its host compiler what follows -Xcompiler
        if following or word.startswith("-Xcompiler="):
            host += word.removeprefix("-Xcompiler=").split(",")
        following = word in ("-Xcompiler", "--compiler-options")
    given = host if cuda else words
    faults = []
    for flag in REQUIRED:
        key = flag.split("=")[0]
        last = next((w for w in reversed(given) if w.split("=")[0] == key), None)
        if last != flag and not (last == WIDER and KEPT in given):
            faults.append(f"{flag} is {'not given' if last is None else 'overruled by ' + last}")
    if cuda and "-fmad=false" not in words:
        faults.append("-fmad=false is not given")
    return faults + [f"{word} is given" for word in words + host if word in FORBIDDEN]


def self_test():
    good = "/usr/bin/c++ -O3 -ffp-contract=off -fno-math-errno -march=x86-64-v3 -c a.cpp"
    good_cuda = "/x/nvcc -fmad=false -Xcompiler=-ffp-contract=off,-fno-math-errno,-march=x86-64-v3 -c a.cu"
    assert not faults_of(good) and not faults_of("ccache " + good) and not faults_of(good_cuda)
    for flag in REQUIRED:
        assert faults_of(good.replace(flag, "")), flag
        assert faults_of(good_cuda.replace(flag, "")), flag
    for flag in sorted(FORBIDDEN) + ["-ffp-contract=fast", "-march=native"]:
        assert faults_of(good + " " + flag), flag
        assert faults_of(good_cuda + " " + flag) or flag.startswith(("-ffp", "-march")), flag
    assert faults_of(good_cuda.replace("-fmad=false", ""))
    assert not faults_of(f"{good} {WIDER} {KEPT}") and faults_of(f"{good} {WIDER}")
    assert faults_of(good_cuda + " -Xcompiler -ffp-contract=fast")


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return 0
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    commands = json.loads(pathlib.Path(arguments[0]).read_text())
    faults = []
    for entry in commands:
        command = entry.get("command") or shlex.join(entry["arguments"])
        faults += [f"{entry['file']}: {fault}" for fault in faults_of(command)]
    if not commands:
        faults.append(f"{arguments[0]}: no commands")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main(sys.argv[1:]))
