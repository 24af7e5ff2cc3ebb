#!/usr/bin/env python3
"""Fails where a document, a comment or what a script says of itself names what is not there: a file, an anchor, a source file, a script,
a flag or a preset. It also fails where all documents together have more than 40,000 words, the tour names more than forty files, a text
speaks of internal targets, a picture has no licence in docs/notices.md, a key of metadata is in no table, a command of a block is on no
row of RUN_BY, or status.md has too few questions or figures.

    tools/check_documents.py
    tools/check_documents.py --commands   prints the commands that tools/nightly runs in a new clone
    tools/check_documents.py --links      asks for the documents' external links instead
    tools/check_documents.py --self-test

tests/robust/cli_documents_test.py runs the commands that commands() finds, or asks their programs what they would do. It looks at the verbs
and flags of own_commands().
"""

import ast
import json
import pathlib
import re
import sys
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_WORDS, MOST_FILES_OF_TOUR = 40_000, 40
SOURCE = re.compile(r"`([\w./-]+\.(?:h|inl|cpp|cu|py|sh|js|md|cmake))`")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
COMMAND = re.compile(r"(?:build/bin/|bench/|tools/|tests/)[\w./-]+|pertev\b(?!\.)|\./setup\.sh|cmake|ctest|ninja|python3")
TARGETS = re.compile(r"(?i)\b(?:was|were) asked for|\basked for were|\bhoped for\b|\bwere planned\b|\b(?:aim|goal|target) (?:of [\d,.]+|is missed|was missed)|"
                     r"\b(?:limit is|at most) \w+ files outside|\bmet it at\b|(?<![`|\w])S[58](?![`|\w])")
LEAST_QUESTIONS, LEAST_FIGURES = 30, 10 # rows of status.md
# Begins of commands, the file that runs them, and what stands there for it. The first row that fits counts.
RUN_BY = [
    ("pertev ", "tests/robust/cli_documents_test.py", '"pertev"'),
    ("build/bin/pertev ", "tests/robust/cli_documents_test.py", '"build/bin/pertev"'),
    ("ffmpeg ", "tests/robust/cli_documents_test.py", '"ffmpeg"'),
    *((f"python3 examples/{name}.py ", "tests/python/examples_test.py", name) for name in ("turntable", "dataset", "data_loader", "nerf_colmap")),
    ("tools/measure.py ", "tests/robust/measuring_scripts_test.py", '"measure.py"'),
    ("tools/make_tables.py", "tests/CMakeLists.txt", "make_tables"),
    ("PERTEV_SCENES=", ".ci/run", "PERTEV_SCENES"),
    # People with a GPU begin the last of these, and a clock tools/nightly.
    ("build/bin/pertev_tests --device cuda", "tools/check_gpu.sh", "--device cuda"),
    ("python3 tests/images/bitterli_scenes.py ", "tools/check_gpu.sh", "bitterli_scenes"),
    ("tools/check_gpu.sh ", "", ""),
    ("tools/nightly", "", ""),
    *((begin, "tools/nightly", "--commands") for begin in ("./setup.sh", "python3 -m venv venv", "venv/bin/", "cmake ", "ctest ", "ninja ", "build/bin/pertev_",
                                                   "tools/check_documents.py")),
]
FLAG = re.compile(r"(?<![\w/-])--[a-z][a-z-]*[a-z]")
FOLDERS = ["src", "apps", "tests", "tools", "bench", "cmake", "docs", "examples", "packaging", "scenes"]
# This section's table has new files, which do not exist yet, and existing files that a change touches, with their number.
ON_PAPER = "## Fifteen changes"


def documents(root=ROOT):
    return [*sorted((root / "docs").glob("*.md")), root / "README.md", root / "CHANGELOG.md", root / "CONTRIBUTING.md"]


def anchors_of(text):
    """The anchors that GitHub gives the headings."""
    anchors = set()
    for line in without_fences(text):
        if match := re.match(r"#+ +(.*)", line):
            title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", match[1]).lower()
            anchors.add(re.sub(r"\s", "-", re.sub(r"[^\w\- ]", "", title).strip()))
    return anchors


def without_fences(text):
    fenced = False
    for line in text.splitlines():
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield line


def shell_lines(text):
    """(line, whether it must be a command) of blocks, without comments, with continued lines joined and joined commands apart. A fenced
    block without a language, or with sh, has only commands; an indented block may be a formula."""
    language, found = None, []
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith("```"):
            language = line[3:].strip() if language is None else None
        elif language in ("", "sh", "bash") or language is None and line.startswith("    "):
            parts = re.split(r"\s#\s|\s{2,}#", line.strip())[0].split(" && ")
            found += [(part.strip(), language is not None) for part in parts if part.strip() and not part.startswith("# ")]
    return found


