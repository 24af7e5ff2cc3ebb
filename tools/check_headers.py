#!/usr/bin/env python3
"""Compiles headers by themselves, so that each can be included first and, where it has device code, by any compiler.

The first --cxx compiles each header but host headers that their own .cpp includes first. It compiles many of them in
one go, which spares it the standard library, yet each header follows only headers whose declarations it does not name,
or which it includes itself. Thus each is as complete as if it stood there alone. Host-device headers (those that say HD)
are compiled by every other --cxx and by --nvcc too, gathered into one generated file. CTest gives a compiler that the
build does not use, where there is one. `--self-test` feeds the check headers that must fail.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HOST_FLAGS = ["-x", "c++", "-std=c++20", "-fsyntax-only", "-ffp-contract=off", "-march=x86-64-v3", "-Wall", "-Wextra",
              "-Wpedantic", "-Wshadow", "-Wdouble-promotion", "-Wfloat-conversion", "-Werror"]
NVCC_FLAGS = ["-x", "cu", "-std=c++20", "-ptx", "-arch=compute_90", "--expt-relaxed-constexpr", "-fmad=false",
              "-Werror=all-warnings", "-o", os.devnull]
FIRST_INCLUDE = re.compile(r'^#include [<"](.*?)[>"]', re.MULTILINE)
OWN_INCLUDE = re.compile(r'^#include "(.*?)"', re.MULTILINE)
STD_INCLUDE = re.compile(r"^#include <(.*?)>", re.MULTILINE)
NO_CODE = re.compile(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"')
DIRECTIVE = re.compile(r"^#(?! *define).*", re.MULTILINE)
NAME = re.compile(r"\b[A-Za-z_]\w*")
MEMBER = re.compile(r"(?:(?<!\.)\.|->)[A-Za-z_]\w*")  # a class declares what follows "." or "->"
DECLARED = re.compile(r"\b(?:struct|enum class|class|enum|union|concept|define|using)\s+(\w+)|(\w+)\s*\(|"
                      r"\b([A-Za-z_]\w*)\s*(?:\[[^\]\n]*\]\s*)*[={;]")
ALIGNAS = re.compile(r"\balignas\(\w+\)")
NAMESPACE = re.compile(r"^namespace [\w:]+", re.MULTILINE)
REFERENCE = re.compile(r"\(&\w*\)")  # an array that is passed by reference
TEMPLATE = re.compile(r"\btemplate\s*<(?:[^<>]|<[^<>]*>)*>")
STD_NAME = re.compile(r"\bstd::(\w+)")
TYPE = re.compile(r"(?<!<)\b(?:struct|enum class|class|enum|union|concept)\s+(?:alignas\(\w+\)\s+)?(\w+)")
FORWARD = re.compile(r"^(?:struct|class|enum class|enum)\s+(\w+)[^{};\n]*;", re.MULTILINE)
NO_NAMES = {"pertev", "class", "alignas", "static_assert", "requires", "defined", "if", "inline", "int", "const", "void", "sizeof", "bool",
            "uint8_t", "uint16_t", "uint32_t", "uint64_t"}
# The headers that declare names of the standard library, where these are not called as the names are.
STD_HEADER_OF = {"function": "functional", "unique_ptr": "memory", "shared_ptr": "memory", "make_shared": "memory",
                 "make_unique": "memory", "nullopt": "optional", "size_t": "cstddef", "byte": "cstddef",
                 "move": "utility", "pair": "utility", "exchange": "utility", "swap": "utility",
                 "numeric_limits": "limits", "max": "algorithm", "min": "algorithm", "sort": "algorithm",
                 "memcpy": "cstring", "memchr": "cstring", "isnan": "cmath", "isfinite": "cmath", "as_bytes": "span",
                 "from_chars": "charconv", "errc": "charconv", "is_same_v": "type_traits",
                 "type_identity_t": "type_traits", "conditional_t": "type_traits", "integral_constant": "type_traits",
                 "is_trivially_copyable_v": "type_traits", "is_trivially_destructible_v": "type_traits",
                 "decay_t": "type_traits", "bit_cast": "bit", "popcount": "bit", "countl_zero": "bit", "bit_floor": "bit",
                 "endian": "bit", "ptrdiff_t": "cstddef", "declval": "utility", "index_sequence": "utility",
                 "make_index_sequence": "utility", "reverse": "algorithm", "nth_element": "algorithm",
                 "fill_n": "algorithm", "once_flag": "mutex", "call_once": "mutex", "less": "functional"}
# Headers of the standard library declare these names outside of std too.
C_NAMES = {"cstdint": {f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64, "ptr")},
           "cstddef": {"size_t", "ptrdiff_t", "offsetof"}, "cstring": {"memcpy", "memset", "memcmp", "memchr"},
           "cmath": {"fabsf", "sqrtf", "fmaf", "isnan", "INFINITY", "NAN"}, "immintrin.h": {"_mm_malloc", "__m128"}}
HOST_DEVICE = re.compile(r"^\s*(template\s*<.*>\s*)?(\[\[\w+\]\]\s*)?(constexpr\s+|static\s+)*HD\b", re.MULTILINE)


def compile_includes(command, headers, source):
    """The compiler's complaint about a file that includes `headers`; empty where there is none."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / ("gathered.cu" if "cu" in command else "alone.cpp")
        file.write_text("".join(f'#include "{h}"\n' for h in headers))
        run = subprocess.run([*command, f"-I{source}", str(file)], capture_output=True, text=True)
        return "" if run.returncode == 0 else run.stderr + run.stdout


