#!/usr/bin/env python3
"""Refuses comments and commit subjects that begin as a fragment, vague words in comments and in text for users, and subjects that are too long.

A comment, docstring or trailing comment names a thing or is a sentence, and is understood without its neighbour. One that
begins with a word of FRAGMENTS leans on another one, and the comment of a declaration that begins with one of CLAUSES is
half a sentence; so is a trailing comment that begins with one of JOINTS. Strings of make_* programs are searched for comments, too. VAGUE are words with a plain or standard one: name who acts, say "emitter", "truncated", "except". Names
in backquotes and quotes of a comment are not checked.

Text for users is checked for VAGUE, except for "lamp", which is their word: documents, string literals and templates of C++ and
JavaScript, HTML, and tests' names. Strings of tests are often files or keys, so only names of tests are checked there, and strings
without a space are keys everywhere. A comment behind a command in a document is no fragment either. Subjects are checked for the commits that follow the one that added
the check; where there is no git or no history, they are not checked.

`check_words.py [ROOT]` checks the tree, `--self-test` checks this tool on text that it must refuse or accept.
"""

import ast
import pathlib
import re
import subprocess
import sys
import tempfile
import tokenize

FOLDERS = ["src", "apps", "tests", "tools", "bench", "cmake", "python", "examples", ".ci"]
C_SUFFIXES = {".h", ".cpp", ".cu", ".inl", ".js"}
SCRIPT_SUFFIXES = {".cmake", ".sh"}
FRAGMENTS = re.compile(r"[/*!<#\s]*(?:of|what|those|the same|likewise|as|beside)\b", re.IGNORECASE)
CLAUSES = re.compile(r"/// *(?:its|their|whether|why|how|where|when|that|these|it|they|then|and|so|to|from|by|without|with the)\b",
                     re.IGNORECASE)
JOINTS = re.compile(r"(?://+|/\*+|#+)\s*(?:and|or|also|then|which|whose)\b", re.IGNORECASE)
VAGUE = re.compile(r"\b(?:(?:is|are) (?:told|asked|seen)|asked (?:for|about)|somebody|nobody(?!\()|stuff|thrice|the very|but for|"
                   r"cut short|proven|lamps?|what is (?:there|wrong|right|to be)|what had been|for ever|whichever way|as it is,|anew|"
                   r"leaves? no trace|(?:hardly )?anybody|wherever (?:it|they) lies?|as it suits|if said so)\b", re.IGNORECASE)
VAGUE_FOR_USERS = re.compile(VAGUE.pattern.replace("lamps?|", ""), re.IGNORECASE)
LONGEST_SUBJECT = 72

# Strings are matched so that a "//" in one begins no comment; a ' between digits separates them.
TOKEN = re.compile(
    r"""R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])*'|//[^\n]*|/\*(?:.|\n)*?\*/""")


def comments_of_c(text):
    """Yields (line, text) of each comment in C++ or JavaScript; lines that continue a comment belong to its first."""
    yield from joined(lines_of_comments(text))


def joined(comments):
    """Yields (line, text) of comments from (line, text, whether it continues the one before)."""
    first, whole = 0, ""
    for line, text, is_continued in comments:
        if not is_continued and whole:
            yield first, whole
        first, whole = (first, f"{whole}\n{text}") if is_continued else (line, text)
    if whole:
        yield first, whole


def lines_of_comments(text):
    line, seen, column_above = 1, 0, {}
    for match in TOKEN.finditer(text):
        line += text.count("\n", seen, match.start())
        seen = match.start()
        if not match[0].startswith(("//", "/*")):
            continue
        before = text[text.rfind("\n", 0, seen) + 1:seen]
        is_continued = not before.strip() and column_above.get(line - 1) == len(before)
        column_above[line] = len(before)
        yield line, match[0], is_continued