def is_command(line):
    return COMMAND.match(re.sub(r"^[A-Z_]+=\S+ ", "", line)) is not None


def commands(text):
    """The shell commands of fenced and indented blocks that tests run."""
    return [line for line, _ in shell_lines(text) if is_command(line)]


def runner_of(command):
    """Returns the row of RUN_BY that fits, or None."""
    return next((row for row in RUN_BY if command.startswith(row[0])), None)


def runner_faults(texts):
    """Faults of {name: text}: commands that nothing runs, rows of RUN_BY that no document has, and files that do not run theirs."""
    lines = [(name, line) for name, text in texts.items() for line, must in shell_lines(text) if must or is_command(line)]
    yield from (f"{name}: RUN_BY has nothing that runs this: {line}" for name, line in lines if not runner_of(line))
    used = [runner_of(line) for _, line in lines]
    for row in RUN_BY:
        begin, file, said = row
        if row not in used:
            yield f"RUN_BY: no document has {begin}"
        if file and said not in (ROOT / file).read_text(encoding="utf-8"):
            yield f"RUN_BY: {file} says nothing of {said}"


def nightly_commands():
    """The documents' commands that tools/nightly runs, in their order."""
    return [line for document in documents() for line, must in shell_lines(document.read_text(encoding="utf-8"))
            if (must or is_command(line)) and (runner_of(line) or ("", ""))[1] == "tools/nightly"]


def status_faults(text):
    """Faults of status.md if its tables have too few rows."""
    questions = len(re.findall(r"[|] [^|]*[?] (?=[|])", text.partition("## Question and file")[2]))
    figures = len(re.findall(r"(?m)^[|](?! what |-)", text.partition("<!-- figures -->")[2].partition("<!-- end -->")[0]))
    if questions < LEAST_QUESTIONS:
        yield f"status.md answers {questions} questions; {LEAST_QUESTIONS} is the least"
    if figures < LEAST_FIGURES:
        yield f"status.md has {figures} figures; {LEAST_FIGURES} is the least"


def inline_commands(text):
    """The program's commands within sentences, whose files and values are placeholders."""
    return [" ".join(found.split()) for found in re.findall(r"(?<!`)`(pertev [a-z][^`]*)`", "\n".join(without_fences(text)))]


def link_faults(document, text, read):
    for target in LINK.findall("\n".join(without_fences(text))):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (document.parent / path).resolve() if path else document
        if not file.exists():
            yield f"{document.name}: {target} is not there"
        elif anchor and anchor not in anchors_of(read(file)):
            yield f"{document.name}: {path or document.name} has no heading #{anchor}"


def ends_of(tracked):
    """The paths of files below any of their folders."""
    return {"/".join(path.split("/")[i:]) for path in tracked for i in range(path.count("/") + 1)}


def source_faults(name, text, tracked):
    for script in sorted(set(re.findall(r"`((?:tools|tests|bench)/[\w./]+)[ `]", text))):
        if not (ROOT / script).exists() and not (ROOT / f"{script}.cpp").exists():
            yield f"{name}: {script} is not there"
    ends = ends_of(tracked)
    for source in sorted({name.removeprefix("./") for name in SOURCE.findall(text.split(ON_PAPER)[0])}):
        if source not in ends and not re.search(r"NAME|FAMILY|[a-z]+_lobe\.h$", source):
            yield f"{name}: no file is called {source}"


def change_faults(text, ends):
    """Faults of the table of changes: files to be touched that are not there, and numbers that are not those of the files."""
    for row in re.findall(r"(?m)^\| (?!change )(.*) \| .* \| (\d+(?: \([^|]*?\))?: .*) \|$", text.split(ON_PAPER)[-1]):
        for part in row[1].split("; "):
            names = re.findall(r"`([\w./]+\.(?:h|cpp|cmake|txt|toml|sh))`", part)
            yield from (f"architecture.md: {row[0]}: {name} is not there" for name in names if name not in ends)
            if (number := re.match(r"(\d+)(?: \([^)]*\))?:", part)) and int(number[1]) != len(names):
                yield f"architecture.md: {row[0]}: {number[1]} files are {len(names)}"