def built_alone(header, source):
    """Does the header's own .cpp include it first?"""
    own = (source / header).with_suffix(".cpp")
    first = own.exists() and FIRST_INCLUDE.search(own.read_text(encoding="utf-8"))
    return bool(first) and first.group(1) == header.as_posix()


def closures(headers, source):
    """All that each header includes, at once or through others, of our own."""
    known = {}

    def of(header):
        if header not in known:
            known[header] = set()  # where headers include each other in a circle
            for name in map(pathlib.Path, OWN_INCLUDE.findall((source / header).read_text(encoding="utf-8"))):
                if (source / name).exists():
                    known[header] |= {name} | of(name)
        return known[header]

    return {h: of(h) for h in headers}


def without_parameters(head):
    """The declaration with nothing between its parentheses: no other header can use a parameter's name."""
    depth, kept = 0, ""
    for sign in REFERENCE.sub("", head):
        depth -= sign == ")" and depth > 0
        kept += sign if depth == 0 else ""
        depth += sign == "("
    return kept


class Text:
    """The names of a header, without comments and strings, and those that it declares."""

    def __init__(self, text):
        self.std_headers = set(STD_INCLUDE.findall(text))
        text = DIRECTIVE.sub("", NO_CODE.sub("", text))
        self.tokens = set(NAME.findall(MEMBER.sub(" ", text)))
        self.std_names = set(STD_NAME.findall(text))
        self.types = set(TYPE.findall(TEMPLATE.sub("", text)))  # a template's parameters are none
        self.only_named = set(FORWARD.findall(text))
        # Pairs of a name and the other names of its declaration. Members do not stand at the left margin.
        self.declared = []
        for line in NAMESPACE.sub("", text).splitlines():  # who uses a namespace names what is in it
            head = ALIGNAS.sub("", TEMPLATE.sub("", line.split("{")[0])) if line[:1].strip() else ""
            names = set(NAME.findall(head))
            found = DECLARED.findall(without_parameters(head) if "(" in head else head + ";")
            of = {next(filter(None, groups)) for groups in found}
            of = {n for n in of - NO_NAMES if not n.startswith("__")}
            self.declared += [(n, names - {n}) for n in of | names & {"operator"}]


def provides(std_headers, name):
    """Do these headers of the standard library declare std::name?"""
    return STD_HEADER_OF.get(name, name) in std_headers


class Unit:
    """Headers that are compiled in one go. None names what is declared before it by a header that it does not include."""

    def __init__(self):
        self.list, self.own, self.std = [], set(), set()

    def takes(self, header, closure, texts):
        """Can the header come next? `closure` has it and all of ours that it includes, at once or through others."""
        text = texts[header]
        std = set().union(*(texts[h].std_headers for h in closure))
        foreign_std = self.std - std
        if foreign_std and not all(provides(std, name) for name in text.std_names):
            return False
        # Headers of the standard library include each other, so any of them may declare these.
        if foreign_std and any(C_NAMES[h].intersection(text.tokens) for h in C_NAMES.keys() - std):
            return False
        foreign = [texts[h] for h in self.own - closure]
        types = set().union(*(t.types for t in foreign)) - set().union(*(texts[h].types for h in closure))
        incomplete = set().union(*(texts[h].only_named for h in closure))
        # The header cannot call a function that takes a type which it does not know.
        return not any((name in text.tokens or name in incomplete or name == "operator") and not others & types
                       for t in foreign for name, others in t.declared)

    def add(self, header, closure, texts):
        self.list.append(header)
        self.own |= closure
        self.std |= set().union(*(texts[h].std_headers for h in closure))