def comments_of_python(text, name):
    """Yields (line, text) of each comment and docstring in Python."""
    for node in ast.walk(ast.parse(text, name)):
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node):
            yield node.body[0].lineno, ast.get_docstring(node)
    yield from joined(lines_of_python_comments(text))


def lines_of_python_comments(text):
    column_above = {}
    for token in tokenize.generate_tokens(iter(text.splitlines(keepends=True)).__next__):
        if token.type == tokenize.COMMENT:
            line, column = token.start
            yield line, token.string, not token.line[:column].strip() and column_above.get(line - 1) == column
            column_above[line] = column


def comments_of_script(text):
    """Yields (line, text) of each comment in a shell script or a CMake file. A "#" in quotes of its line begins none."""
    yield from joined(lines_of_script_comments(text))


def lines_of_script_comments(text):
    column_above = {}
    for line, content in enumerate(text.splitlines(), 1):
        match = re.match(r"""(?:"(?:\\.|[^"\\])*"|'[^']*'|[^"'#]|(?<=\S)#)*(?<!\S)(?=#)""", content)
        if match and not (line == 1 and content.startswith("#!")):
            yield line, content[match.end():], not match[0].strip() and column_above.get(line - 1) == match.end()
            column_above[line] = match.end()


def comments_of(file):
    """The comments of a file, or nothing if its kind has none."""
    if file.suffix in C_SUFFIXES:
        return comments_of_c(file.read_text(encoding="utf-8"))
    if file.suffix == ".py":
        return comments_of_python(file.read_text(encoding="utf-8"), str(file))
    if file.suffix in SCRIPT_SUFFIXES or file.name == "CMakeLists.txt":
        return comments_of_script(file.read_text(encoding="utf-8"))
    if file.is_file() and not file.suffix:
        text = file.read_bytes()
        if re.match(rb"#!.*sh\n", text):
            return comments_of_script(text.decode("utf-8"))
    return ()


def comments_in_strings(file):
    """Yields (line, text) of each comment in a string of a program that writes sources."""
    strings = []
    if file.name.startswith("make_") and file.suffix in (".py", ".cpp"):
        text = file.read_text(encoding="utf-8")
        strings = strings_of_c(text) if file.suffix == ".cpp" else (
            (node.lineno, node.value) for node in ast.walk(ast.parse(text, str(file)))
            if isinstance(node, ast.Constant) and isinstance(node.value, str))
    for line, string in strings:
        string = string.replace("\\n", "\n")
        for first, comment in [*comments_of_c(string), *comments_of_script(string)]:
            yield line + first - 1, comment


def is_trailing(comment, line):
    """Returns whether something stands before a comment on its line. Docstrings, which have no sign, are no such comments."""
    return comment.startswith(("//", "/*", "#")) and line.split(comment.splitlines()[0])[0].strip() != ""


def comment_faults(root):
    files = [file for folder in FOLDERS for file in sorted((root / folder).rglob("*"))]
    for file in [*files, root / "CMakeLists.txt", *sorted(root.glob("*.sh"))]:
        if not file.exists():
            continue
        for line, comment in comments_in_strings(file):
            if FRAGMENTS.match(comment):
                yield f"{file.relative_to(root)}:{line}: a comment is no fragment: {comment.splitlines()[0]}"
        for line, comment in comments_of(file):
            lines = file.read_text(encoding="utf-8").split("\n") if JOINTS.match(comment) else []
            is_joint = lines and is_trailing(comment, lines[line - 1])
            if FRAGMENTS.match(comment) or CLAUSES.match(comment) or is_joint:
                yield f"{file.relative_to(root)}:{line}: a comment is no fragment: {comment.splitlines()[0]}"
            plain = re.sub(r"`[^`]*`|\"[^\"]*\"|'[^']*'", "", re.sub(r"\s+(?://+|#+|\*)?\s*", " ", comment))
            if vague := VAGUE.search(plain):
                yield f"{file.relative_to(root)}:{line}: \"{vague[0]}\" is vague: ...{plain[max(0, vague.start() - 40):vague.end() + 40]}..."