def metadata_faults(source, text, conventions, settings):
    """Faults of keys of metadata that a source names, that are no setting's, and that conventions.md does not list."""
    for key in sorted(set(re.findall(r'"pertev\.([a-z_]+)"', text))):
        if f"`{key}`" not in conventions and f"`--{key.replace('_', '-')}`" not in settings:
            yield f"{source}: conventions.md does not have the key pertev.{key}"


def script_faults(name, command):
    """Faults of the scripts that a command names, and of the flags that it gives to one."""
    words = re.sub(r"^[A-Z_]+=\S+ ", "", command).partition(" -- ")[0].split()
    for word in words:
        if word.startswith(("tools/", "tests/", "bench/", "examples/", "./")) and not any((ROOT / f"{word}{end}").exists() for end in ("", ".cpp")):
            yield f"{name}: {word} is not there: {command}"
    script = next((ROOT / word for word in words if re.match(r"(?:tools|tests|bench|examples)/\S+\.(?:py|sh)$", word)), None)
    if script and script.exists():
        _, code = parts_of(script)
        yield from (f"{name}: {script.name} has no {flag}: {command}" for flag in FLAG.findall(" ".join(words)) if flag not in code)


def command_faults(name, text, presets):
    """Faults of scripts and presets that commands name. The test runs the commands of the program itself."""
    sentences = re.findall(r"(?<!`)`((?:tools|tests|bench)/[^`]*)`", "\n".join(without_fences(text)))
    for command in [*commands(text), *sentences]:
        yield from script_faults(name, command)
        if match := re.search(r"--preset (\S+)", command):
            if command.startswith("cmake") and match[1] not in presets:
                yield f"{name}: no preset {match[1]}: {command}"


def scripts():
    return [*sorted((ROOT / "tools").glob("*.[ps][yh]")), ROOT / "tools/nightly", *sorted((ROOT / "bench").glob("*.py")),
            *sorted((ROOT / "tests/images").glob("*.py"))]


def parts_of(script):
    """Returns what a script says of itself, in its docstring or in the comment at its head, and the rest of it with what it imports."""
    text = script.read_text(encoding="utf-8")
    if script.suffix != ".py":
        said = re.match(r"(?:#.*\n)*", text)[0]
        return said.replace("\n# ", "\n"), text[len(said):]
    said = ast.get_docstring(ast.parse(text)) or ""
    imported = [folder / f"{name}.py" for name in re.findall(r"(?m)^(?:from|import) (\w+)", text)
                for folder in (script.parent, ROOT / "tests/support")]
    return said, text.replace(said, "") + "".join(path.read_text(encoding="utf-8") for path in imported if path.exists())


def own_commands():
    """Commands of the program outside of documents: those of scripts' texts, of jobs that are measured, and of measurements."""
    for script in scripts():
        yield from ((script.name, command) for command in inline_commands(parts_of(script)[0]))
    jobs = json.loads((ROOT / "bench/jobs.json").read_text(encoding="utf-8"))
    yield from (("jobs.json", f"pertev {job['line']}") for table in ("parts", "devices") for part in jobs[table].values() for job in part["jobs"])
    yield from measured_commands()


def measured_commands():
    """Commands of the program in measurements."""
    for path in sorted((ROOT / "bench/results").glob("*.json")):
        command = json.loads(path.read_text(encoding="utf-8"))["command"] or ""
        yield from ((path.name, one) for one in command.split("; ") if re.match(r"(?:\S*/)?pertev ", one))


def own_faults(name, said, code, known):
    """Faults of what a script says of itself: scripts that are gone, and flags that neither it nor the program has."""
    for script in sorted(set(re.findall(r"(?:tools|tests|bench)/[\w/]+\.(?:py|sh)\b", said))):
        if not (ROOT / script).exists():
            yield f"{name}: {script} is not there"
    yield from (f"{name}: says {flag}, which neither it nor pertev has" for flag in sorted(set(FLAG.findall(said))) if flag not in code + known)


def help_faults(name, code):
    """A fault of a script that would take --help for an argument."""
    if '__name__ == "__main__"' in code and "argparse" not in code and '"--help"' not in code and "write_or_check" not in code:
        yield f"{name}: has no --help"


def import_faults(name, text, own):
    """Packages that a script needs even for --help: those of neither Python nor `own`, imported before the help is shown."""
    for part in ast.parse(text).body:
        if isinstance(part, ast.If) and '"--help"' in (ast.get_source_segment(text, part.test) or ""):
            return
        names = [alias.name for alias in part.names] if isinstance(part, ast.Import) else [part.module] if isinstance(part, ast.ImportFrom) else []
        yield from (f"{name}: needs {package} for --help (tools/late_import.py)" for package in (one.partition(".")[0] for one in names)
                    if package not in own and package not in sys.stdlib_module_names)


