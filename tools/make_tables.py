#!/usr/bin/env python3
"""Writes the tables of measured figures in the documents from bench/results/*.json, so that each figure stands in one place.

    tools/make_tables.py           rewrites the tables between the markers
    tools/make_tables.py --check   fails where a document differs from its JSON, or a JSON file from the format
    tools/make_tables.py --self-test

A document has `<!-- table: results/FILE.json NAME -->` ... `<!-- end -->`. After the name may stand `columns=KEY,KEY` and
`where=KEY:VALUE|VALUE`, which select columns and rows. `<!-- figures -->` ... `<!-- end -->` holds the `table` of bench/figures.json.
Numbers keep the digits that the JSON has, or with `digits=N` that many. A unit that all columns of figures share stands once, in the head of the first column.

`date` is when a file was measured; a day alone is that on which the commit `recorded` brought the last of its figures. `program`
names the version. `command` is what makes them today, several between semicolons; words in capitals stand for files, NAME or SCENE
for each that the table has. A null among these has its reason in `unknown`.
"""

import datetime
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys

import check_documents

ROOT = pathlib.Path(__file__).resolve().parent.parent
MARKER = re.compile(r"(<!-- table: (results/\S+\.json) (\S+)([^>]*?) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
FIGURES = re.compile(r"(<!-- figures -->\n)(.*?)(<!-- end -->)", re.DOTALL)
FRAGMENT = re.compile(r"(?:of|what|where|from|to|those|as|beside|its|their)\b", re.IGNORECASE)
KEYS = {"format", "version", "program", "date", "command", "processor", "threads", "device", "driver", "title", "tables"}


class Digits(float):
    """A number that remembers its digits, so that 1.10 stays 1.10."""

    def __new__(cls, text):
        number = super().__new__(cls, text)
        number.text = text
        return number

    def __str__(self):
        return self.text


def load(text):
    return json.loads(text, parse_float=Digits, parse_int=Digits)


def faults_of(name, measured):
    """Messages about everything that keeps a file from being a measurement; empty if it is one."""
    if not isinstance(measured, dict) or measured.get("format") != "pertev-measurement" or measured.get("version") != 1:
        return [f"{name}: not a pertev-measurement of version 1"]
    if lacks := sorted(KEYS - measured.keys()):
        return [f"{name}: lacks {', '.join(lacks)}"]
    faults = [f"{name}: {fault}" for fault in origin_faults(measured)]
    names = [table["name"] for table in measured.get("tables", [])]
    if len(names) != len(set(names)) or not names:
        faults.append(f"{name}: tables have no names, or two have one")
    titles = [measured["title"], *(table["title"] for table in measured.get("tables", []))]
    faults += [f"{name}: a title names what was measured: {title}" for title in titles if FRAGMENT.match(title)]
    for table in measured.get("tables", []):
        keys = [column["key"] for column in table["columns"]]
        if titles := [column["title"] for column in table["columns"] if re.search(r"(?:^|, )(?:s|ms|%|[MG](?:rays|samples)/s)$", column["title"])]:
            faults.append(f"{name}: {table['name']}: the unit of {titles[0]} stands in its title")
        if len(keys) != len(set(keys)):
            faults.append(f"{name}: {table['name']}: two columns have one key")
        if any(len(row) != len(keys) for row in table["rows"]) or not table["rows"]:
            faults.append(f"{name}: {table['name']}: a row has more or fewer cells than there are columns")
    return faults


def origin_faults(measured):
    """Messages about values that do not say what was measured when, where and how."""
    unknown = measured.get("unknown", {})
    for key in ("date", "program", "command", "processor"):
        is_known = isinstance(measured[key], str) and measured[key] != "" and key not in unknown
        if not is_known and not (measured[key] is None and unknown.get(key)):
            yield f"{key} is neither a text nor null with a reason in unknown"
    date, program, command = (measured[key] for key in ("date", "program", "command"))
    if isinstance(date, str):
        try:
            has_day_alone = len(date) == 10 and bool(datetime.date.fromisoformat(date))
            if not has_day_alone and datetime.datetime.fromisoformat(date.replace("Z", "+00:00")).tzinfo is None:
                yield f"the date {date} has no time zone"
            if has_day_alone != bool(re.fullmatch("[0-9a-f]{7,40}", measured.get("recorded", ""))):
                yield "a day alone, and nothing else, has the commit that recorded it"
        except ValueError:
            yield f"{date} is no date"
    if isinstance(program, str) and not re.fullmatch(r"pertev (?:\d+\.\d+\.\d+ )?\(?[0-9a-f]{7,}\+?\)?", program):
        yield f"the program {program} names no commit"
    for one in command.split("; ") if isinstance(command, str) else []:
        if not re.match(r"(?:(?:\S*/)?(?:pertev|pertev_tests|trace_bench)|(?:tools|bench|tests)/\S+|setup\.sh|\.ci/run)(?: |$)", one):
            yield f"{one} begins with neither the program nor a script"
        if re.search(r"\||\[|, (?:and|in|once) | (?:with|of each) ", one):
            yield f"{one} is no command that a shell takes; remarks go to `notes`"
        if (script := ROOT / one.split(" ")[0]).is_file() and not os.access(script, os.X_OK):
            yield f"{one}: the script is not executable"
        yield from check_documents.script_faults("command", one)
        if "trace_bench " in one:
            own = (ROOT / "bench/trace_bench.cpp").read_text(encoding="utf-8")
            yield from (f"{one}: there is no {flag}" for flag in check_documents.FLAG.findall(one) if f'"{flag}' not in own)
        for pattern in re.findall(r"--source-file='?([^\s']+)", one):
            if not any((ROOT / "tests").rglob(pattern)):
                yield f"{one}: there is no such test"
    if (measured["device"] is None) != (measured["driver"] is None) and "driver" not in measured.get("unknown", {}):
        yield "a device has a driver"


def peer_faults(files, peers):
    """Messages about figures of other programs in a measurement that are not those of bench/figures.json, to the digits that are written."""
    kept = [("results/jobs_h200.json", "jobs", "jobs", {"mitsuba_3_9": ("mitsuba", 1e-6), "pbrt_v4": ("pbrt", 1e-6)}),
            ("results/device_builds_h200.json", "builds", "scenes", {key: (f"{key}_s", 1e3) for key in ("optix_fast_trace", "optix_fast_build")})]
    for name, table, group, columns in kept:
        table = next(one for one in files[name]["tables"] if one["name"] == table)
        keys = [column["key"] for column in table["columns"]]
        for row, reached in zip(table["rows"], peers[group].values(), strict=True):
            for key, (source, unit) in columns.items():
                figure = row[keys.index(key)]
                if abs(figure - unit * reached[source]) > 0.02 * figure:
                    yield f"{name}: {row[0]}: {key} is {figure}, in bench/figures.json {unit * reached[source]:g}"


def unknown_commits(files):
    """Messages about commits that are missing in Git; none where there is no Git, or not its whole history."""
    named = [(name, commit) for name, measured in files.items() for key in ("program", "recorded")
             for commit in re.findall(r"\b[0-9a-f]{7,12}\b", measured.get(key) or "")]
    run = lambda *words: subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False).stdout
    if run("rev-parse", "--is-shallow-repository") != "false\n":
        return []
    history = run("rev-list", "HEAD").splitlines()  # Git may know other commits, which no clone gets
    known = {commit[:digits] for commit in history for digits in range(7, 13)}
    return [f"{name}: there is no commit {commit}" for name, commit in named if commit not in known]