def prose_of(text):
    """Yields (line, text, is_comment) of each paragraph of a document, with blanks for names in backquotes, and of each comment in a fence."""
    fenced, paragraph, first = False, [], 1
    for line, content in enumerate([*text.splitlines(), ""], 1):
        is_fence = content.startswith("```")
        if not fenced and not is_fence and content.strip():
            first = first if paragraph else line
            paragraph.append(content)
            continue
        if paragraph:
            yield first, re.sub(r"`[^`]*`", lambda name: re.sub(r"[^\n]", " ", name[0]), "\n".join(paragraph)), False
        paragraph = []
        fenced ^= is_fence
        comment = re.search(r"(?:^|\s)(#\s.*)", content) if fenced and not is_fence else None
        if comment:
            yield line, comment[1], True


def strings_of_c(text):
    """Yields (line, text) of each string literal or template of C++ or JavaScript; adjacent literals are one."""
    end, found, line = 0, "", 1
    for match in re.finditer(rf"{TOKEN.pattern}|`(?:\\.|[^`\\])*`", text):
        if match[0].startswith(("//", "/*")):
            continue
        if not found or text[end:match.start()].strip():
            yield line, found
            found, line = "", text.count("\n", 0, match.start()) + 1
        found, end = found + match[0].strip('"'), match.end()
    yield line, found


def names_of_tests(file, text):
    """Yields (line, text) of each test's name."""
    pattern = r"def test_(\w+)" if file.suffix == ".py" else r'(?:TEST_CASE|SUBCASE|TEST_EACH)\w*\(\s*"((?:\\.|[^"\\]|"\s*")*)"'
    for match in re.finditer(pattern, text):
        yield text.count("\n", 0, match.start()) + 1, re.sub(r'"\s*"', "", match[1]).replace("_", " ")