def named_faults(name, text):
    """Files that a source names, as its comments do, and that are not there."""
    for file in sorted(set(re.findall(r"\b(?:tools|tests|bench|docs)/[\w/.-]+\.(?:py|sh|json|cpp|h|md)\b", text))):
        if not (ROOT / file).exists():
            yield f"{name}: {file} is not there"


def broken_links(ask):
    """External links of all documents for which `ask` raises an error."""
    for document in documents():
        for link in sorted(set(re.findall(r"\]\((https?://[^)\s]+)\)", document.read_text(encoding="utf-8")))):
            try:
                ask(link)
            except OSError as error:
                yield f"{document.name}: {link}: {error}"


def faults_of_all():
    tracked = [path.relative_to(ROOT).as_posix() for folder in FOLDERS for path in (ROOT / folder).rglob("*.*")]
    tracked += [path.name for path in ROOT.glob("*.*")]
    presets = re.findall(r'"name": "([^"]+)"', (ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
    known = "".join(path.read_text(encoding="utf-8") for path in [*(ROOT / "apps/cli").glob("*.cpp"), ROOT / "docs/settings.md"])
    own_modules = {path.stem for folder in ("tools", "bench", "tests/images", "tests/support", "tests/robust") for path in (ROOT / folder).glob("*.py")}
    for script in scripts():
        yield from own_faults(script.name, *parts_of(script), known)
        if script.suffix == ".py":
            yield from help_faults(script.name, parts_of(script)[1])
            yield from import_faults(script.name, script.read_text(encoding="utf-8"), own_modules)
    settings = (ROOT / "docs/settings.md").read_text(encoding="utf-8")
    conventions = (ROOT / "docs/conventions.md").read_text(encoding="utf-8").partition("The metadata of an EXR")[2]
    for source in tracked:
        if source.startswith(("src/", "apps/", "tests/", "bench/")) and source.endswith((".h", ".cpp", ".cu", ".py", ".js", ".txt")):
            yield from named_faults(source, (ROOT / source).read_text(encoding="utf-8"))
        if source.startswith("src/session/") and source.endswith(".cpp"):
            yield from metadata_faults(source, (ROOT / source).read_text(encoding="utf-8"), conventions, settings)
    yield from runner_faults({document.name: document.read_text(encoding="utf-8") for document in documents()})
    words = 0
    for document in documents():
        text = document.read_text(encoding="utf-8")
        words += len(text.split())
        yield from link_faults(document, text, lambda file: file.read_text(encoding="utf-8") if file.suffix == ".md" else "")
        if document.name != "CHANGELOG.md": # it names files that are gone
            yield from source_faults(document.name, text, tracked)
        yield from command_faults(document.name, text, presets)
        if document.name == "status.md":
            yield from status_faults(text)
        if document.name == "architecture.md":
            yield from change_faults(text, ends_of(tracked))
        yield from (f"{document.name}: an internal target or a job's number: {match[0]}" for match in TARGETS.finditer(text))
        if document.name == "tour.md" and len(set(SOURCE.findall(text))) > MOST_FILES_OF_TOUR:
            yield f"tour.md names {len(set(SOURCE.findall(text)))} files; {MOST_FILES_OF_TOUR} is the most"
    notices = (ROOT / "docs/notices.md").read_text(encoding="utf-8")
    shown = "".join(document.read_text(encoding="utf-8") for document in documents())
    for picture in (ROOT / "docs/pictures").iterdir():
        if f"`{picture.name}`" not in notices:
            yield f"notices.md names no licence of {picture.name}"
        if f"pictures/{picture.name}" not in shown:
            yield f"no document shows {picture.name}"
    if words > MOST_WORDS:
        yield f"all documents have {words} words; {MOST_WORDS} is the most"


def self_test():
    text = "# Some `code`: a title\n\n```\npertev render a \\\n  -o b  # why\ntools/x.py && ./setup.sh\n# no\n```\n\n    pertev view c\n"
    assert anchors_of(text) == {"some-code-a-title"}, anchors_of(text)
    assert commands(text) == ["pertev render a    -o b", "tools/x.py", "./setup.sh", "pertev view c"], commands(text)
    assert commands("```\nx && ctest  # why\n# why\n```\n```python\nctest\n```\n    ninja\n    f = m a\n") == ["ctest", "ninja"]
    listed = "".join(f"```\n{begin}x\n```\n" for begin, _, _ in RUN_BY)
    assert not list(runner_faults({"x": listed + "```sh\nctest -N\n```\n```text\nx\n```\n    x\n"}))
    assert len(list(runner_faults({"x": listed + "```\nx --y && ctest -N\n# why\n```\n"}))) == 1
    assert len(list(runner_faults({"x": ""}))) == len(RUN_BY) and "venv/bin/pip install ." in nightly_commands()
    rows = "<!-- figures -->\n| what | a |\n|---|---|\n{}<!-- end -->\n## Question and file\n| question | file |\n{}"
    for figures, questions, count in ((10, 15, 0), (9, 15, 1), (10, 14, 1), (9, 14, 2)):
        assert len(list(status_faults(rows.format("| x | 1 |\n" * figures, "| a? | b | c? | d |\n" * questions)))) == count
    assert inline_commands("a `pertev render\nX` b\n```\n`pertev no`\n```\n") == ["pertev render X"]
    here = ROOT / "docs" / "tour.md"
    assert list(link_faults(here, "[a](none.md)", lambda _: "")) and list(link_faults(here, "[a](#none)", lambda _: "# some"))
    assert not list(link_faults(here, "[a](tour.md#some) [b](https://x.y)", lambda _: "# Some"))
    assert list(source_faults("x", "`render/none.h`", ["src/render/film.h"]))
    assert not list(source_faults("x", "`render/film.h` `film.h` `src/render/film.h`", ["src/render/film.h"]))
    table = ON_PAPER + "\n| change | own | outside |\n| x | `new.h` | {}: `a/b.h`, `c.h` |\n"
    assert len(list(change_faults(table.format(2), {"a/b.h"}))) == 1 and len(list(change_faults(table.format(3), {"a/b.h", "c.h"}))) == 1
    assert list(command_faults("x", "a `tools/check_sizes.py --none` b", [])) and list(command_faults("x", "    tools/none.py a", [])) and list(command_faults("x", "    cmake --preset none", ["cpu"]))
    assert list(script_faults("x", "tools/check_sizes.py --none")) and list(script_faults("x", "bench/none a"))
    assert list(script_faults("x", "python3 examples/turntable.py a --none")) and not list(script_faults("x", "python3 examples/turntable.py --fps 3"))
    assert not list(script_faults("x", "tools/check_sizes.py -- --none")) and not list(script_faults("x", "bench/trace_bench"))
    assert list(own_faults("x", "tools/none.py or --none", "", "")) and not list(own_faults("x", "--a-b, --c", '"--a-b"', '"--c"'))
    assert list(help_faults("x", 'if __name__ == "__main__":')) and not list(help_faults("x", 'import argparse\nif __name__ == "__main__":'))
    assert list(import_faults("x", "import a.b", {"b"})) and list(import_faults("x", "from a import b", {"b"}))
    assert not list(import_faults("x", 'import json, b\nif "--help" in c:\n    d()\nimport a', {"b"}))
    assert list(metadata_faults("x", '{"pertev.a", b}', "`b`", "`--b`")) and not list(metadata_faults("x", '"pertev.a" "pertev.b_c"', "`a`", "`--b-c`"))
    assert list(named_faults("x", "// see tools/none.py")) and not list(named_faults("x", "// bench/jobs.json has it"))
    assert "--self-test" in parts_of(pathlib.Path(__file__))[0] and "--self-test" in parts_of(pathlib.Path(__file__))[1]
    assert len(list(own_commands())) > 80 and not list(broken_links(len))

    def refuse(link):
        raise OSError(link)
    assert list(broken_links(refuse))
    for target in ("The aim of 2,500 fewer is missed", "The limit is six files outside", "sketches met it at 0c4e", "where 3,000 were planned"):
        assert TARGETS.search(target), target
    assert not TARGETS.search("The limit is the GPU's; a ray is aimed at 3 targets of each kind.")
    assert TARGETS.search("1.3 was asked for") and TARGETS.search("S5 is") and not TARGETS.search("`S5` and --job S5|S8")


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return 0
    if arguments == ["--commands"]:
        print("\n".join(nightly_commands()))
        return 0
    faults = list(faults_of_all() if arguments != ["--links"] else broken_links(lambda link: urllib.request.urlopen(link, timeout=30).close()))
    print("\n".join(faults) or "documents name what is there")
    return 1 if faults else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main(sys.argv[1:]))