def equal_titles(files):
    """Messages about titles that two measurements have, because the report page's contents could not tell them apart."""
    first = {}
    for name, measured in files.items():
        if first.setdefault(measured["title"], name) != name:
            yield f"{name}: {first[measured['title']]} has the same title"


def pick(table, options):
    """Indices of the columns and the rows that the options select, and the number of digits, or None."""
    keys = [column["key"] for column in table["columns"]]
    columns, rows, digits = list(range(len(keys))), table["rows"], None
    for word in options.split():
        what, value = word.split("=", 1)
        if what == "columns":
            columns = [keys.index(key) for key in value.split(",")]
        elif what == "digits":
            digits = int(value)
        elif what == "where":
            key, values = value.split(":", 1)
            wanted = {v.replace("_", " ") for v in values.split("|")}
            rows = [row for row in rows if str(row[keys.index(key)]).replace("_", " ") in wanted]
            unmet = wanted - {str(row[keys.index(key)]).replace("_", " ") for row in rows}
            if unmet:
                raise ValueError(f"{word} names {', '.join(sorted(unmet))}, which no row is")
        else:
            raise ValueError(f"{word} is none of columns=, where= and digits=")
    return columns, rows, digits


def source_of(path, measured, up="../"):
    """One line that says where the figures come from. `up` leads from the document's folder to that of the sources."""
    where = measured["device"] or ("any machine" if measured["processor"] == "any" else measured["processor"])
    parts = [where, f"driver {measured['driver']}" if measured["driver"] else None,
             (measured["program"] or "").removeprefix("pertev "), (measured["date"] or "")[:10]]
    return f"([{pathlib.PurePath(path).stem}]({up}bench/{path}): {', '.join(p for p in parts if p)})\n"