def units(headers, source):
    """Puts each header into the first list that takes it, those that include least first."""
    included = closures(headers, source)
    known = set(headers).union(*included.values())
    texts = {h: Text((source / h).read_text(encoding="utf-8")) for h in known}
    found = []
    for header in sorted(headers, key=lambda h: (len(included[h]), h)):
        closure = included[header] | {header}
        unit = next((u for u in found if u.takes(header, closure, texts)), None)
        if unit is None:
            unit = Unit()
            found.append(unit)
        unit.add(header, closure, texts)
    return [unit.list for unit in found]


def jobs_for(source, compilers, nvcc, folders):
    """(what it is, command, headers) for each compilation."""
    headers = [h.relative_to(source) for h in sorted(source.rglob("*.h")) if "cuda" not in h.parts]
    host_device = [h for h in headers if HOST_DEVICE.search((source / h).read_text(encoding="utf-8"))]
    includes = [f"-I{folder}" for folder in folders]
    others = [[c, *HOST_FLAGS, *includes] for c in compilers[1:]] + ([[nvcc, *NVCC_FLAGS, *includes]] if nvcc else [])
    for command in others:
        yield f"host-device headers by {command[0]}", command, host_device
    for unit in units([h for h in headers if h in host_device or not built_alone(h, source)], source):
        yield f"{', '.join(map(str, unit))} by {compilers[0]}", [compilers[0], *HOST_FLAGS, *includes], unit


def check(source, compilers, nvcc, threads, folders=()):
    jobs = list(jobs_for(source, compilers, nvcc, folders))
    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
        complaints = list(pool.map(lambda job: compile_includes(job[1], job[2], source), jobs))
    return [f"{what}:\n{text}" for (what, _, _), text in zip(jobs, complaints) if text], len(jobs)


GOOD = '#pragma once\n#include "base/host_device.h"\n'
BAD_HEADERS = {  # each compiles for some compiler, and must fail for the compiler named
    "cxx": "#pragma once\nHD inline int f(Vec3 v) { return 0; }\n",
    "unit": GOOD + "inline int f(int x) { return g(x); }\n",  # g is good.h's, which it does not include
    "nvcc": GOOD + "inline int on_host(int x) { return x; }\nHD inline int f(int x) { return on_host(x); }\n",
}


def self_test(compilers, nvcc):
    failures = 0
    for who, text in BAD_HEADERS.items():
        if who == "nvcc" and not nvcc:
            continue
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder)
            (source / "base").mkdir()
            shutil.copy(ROOT / "src/base/host_device.h", source / "base/host_device.h")
            (source / "base/good.h").write_text(GOOD + "HD inline int g(int x) { return x; }\n")
            (source / "base/bad.h").write_text(text)
            (source / "base/bad.cpp").write_text('#include "base/good.h"\n#include "base/bad.h"\n')  # not first
            faults, _ = check(source, compilers, nvcc, 1)
            expected = len(compilers) + (1 if nvcc else 0) if who == "cxx" else 1
            if len(faults) != expected:
                failures += 1
                print(f"bad for {who}: {len(faults)} complaints, expected {expected}\n" + "\n".join(faults))
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cxx", action="append", required=True, help="host compiler; may be repeated")
    parser.add_argument("--nvcc", help="CUDA compiler")
    parser.add_argument("--include", action="append", help="folder of headers that the build writes (build*/generated)")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--self-test", action="store_true")
    args = parser.parse_args()
    absent = [c for c in args.cxx if not shutil.which(c)]
    for compiler in absent:
        print(f"skipped: {compiler} is not here, so no header was compiled with it")
    compilers = [c for c in args.cxx if c not in absent]
    if args.self_test:
        sys.exit(1 if self_test(compilers, args.nvcc) else 0)
    folders = args.include or sorted(ROOT.glob("build*/generated"))
    faults, count = check(ROOT / "src", compilers, args.nvcc, args.jobs, folders)
    print("\n".join(faults) or f"{count} compilations, no complaint")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
