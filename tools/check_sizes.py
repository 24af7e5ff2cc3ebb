#!/usr/bin/env python3
"""Fails on a source file longer than 500 lines, on one of 12 lines or fewer, on a header of fewer than 12 lines of code
that serves one neighbour alone, on a header that does not open with a comment that says what it is, and on a function
of src, apps or python that does not fit a screen: over 60 lines between its braces.

A header with a source file of its name is an interface, which may have little code. Short files that only instantiate
templates are rows of src/instances.cmake. `--self-test` tries the rule of functions.
"""

import ast
import collections
import pathlib
import re
import sys

LIMIT = 500
FLOOR = 12
SHORT = {  # files that may have so few lines, and why
    "python/images.h": "each part of the module is defined by a function of its own",
    "src/base/error.cpp": "keeps {fmt} out of a header that every file includes",
    "src/device/cuda/probe_architecture.h": "its source is CUDA, and those who ask are C++",
    "src/image/srgb_table.h": "those who decode need no function that encodes",
    "src/math/double_pi.h": "every file includes math/scalar.h, and few compute in double",
    "src/scene/node_number.h": "device code need not include nodes",
    "tests/support/device_stages.cu": "a row each stage of the header, which C++ includes",
}
SCREEN = 60
LONG = {  # functions that may be longer, and why
    # One table each: a row is a setting, a parameter, a flag or a function.
    "src/settings/scene_settings.cpp: scene_settings": "a row each setting",
    "src/settings/picture_settings.cpp: picture_settings": "a row each setting",
    "src/settings/integrator_settings.cpp: integrator_settings": "a row each setting",
    "src/scene/material.h: visit_parameters": "a row each parameter",
    "apps/viewer/view_state.cpp: own_settings": "a row each setting",
    "apps/cli/lab_command.cpp: add_lab_command": "a row each flag",
    "python/batch_arrays.cpp: define_batch": "a row each function",
    "python/contents_hash.cpp: hash_of_contents": "a row each part of a scene",
    # Kernels keep in registers what a called part would take as arguments, or write again.
    "src/denoise/accumulate_signals.h: operator()": "one kernel's registers",
    "src/device_scene/make_bsdf.h: build_any_bsdf": "one kernel's registers",
    "src/integrators/photon_map/gather_stages.h: operator()": "one kernel's registers",
    "src/tracer/hploc/emit_wide.h: make": "one kernel's registers",
    "src/tracer/hploc/warp_kernels.h: make_together": "a warp's lanes work on its variables",
    # A measurement in the order in which it is printed.
    "apps/cli/bench_cameras_command.cpp: bench_cameras": "its steps in order",
    "apps/cli/bench_devices_command.cpp: bench_devices": "its steps in order",
    "apps/cli/bench_frames_command.cpp: bench_frames": "its steps in order",
    "apps/cli/bench_render_command.cpp: bench_job": "its steps in order",
    "apps/cli/transport_command.cpp: run_transport_command": "its steps in order",
}
TOGETHER = {  # files that have so many lines together at most, and why
    ("src/session/session.h", "src/session/session.cpp"): (200, "a facade has no work of its own"),
}
FOLDERS = ["src", "apps", "tests", "tools", "bench", "python", "cmake"]
C_SUFFIXES = {".h", ".inl", ".cpp", ".cu"}
SUFFIXES = C_SUFFIXES | {".py", ".js", ".cmake"}

NO_CODE = re.compile(r"""R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])*'|//[^\n]*|/\*(?:.|\n)*?\*/""")
DIRECTIVE_OR_BRACE = re.compile(r"^[ \t]*#[ \t]*(\w+)(?:.*\\\n)*.*$|[{};]", re.MULTILINE)
NO_FUNCTION = re.compile(r"(?:template\s*<[^{]*>\s*)?(?:inline\s+)?(?:namespace|struct|class|union|enum|extern)\b")
NAME = re.compile(r"(operator\s*\S+|[\w:~]+)\s*\(")