def texts_for_users(root):
    """Yields (file, line, text) of what users and readers of tests see, except for documents."""
    for folder in ("src", "apps", "python", "bench", "tests"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in C_SUFFIXES | {".py", ".html"}:
                continue
            text = file.read_text(encoding="utf-8")
            if folder == "tests":
                yield from ((file, *found) for found in names_of_tests(file, text))
            elif file.suffix in C_SUFFIXES:
                yield from ((file, line, string) for line, string in strings_of_c(text) if " " in string)
            elif file.suffix == ".html":
                yield from ((file, line, content) for line, content in enumerate(text.splitlines(), 1))


def vague_faults(root, file, line, text):
    text_of_line = re.sub(r"\s", " ", text)
    for vague in VAGUE_FOR_USERS.finditer(text_of_line):
        around = text_of_line[max(0, vague.start() - 40):vague.end() + 40]
        yield f"{file.relative_to(root)}:{line + text.count(chr(10), 0, vague.start())}: \"{vague[0]}\" is vague: ...{around}..."


def user_faults(root):
    for file in [*sorted((root / "docs").glob("*.md")), *sorted(root.glob("*.md"))]:
        for line, text, is_comment in prose_of(file.read_text(encoding="utf-8")):
            if is_comment and (FRAGMENTS.match(text) or JOINTS.match(text)):
                yield f"{file.relative_to(root)}:{line}: a comment is no fragment: {text}"
            yield from vague_faults(root, file, line, text)
    for file, line, text in texts_for_users(root):
        yield from vague_faults(root, file, line, text)


def git(root, *arguments):
    """The output of git, or nothing where it fails."""
    try:
        return subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return ""


def commits_after(root, *change):
    """Yields (name, subject) of the commits after the oldest one with a change of this file. In a shallow clone its oldest
    commit counts as that one, so that later ones are checked."""
    changed = git(root, "log", *change, "--format=%H", "--", "tools/check_words.py").split()
    if changed:
        following = f"{changed[-1]}..HEAD"
        for commit in git(root, "log", "--ancestry-path", "--no-merges", "--format=%h %s", following).splitlines():
            yield commit.split(" ", 1)


def subject_faults(root):
    for name, subject in commits_after(root, "--diff-filter=A"):
        if len(subject) > LONGEST_SUBJECT:
            yield f"commit {name}: the subject has {len(subject)} characters, over {LONGEST_SUBJECT}: {subject}"
    for name, subject in commits_after(root, "-S", "FRAGMENTS.match(subject)"):
        if FRAGMENTS.match(subject):
            yield f"commit {name}: a subject is no fragment: {subject}"


# End of a file's name, text, and the line of the fault; 0 if there is none.
CASES = [
    (".h", "int a; // of one\n", 1),
    (".h", "\n/// Those that there are.\nint a;\n", 2),
    (".h", "/// The same of two.\n", 1),
    (".h", "/// Offset of a ray.\n", 0),
    (".h", "/// The ray\n/// of a pixel.\n", 0),
    (".h", "int a; // the ray\n       // of a pixel\n", 0),
    (".h", "int a; // first\nint b; // as the next\n", 2),
    (".cpp", 'auto a = "// of";\n', 0),
    (".cpp", 'auto a = R"(\n// of\n)";\n', 0),
    (".cpp", "int a = 1'000; // what follows 1'000\n", 1),
    (".js", "/** Likewise. */\n", 1),
    (".py", "def f():\n    '''Of one.'''\n", 2),
    (".py", "a = 1  # beside it\n", 1),
    (".py", "a = '# of'\n# A list\n# of names.\n", 0),
    (".h", "/// Whether it is.\nbool a();\n", 1),
    (".h", "/// Its size.\nint a();\n", 1),
    (".h", "// Why it is so\nbool a();\n", 0),
    (".h", "/// That ray, unbounded.\nint a();\n", 1),
    (".h", "/// With the slash.\nint a();\n", 1),
    (".h", "/// With --json, writes an object\n/// to the output.\nint a();\n", 0),
    (".cmake", "set(a b) # of c\n", 1),
    ("/CMakeLists.txt", "# A list\n# of names\nset(a [[#]] \"# of\")\n", 0),
    (".sh", "a=$#\n# What it is\n", 2),
    (".sh", "a='# of'; b=${a#of}\n", 0),
    ("/run", "#!/bin/bash\n# As before\n", 2),
    (".h", "int a; // which is one\n", 1),
    (".h", "int a;\n\nint b; /* And another. */\n", 3),
    (".h", "// Which of several is one\nint a;\n", 0),
    (".h", "int a; // orders\n       // and sizes\n", 0),
    (".py", "a = 1\nb = 2  # or 3\n", 2),
    (".py", "'''Which of these.'''\n# And this.\na = 'b' # a set\n", 0),
    (".sh", "a=1 # then b\n# Then c\n", 1),
    (".h", "/// Takes what a lamp emits.\n", 1),
    (".h", "/// Takes a file, wherever it lies.\n", 1),
    (".cpp", "int a; // the light that is asked\n       // for\n", 1),
    (".py", "a = 1  # nobody steers\n", 1),
    (".h", "/// Drops messages, as nobody() does; `lamp` sets 'a lamp'.\n", 0),
    (".cpp", 'auto a = "lamp";\n', 0),
    (".h", "int a; // the history begins anew\n", 1),
    (".h", "// Their order leaves\n// no trace.\nint a;\n", 1),
    ("/make_a.py", "a = '''b\nclass C: # of d\n# A list\n# of e\n'''\n", 2),
    ("/make_a.py", "a = f'{b} # those of c'\nd = 'e#of e'\n", 1),
    ("/make_a.cpp", 'auto a = "int b; // of c\\n";\n', 1),
    ("/a.cpp", 'auto a = "int b; // of c\\n";\n', 0),
]

# A file's name, text, and the line of the fault in text for users; 0 if there is none.
TEXTS = [
    ("docs/a.md", "# A\n\nThe `view` that\nnobody steers.\n", 4),
    ("docs/a.md", "The lamp, `nobody()` and `stuff`.\n\n```\nstuff --nobody\n```\n", 0),
    ("README.md", "```\na -o b  # of all\n```\n", 2),
    ("README.md", "```\na -o b  # and then\n```\n", 2),
    ("README.md", "```\na -o b  # asked for\n```\n", 2),
    ("README.md", "# Of all\n\n```\na -o b#of  # its pictures\n# A list\n```\n# And more\n", 0),
    ("src/a.cpp", 'auto a = "the view is "\n         "told";\n', 1),
    ("src/a.cpp", 'auto a = "nobody", b = "a lamp", c = "is", d = "told"; // is told\n', 0),
    ("src/a.cpp", 'auto a = R"(one\ntwo is seen)";\n', 2),
    ("apps/a.js", "const a = `x ${b}: nobody steers`;\n", 1),
    ("apps/a.js", "const a = 1;\nf('nobody steers');\n", 2),
    ("apps/a.html", "<p>\n<b aria-label=\"what is there\">\n", 2),
    ("tests/a.cpp", 'TEST_CASE("a client is "\n          "told") {\n f("nobody knows");\n', 1),
    ("tests/a.py", "a = 'nobody knows'\ndef test_a_client_is_told(self):\n    pass\n", 2),
]


def self_test():
    failures = []
    for name, text, line in CASES:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "src" / f"a{name}"
            file.parent.mkdir(parents=True)
            file.write_text(text)
            faults = list(comment_faults(pathlib.Path(folder)))
            if len(faults) != bool(line) or (line and not faults[0].startswith(f"src/a{name}:{line}: ")):
                failures.append(f"{text!r}: {faults}")
    for name, text, line in TEXTS:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
            faults = list(user_faults(pathlib.Path(folder)))
            if len(faults) != bool(line) or (line and not faults[0].startswith(f"{name}:{line}: ")):
                failures.append(f"{text!r}: {faults}")
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder) / "whole"
        (root / "tools").mkdir(parents=True)
        if list(subject_faults(root)):
            failures.append("a folder without history has subjects")
        git(root, "init", "--quiet")
        if git(root, "rev-parse", "--git-dir"):
            identity = ["-c", "user.name=a", "-c", "user.email=a@b"]
            commit = [*identity, "commit", "--quiet", "--allow-empty", "-m"]
            git(root, *commit, "x" * 80)
            (root / "tools" / "check_words.py").write_text("\n")
            git(root, "add", "tools")
            for length in (79, 72, 73, 72):
                git(root, *commit, "x" * length)
            git(root, *commit, "Of a commit before the check")
            (root / "tools" / "check_words.py").write_text("FRAGMENTS.match(subject)\n")
            git(root, "add", "tools")
            for subject in ("What adds the check", "Offsets of rays are whole", "As before"):
                git(root, *commit, subject)
            git(root, "clone", "--quiet", "--depth", "7", f"file://{root}", str(root.parent / "shallow"))
            git(root, "clone", "--quiet", "--depth", "2", f"file://{root}", str(root.parent / "shallowest"))
            expected = ["has 73 characters", "no fragment: As before"]
            for clone, parts in (root, expected), (root.parent / "shallow", expected), (root.parent / "shallowest", expected[1:]):
                faults = list(subject_faults(clone))
                if len(faults) != len(parts) or not all(part in fault for part, fault in zip(parts, faults)):
                    failures.append(f"{clone.name}: {faults}")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        failures = self_test()
        print("\n".join(failures) or "the check refuses and accepts what it should")
        sys.exit(1 if failures else 0)
    root = pathlib.Path(sys.argv[1]) if sys.argv[1:] else pathlib.Path(__file__).resolve().parent.parent
    faults = [*comment_faults(root), *user_faults(root), *subject_faults(root)]
    print("\n".join(faults) or "no comment begins as a fragment, no text is vague, and no subject is too long")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