def render(path, measured, name, options, up="../"):
    table = next((t for t in measured["tables"] if t["name"] == name), None)
    if table is None:
        raise ValueError(f"{path} has no table {name}")
    columns, rows, digits = pick(table, options)
    heads = [table["columns"][c] for c in columns]
    numeric = [any(isinstance(row[c], Digits) for row in rows) and i > 0 for i, c in enumerate(columns)]
    units = [h["unit"] for h in heads if h.get("unit")]
    shared = units[0] if len(units) > 1 and len(set(units)) == 1 and len(units) >= sum(numeric) else None

    def title(index, head):
        unit = (shared if index == 0 else None) if shared else head.get("unit")
        return ", ".join(part for part in (head["title"], unit) if part)

    def cell(value):
        if digits and isinstance(value, Digits):
            return f"{value:.{digits}g}"
        return "" if value is None else str(value).replace("|", "\\|").replace("*", "\\*")

    lines = ["| " + " | ".join(title(i, h) for i, h in enumerate(heads)) + " |",
             "|" + "|".join("---:" if n else "---" for n in numeric) + "|"]
    lines += ["| " + " | ".join(cell(row[c]) for c in columns) + " |" for row in rows]
    return "\n" + "\n".join(lines) + "\n\n" + source_of(path, measured, up)


def figures(rows, read):
    """The `table` of bench/figures.json. In its texts {KEY} stands for a value of the row whose first cell is `row`, and {KEY / OTHER} for a
    ratio of two; without `row` a value is the geometric mean of the column, or of several as in {KEY+OTHER}."""
    lines = ["| what | Pertev | other program | ratio | data |", "|---|---:|---:|---:|---|"]
    for one in rows:
        table = next(t for t in read(one["file"])["tables"] if t["name"] == one["table"])
        keys = [column["key"] for column in table["columns"]]

        def value(key):
            cells = [row[keys.index(part)] for part in key.split("+") for row in table["rows"] if row[0] == one.get("row", row[0])]
            if not cells or len(cells) > 1 and "row" in one:
                raise ValueError(f"{one['file']} has not one row {one.get('row')}")
            return cells[0] if len(cells) == 1 else statistics.geometric_mean(cells)

        def digits(number):
            return f"{number:.0f}" if number >= 100 else f"{number:#.3g}"

        def said(match):
            return digits(value(match[1]) / value(match[2])) if match[2] else str(value(match[1])) if "row" in one else digits(value(match[1]))

        cells = [re.sub(r"\{([\w+]+)(?: / (\w+))?\}", said, one[key]) for key in ("what", "pertev", "beside", "ratio")]
        lines.append(f"| {' | '.join(cells)} | [{pathlib.PurePath(one['file']).stem}](../bench/{one['file']}) |")
    return "\n" + "\n".join(lines) + "\n\n"


def remade(text, read, up="../"):
    text = MARKER.sub(lambda m: m[1] + render(m[2], read(m[2]), m[3], m[4], up) + m[6], text)
    return FIGURES.sub(lambda m: m[1] + figures(json.loads((ROOT / "bench/figures.json").read_text(encoding="utf-8"))["table"], read) + m[3], text)