def functions_of_c(text):
    """Yields name, line and length of each function, member or constructor of C++; lambdas in one are lines of it."""
    text = NO_CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    open_braces, begun, before_if, end = 0, None, [], 0
    for match in DIRECTIVE_OR_BRACE.finditer(text):
        directive = match[1] or ""
        if directive.startswith("if"):
            before_if.append((open_braces, begun))
        elif directive.startswith("el"):  # the branches may close the same braces
            open_braces, begun = before_if[-1]
        elif directive == "endif":
            before_if.pop()
        elif match[0] == "{":
            head = re.sub(r"\b(?:public|private|protected)\s*:", "", text[end:match.start()]).strip()
            if begun is None and "(" in head and not NO_FUNCTION.match(head):
                name = NAME.search(head)
                begun = (open_braces, match.start(), name[1] if name else head)
            open_braces += 1
        elif match[0] == "}":
            open_braces -= 1
            if begun and open_braces == begun[0]:
                yield begun[2], text.count("\n", 0, begun[1]) + 1, text.count("\n", begun[1], match.start()) - 1
                begun = None
        end = match.end()


def functions_of_python(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node.name, node.lineno, node.end_lineno - node.body[0].lineno + 1


def long_functions(root):
    """Faults of functions over a screen that LONG does not name, and of its rows without such a function."""
    unused = set(LONG)
    for folder in ["src", "apps", "python"]:
        for file in sorted((root / folder).rglob("*")):
            functions = functions_of_c if file.suffix in C_SUFFIXES else functions_of_python if file.suffix == ".py" else None
            for function, line, length in functions(file.read_text(encoding="utf-8")) if functions else []:
                row = f"{file.relative_to(root)}: {function}"
                if length > SCREEN and row not in LONG:
                    yield f"{file.relative_to(root)}:{line}: {function} has {length} lines: which {SCREEN} are a part with a name?"
                unused -= {row} if length > SCREEN else set()
    yield from (f"{row} is no function over {SCREEN} lines; tools/check_sizes.py need not name it" for row in sorted(unused))


def self_test():
    lines = "\n" * (SCREEN + 2)
    for source, function in [
            ("int f() {" + lines + "}", "f"), ("A::A(int i) : b_(i) {" + lines + "}", "A::A"),
            ("namespace a {\nstruct B {\n    bool operator()(int i) const {" + lines + "    }\n};\n}", "operator()"),
            ("template <class T>\nHD inline T g(T a) { if (a) { h('{', \"}\"); }" + lines + "}", "g"),
            ("#if A\nvoid f() {\n#else\nvoid f(int i) {\n#endif\n" + lines + "}", "f")]:
        found = [name for name, line, length in functions_of_c(source) if length > SCREEN]
        assert found == [function], (source, found)
    for source in ["namespace a {" + lines + "}", "struct B {\n    int f() { return 1; }" + lines + "};",
                   "const int table[] = {" + lines + "};", "int f() {}" + lines + "int g() { return 1'000; }",
                   "int f() { // {" + lines[2:] + "}"]:
        assert all(length <= SCREEN for name, line, length in functions_of_c(source)), source
    python = "def f():\n    a = 1" + lines + "    return a\n\nclass B:\n    def g(self):\n        pass\n"
    assert [name for name, line, length in functions_of_python(python) if length > SCREEN] == ["f"]


def users_of_headers(root):
    users = collections.defaultdict(set)
    for folder in FOLDERS:
        for file in (root / folder).rglob("*"):
            if file.suffix in C_SUFFIXES:
                for name in re.findall(r'^#include "([^"]+)"', file.read_text(encoding="utf-8"), re.MULTILINE):
                    users[name].add(file.relative_to(root))
    return users


def faults_in(root):
    users = users_of_headers(root)
    yield from long_functions(root)
    for names, (limit, reason) in TOGETHER.items():
        count = sum(len((root / name).read_text(encoding="utf-8").splitlines()) for name in names)
        if count > limit:
            yield f"{' and '.join(names)}: {count} lines; the limit is {limit}: {reason}"
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
            if file.suffix in C_SUFFIXES and len(lines) <= FLOOR and str(name) not in SHORT:
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
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    faults = list(faults_in(root))
    print("\n".join(faults) or "no file is too long and each header says what it is")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
