#!/usr/bin/env python3
"""Each command of README.md, CONTRIBUTING.md and docs/ that begins with the program is run at small sizes, on small
substitutes for the files that it names; a viewer until it listens. Commands in PARSED take too long at any size, so only
their verb and flags are checked. Commands of other programs make dry runs: CTest lists its tests, CMake its
presets, Ninja its targets, and scripts their help with their flags. `tools/check_documents.py` checks links and
scripts in sentences."""

import functools
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import unittest

from cli_run import PATIENCE_S, PROGRAM, CliTest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import check_documents  # pylint: disable=wrong-import-position

PARSED = [r"--rays record"] # it needs a public scene
SMALL = {"--size": "24x16", "--spp": "1", "--seconds": "0.02", "--depths": "1-2", "--runs": "1", "--repetitions": "2", "--reference-spp": "2",
         "--frames": "0-1", "--turntable": "2"}
ADDED = {"render": ["--size", "--spp"], "lab": ["--size", "--runs"], "lab --thesis": ["--size", "--runs"], "lab --transport": ["--size", "--seconds", "--repetitions", "--reference-spp"],
         "bench": ["--size", "--spp"], "bench noise": ["--size", "--spp"], "measure": ["--spp"]}
BUILD = pathlib.Path(PROGRAM).resolve().parents[1]
ALONE = {"tools/make_tables.py": ["--check"]} # it would write files
QUICK = {"solve radiosity": ["--patch-size", "0.3", "--patch-rays", "16"], "lab": ["--no-heat-maps"],
         "bench": ["--device", "cpu"], "lab --transport": []}


def as_glb(text):
    body = text.encode() + b" " * (-len(text.encode()) % 4)
    return b"glTF" + b"".join(n.to_bytes(4, "little") for n in (2, 20 + len(body), len(body), 0x4E4F534A)) + body


def verb_of(words):
    """Returns one word or two, with `lab --transport` as a separate verb."""
    if words[0] == "lab" and "--transport" in words:
        return "lab --transport"
    return " ".join(words[:2]) if words[0] in ("bench", "solve") and words[1:] and not words[1].startswith("-") else words[0]


def made_small(words):
    verb, given = "lab --thesis" if "--thesis" in words else verb_of(words), {word.split("=")[0] for word in words}
    small = []
    for before, word in zip(["", *words], words):
        small.append(SMALL.get(before, word))
    for flag in ADDED.get(verb, []):
        small += [] if flag in given else [flag, SMALL[flag]]
    return small + QUICK.get(verb, []) + (["--integrators", "path,light"] if "all" in words else [])


