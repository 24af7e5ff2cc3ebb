#!/usr/bin/env python3
"""Fails where src/ names a flag of the command line, and where a text of src/ names a setting that is none.

A library does not know its front end: it names settings ("`max_depth`", base/remark.h), and the command line makes flags
of them. Settings are what apps/cli has flags for, or what src/settings lists. `--self-test` tries both rules.
"""

import pathlib
import re
import sys

SUFFIXES = {".h", ".inl", ".cpp", ".cu"}
FLAG = re.compile(r"(?<![\w)\]-])--(?=[a-z])|\bSCENE\b")
SHORT = re.compile(r"-[a-zA-Z]") # a whole text; some formats of files have such words
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\((.*?)\)\1"|"((?:\\.|[^"\\\n])*)"|\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)
NAMED = re.compile(r"`([a-z][a-z0-9_]*)(?:=[^`]*)?`")
OTHERS = {"scene"} # settings that the command line has without a flag


def comments_and_texts(source):
    """Each with its line. Texts that stand one behind the other are one, so that a name is whole."""
    texts, end = [], None
    for token in TOKEN.finditer(source):
        if token.group().startswith("'"):
            continue
        text = token.group(2) if token.group(2) is not None else token.group(3)
        is_comment = text is None
        if end is not None and not is_comment and not source[end:token.start()].strip():
            texts[-1][1] += text
        else:
            texts.append([source.count("\n", 0, token.start()) + 1, token.group() if is_comment else text, is_comment])
        end = None if is_comment else token.end()
    return texts


def settings_of(cli, tables=()):
    flags = {flag.replace("-", "_") for source in cli for flag in re.findall(r"--([a-z][a-z-]+)", source)}
    return flags | {name for source in tables for name in re.findall(r'"([a-z][a-z0-9_]*)"', source)} | OTHERS


def faults_of(source, settings, is_format=False):
    for line, text, is_comment in comments_and_texts(source):
        if FLAG.search(text) or (not is_format and not is_comment and SHORT.fullmatch(text)):
            yield f"{line}: a flag is named; say the setting's name, `max_depth`, which front ends phrase"
        for name in [] if is_comment else NAMED.findall(text):
            if name not in settings:
                yield f"{line}: `{name}` is no setting; a name between backquotes becomes a flag"


def self_test():
    settings = settings_of(['add("-s,--max-depth", x)'], ['row("eye")'])
    for good in ['f("say `max_depth=3`"); --size; x = a--b;', 'f("a `eye=" "1` b"); // as `fov`', "c = '\"'; --i;",
                 'f("see ARRAY[k--x] --- -- 1");']:
        assert not list(faults_of(good, settings)), good
    for bad in ['f("--max-depth 3")', '// of --lpe', 'f("say `depth`")', 'f(R"(a --eye)")', 'f("(--eye)")', '/* --eye */',
                'f("a `depth"\n  "=1` b")', '{"output", "-o"}', '{"scene", "SCENE"}']:
        assert list(faults_of(bad, settings)), bad
    assert not list(faults_of('option == "-o"', settings, is_format=True))
    assert list(faults_of('\n\nf("a"\n"--b")', settings)) == list(faults_of('\n\nf("a" "--b")', settings))


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return 0
    root = pathlib.Path(arguments[0]) if arguments else pathlib.Path(__file__).resolve().parent.parent
    files = {file: file.read_text(encoding="utf-8") for folder in ["src", "apps/cli"]
             for file in sorted((root / folder).rglob("*")) if file.suffix in SUFFIXES}
    settings = settings_of([text for file, text in files.items() if (root / "src") not in file.parents],
                           [text for file, text in files.items() if (root / "src/settings") in file.parents])
    faults = [f"{file.relative_to(root)}:{fault}" for file, text in files.items() if (root / "src") in file.parents
              for fault in faults_of(text, settings, (root / "src/formats") in file.parents)]
    print("\n".join(faults) or "src/ names settings, and no flag")
    return 1 if faults else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main(sys.argv[1:]))