def self_test():
    good = {"format": "pertev-measurement", "version": 1, "program": "pertev 0adaae0", "date": "2026-11-26T16:12:08+00:00",
            "command": "pertev bench; tools/make_tables.py --check", "processor": "P", "threads": 2, "device": None, "driver": None, "title": "T",
            "tables": [{"name": "a", "title": "A", "columns": [{"key": "k", "title": "scene", "unit": None},
                                                              {"key": "r", "title": "rays", "unit": "Mrays/s"},
                                                              {"key": "s", "title": "seconds", "unit": "s"}],
                        "rows": [["Sponza", Digits("1.10"), None], ["two words", Digits("2"), Digits("3e-5")]]}]}
    assert not faults_of("x", good)
    assert faults_of("x", {**good, "title": "What it takes"}) and faults_of("x", {**good, "tables": [{**good["tables"][0], "title": "As before"}]})
    assert faults_of("x", {**good, "version": 2}) and faults_of("x", {k: v for k, v in good.items() if k != "device"})
    assert faults_of("x", {**good, "tables": good["tables"] * 2})
    assert faults_of("x", {**good, "tables": [{**good["tables"][0], "columns": [{"key": "k", "title": "a, ms", "unit": None}], "rows": [[1]]}]})
    for key, bad in (("date", ["2026-11-26", "2026-11-26T16:12:08", "2026-13-01", ""]), ("program", ["pertev", "", 3]), ("driver", ["1"]),
                     ("command", ["", "x", "pertev bench; ", "tools/none.py", "tools/mutations.py", "tools/check_sizes.py --none", "pertev_tests --source-file=none", "build/bin/trace_bench a --none", "pertev bench --job S5|S8", "pertev bench, and later"])):
        for value in [*bad, None] if key != "driver" else bad:
            assert faults_of("x", {**good, key: value}), (key, value)
            assert key == "driver" or value is not None or not faults_of("x", {**good, key: value, "unknown": {key: "Why."}})
    assert faults_of("x", {**good, "unknown": {"date": "Why."}}) and faults_of("x", {**good, "recorded": "0adaae0"})
    assert not faults_of("x", {**good, "date": "2026-11-26", "recorded": "0adaae0"})
    assert not list(equal_titles({"x": {"title": "T"}, "y": {"title": "U"}})) and len(list(equal_titles({"x": {"title": "T"}, "y": {"title": "T"}}))) == 1
    assert unknown_commits({}) == [] and len(unknown_commits({"x": {"recorded": "0" * 9}})) in (0, 1)
    tables = {"results/jobs_h200.json": {"tables": [{"name": "jobs", "columns": [{"key": key} for key in ("j", "mitsuba_3_9", "pbrt_v4")], "rows": [["S", 9.5, 7]]}]},
              "results/device_builds_h200.json": {"tables": [{"name": "builds", "columns": [], "rows": []}]}}
    for mitsuba, count in ((9.5e6, 0), (9.0e6, 1)):
        assert len(list(peer_faults(tables, {"jobs": {"S": {"mitsuba": mitsuba, "pbrt": 7e6}}, "scenes": {}}))) == count
    text = render("results/x.json", good, "a", "")
    one_unit = {**good, "tables": [{**good["tables"][0], "columns": [{**column, "unit": "s" if k else None} for k, column in enumerate(good["tables"][0]["columns"])]}]}
    assert source_of("results/x.json", {**good, "processor": "any"}) == "([x](../bench/results/x.json): any machine, 0adaae0, 2026-11-26)\n"
    assert source_of("results/x.json", {**good, "processor": "any"}, "").startswith("([x](bench/results")
    assert "| scene, s | rays | seconds |" in render("results/x.json", one_unit, "a", "")
    assert "| scene | rays, Mrays/s | seconds, s |" in text and "| Sponza | 1.10 |  |" in text and "3e-5" in text, text
    chosen = render("results/x.json", good, "a", "columns=k,r where=k:two_words")
    assert "1.10" not in chosen and "| two words | 2 |" in chosen, chosen
    assert "| two words | 2 | 3e-05 |" in render("results/x.json", good, "a", "digits=2")
    chosen = {"what": "w", "pertev": "{r}", "beside": "O: {s}", "ratio": "{r / s}", "file": "results/x.json", "table": "a", "row": "two words"}
    assert "| w | 2 | O: 3e-5 | 66667 | [x](../bench/results/x.json) |" in figures([chosen], lambda _: good)
    del chosen["row"]
    assert "| 1.48 | O |" in figures([{**chosen, "pertev": "{r}", "beside": "O", "ratio": ""}], lambda _: good)
    full = {**good, "tables": [{**good["tables"][0], "rows": [["Sponza", Digits("1.10"), Digits("3")], ["two words", Digits("2"), Digits("3e-5")]]}]}
    assert "| 0.119 | O |" in figures([{**chosen, "pertev": "{r+s}", "beside": "O", "ratio": ""}], lambda _: full)
    document = "before\n<!-- table: results/x.json a -->\nold 1.2\n<!-- end -->\nafter\n"
    once = remade(document, lambda _: good)
    assert "old" not in once and once == remade(once, lambda _: good) and once.endswith("after\n")
    assert once != remade(once.replace("1.10", "1.20"), lambda _: good).replace("Sponza", "Other")


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return 0
    check = arguments == ["--check"]
    if arguments and not check:
        print(__doc__, file=sys.stderr)
        return 2
    faults, seen = [], {}
    for path in sorted((ROOT / "bench/results").glob("*.json")):
        name = f"results/{path.name}"
        seen[name] = load(path.read_text(encoding="utf-8"))
        faults += faults_of(name, seen[name])
    faults += unknown_commits(seen)
    faults += equal_titles(seen)
    faults += peer_faults(seen, json.loads((ROOT / "bench/figures.json").read_text(encoding="utf-8")))
    for document in check_documents.documents():
        text = document.read_text(encoding="utf-8")
        if text.count("<!-- table:") != len(MARKER.findall(text)):
            faults.append(f"{document.name}: a table's marker is not well formed, or has no end")
        try:
            new = remade(text, lambda name: seen[name], "../" if document.parent != ROOT else "")
        except (KeyError, ValueError) as error:
            faults.append(f"{document.name}: {error}")
            continue
        if new != text and check:
            faults.append(f"{document.name}: a table differs from its JSON; run tools/make_tables.py")
        elif new != text:
            document.write_text(new, encoding="utf-8")
            print(f"{document.name} is written")
    print("\n".join(faults) or f"{len(seen)} files of measurements; documents have their figures")
    return 1 if faults else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main(sys.argv[1:]))