class Commands(CliTest):
    def stand_in(self):
        """Makes the files that commands of the documents name."""
        box = self.path("moving.gltf")
        subprocess.run([sys.executable, ROOT / "tools/make_moving_box.py", box], check=True)
        scene = json.loads(pathlib.Path(box).read_text(encoding="utf-8"))
        scene["animations"][0]["name"] = "wave"
        for name in ["scene.gltf", "room.gltf"]:
            pathlib.Path(self.path(name)).write_text(json.dumps(scene), encoding="utf-8")
        for name in ["robot.glb", "room.glb"]:
            pathlib.Path(self.path(name)).write_bytes(as_glb(json.dumps(scene)))
        shutil.copy(ROOT / "scenes/transport/door.obj", self.path("sponza.obj"))
        shutil.copy(ROOT / "scenes/transport/door.mtl", self.path("door.mtl"))
        for name in ["sky.hdr", "a.exr", "b.exr", "picture.exr", "room.exr"]:
            self.render(scene="room.gltf", size=SMALL["--size"], output=name)
        # Public scenes, below $S.
        for name, of in [("sibenik/sibenik.obj", "sponza.obj"), ("crytek-sponza/sponza.obj", "sponza.obj"),
                         ("gltf/DamagedHelmet/DamagedHelmet.glb", "robot.glb"), ("envmaps/venice_sunset_1k.hdr", "sky.hdr")]:
            pathlib.Path(self.path(name)).parent.mkdir(parents=True)
            shutil.copy(self.path(of), self.path(name))
            if of.endswith(".obj"):
                shutil.copy(self.path("door.mtl"), pathlib.Path(self.path(name)).parent)

    def view(self, words):
        """Runs a viewer until it listens, and ends it as Ctrl-C does."""
        with subprocess.Popen([PROGRAM, *words, "--size", SMALL["--size"], "--port", "0", "--no-browser", "--json"], cwd=self.folder,
                              env=self.environment, stdout=subprocess.PIPE, text=True) as viewer:
            try:
                kinds = [json.loads(line)["event"] for line in iter(viewer.stdout.readline, "")
                         if '"listening"' not in line or viewer.send_signal(signal.SIGINT) is None]
                status = viewer.wait(PATIENCE_S)
            finally:
                viewer.kill()
        self.assertIn("listening", kinds)
        self.assertEqual(status, 0)

    def check_flags(self, words):
        """Tests that the verb and the flags of a command exist."""
        given = {word.split("=")[0] for word in words if re.match(r"--?[a-z]", word)}
        self.assertLessEqual(given, self.flags_of(verb_of(words)), "flags that the verb has not got")

    @functools.cache
    def flags_of(self, verb):
        words = verb.replace(" --transport", "").split()
        text = self.succeed(*words, "--help", "all").stdout if verb.startswith(("render", "view", "bench frames")) else \
            self.succeed(*words, "--help").stdout + self.run_pertev(*words, "--help", "all").stdout
        return set(re.findall(r"(?m)(?<![\w-])--?[a-z][a-z-]*", text))

    def test_commands_of_documents_run(self):
        self.stand_in()
        ran, parsed = 0, 0
        for document in check_documents.documents(ROOT):
            for command in check_documents.commands(document.read_text(encoding="utf-8")):
                words = shlex.split(command)
                if words[0] not in ("pertev", "build/bin/pertev"):
                    continue
                words = [word.replace("$S", ".") for word in words[1:]]
                with self.subTest(document=document.name, command=command):
                    if words[0] == "view":
                        self.view(words)
                        ran += 1
                    elif any(re.search(pattern, " ".join(words)) for pattern in PARSED):
                        self.check_flags(words)
                        parsed += 1
                    else:
                        self.succeed(*made_small(words))
                        ran += 1
        self.assertGreater(ran, 35)
        self.assertEqual(parsed, len(PARSED))

    def test_commands_within_sentences_have_flags_that_exist(self):
        found = 0
        for document in check_documents.documents(ROOT):
            for command in check_documents.inline_commands(document.read_text(encoding="utf-8")):
                words = command.replace("[", "").replace("]", "").replace("|", " ").split()[1:]
                with self.subTest(document=document.name, command=command):
                    self.check_flags([word for word in words if not word.startswith("'")])
                    found += 1
        self.assertGreater(found, 40)

    def test_commands_of_scripts_jobs_and_measurements_have_verbs_and_flags_that_exist(self):
        found = 0
        for name, command in check_documents.own_commands():
            words = command.split()[1:]
            with self.subTest(name=name, command=command):
                verb = verb_of(words).removesuffix(" --transport")
                self.assertIn(f"Usage: pertev {verb} [", self.succeed(*verb.split(), "--help").stdout, "no such verb")
                self.check_flags(words)
                found += 1
        self.assertGreater(found, 80)

    def test_an_unknown_flag_in_a_document_is_found(self):
        self.assertNotIn("--no-such-flag", self.flags_of("view"))
        self.assertIn("--restir", self.flags_of("view"))
        self.assertEqual(self.run_pertev(*made_small(shlex.split("render cornell-box -o a.png --no-such-flag"))).status, 2)

    def said(self, *command):
        """Runs a command in the folder of the sources, which must succeed, and returns its output."""
        done = subprocess.run([str(word) for word in command], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def check_other(self, words):
        """Tests that a command of another program would do something. Scripts without arguments only read, except for ALONE."""
        program, flags = words[0], [word.split("=")[0] for word in words if word.startswith("--")]
        if program == "ctest":
            listed = self.said("ctest", *[BUILD if word == "build" else word for word in words[1:]], "-N")
            self.assertGreater(int(re.search(r"Total Tests: (\d+)", listed)[1]), 0)
        elif program == "cmake":
            presets = self.said("cmake", *(["--build"] if "--build" in words else []), "--list-presets")
            self.assertIn(f'"{words[words.index("--preset") + 1]}"', presets)
        elif program == "ninja":
            self.said("ninja", "-C", BUILD, "-t", "query", words[-1])
        elif re.match(r"build/bin/pertev_\w*tests$", program):
            name = program.rpartition("/")[2]
            if (BUILD / "bin" / name).exists():
                chosen = [word for word in words if word.startswith("--test-case")]
                self.assertGreater(int(re.search(r"filters: (\d+)", self.said(BUILD / "bin" / name, "--count", *chosen))[1]), 0)
            else:
                self.said("ninja", "-C", BUILD, "-t", "query", name)
        elif program == "-m": # python3 has it; tests/python/documents_test.py runs what follows
            self.said(sys.executable, *words[:2], "--help")
        elif program.startswith("examples/"): # tests/python/examples_test.py runs them, where the module is built
            self.assertFalse([flag for flag in flags if f'"{flag}"' not in (ROOT / program).read_text(encoding="utf-8")])
        elif program == "./setup.sh" or program.endswith(".py"):
            usage = self.said(*([sys.executable] if program.endswith(".py") else []), ROOT / program, *(["--help"] if program == "./setup.sh" or words[1:] else ALONE.get(program, [])))
            self.assertFalse([flag for flag in flags if flag not in usage])
        else:
            self.said("bash", "-n", ROOT / program)

    @unittest.skipUnless((BUILD / "build.ninja").exists() and (BUILD / "CTestTestfile.cmake").exists(), "needs the folder of a build")
    def test_commands_of_other_programs_have_an_effect(self):
        asked = set()
        for document in check_documents.documents(ROOT):
            for command in check_documents.commands(document.read_text(encoding="utf-8")):
                words = shlex.split(re.sub(r"^[A-Z_]+=\S+ ", "", command))
                if words[0] not in ("pertev", "build/bin/pertev") and not words[0].startswith("pertev."): # Python has its own tests
                    with self.subTest(document=document.name, command=command):
                        self.assertTrue(not words[0].startswith(("tools/", "./")) or os.access(ROOT / words[0], os.X_OK), "not executable")
                        words = words[1:] if words[0] == "python3" else words
                        self.check_other(words)
                        asked.add(words[0])
        self.assertGreaterEqual(asked, {"ctest", "cmake", "ninja", "./setup.sh", "tools/measure.py", "build/bin/pertev_tests"})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
