#!/usr/bin/env python3
"""Each command of README.md, CONTRIBUTING.md and docs/ that begins with the program is run at small sizes, on small
substitutes for the files that it names; a viewer until it listens. Where ffmpeg is missing, its arguments are checked.
Commands of other programs make dry runs: CTest lists its tests, CMake its presets, Ninja its targets, and scripts their
help with their flags; `tools/check_documents.py` says what runs them. Commands of measurements run on a scene that does
not exist, because their words are read first."""

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

SCENE = re.compile(r"[A-Z]+(?:\.rad)?|\S+\.(?:obj|gltf|exr)|cornell-box|many-lights|caustic") # a scene in commands of measurements
SMALL = {"--size": "24x16", "--spp": "1", "--seconds": "0.02", "--depths": "1-2", "--runs": "1", "--repetitions": "2", "--reference-spp": "2",
         "--frames": "0-1", "--turntable": "2"}
ADDED = {"render": ["--size", "--spp"], "lab": ["--size", "--runs"], "lab --thesis": ["--size", "--runs"], "lab --transport": ["--size", "--seconds", "--repetitions", "--reference-spp"],
         "bench": ["--size", "--spp"], "bench noise": ["--size", "--spp"], "measure": ["--spp"]}
BUILD = pathlib.Path(PROGRAM).resolve().parents[1]
ALONE = {"tools/make_tables.py": ["--check"]} # it would write files
QUICK = {"solve radiosity": ["--patch-size", "0.3", "--patch-rays", "16"], "lab": ["--no-heat-maps"],
         "bench": ["--device", "cpu"], "lab --transport": []}
ROOM = "".join(f"v {x} {y} {z}\n" for x in (-300, 300) for y in (-300, 300) for z in (-300, 300)) + \
    "".join(f"f {face}\n" for face in ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")) # around the camera of the record


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
    if "record" in words: # its rays have a size
        return [*small, "--count", "500", "--runs", "1", *QUICK[verb]]
    for flag in ADDED.get(verb, []):
        small += [] if flag in given else [flag, SMALL[flag]]
    return small + QUICK.get(verb, []) + (["--integrators", "path,light"] if "all" in words else [])


def at_nowhere(words):
    """Returns a command of a measurement with a scene that does not exist."""
    made = []
    for before, word in zip(["", *words], words):
        if before in ("-o", "--job"):
            made.append(word)
        elif word == "NAME":
            made.append("cove" if before == "--preset" else "path")
        else:
            made.append("nowhere.obj" if SCENE.fullmatch(word) else word)
    if "nowhere.obj" in made:
        return made
    return ["lab", "nowhere.obj", *made[1:]] if made[0] == "lab" else [*made, "--scene", "nowhere.obj"]


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
        pathlib.Path(self.path("room.obj")).write_text(ROOM, encoding="utf-8")
        # Public scenes, below $S and $PERTEV_SCENES.
        self.environment["PERTEV_SCENES"] = self.path(".")
        for name, of in [("sibenik/sibenik.obj", "sponza.obj"), ("crytek-sponza/sponza.obj", "room.obj"),
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
        ran, encoded = 0, 0
        for document in check_documents.documents(ROOT):
            for command, must in check_documents.shell_lines(document.read_text(encoding="utf-8")):
                if not must and not check_documents.is_command(command):
                    continue
                words = shlex.split(command.replace("$S", "."))
                if words[0] not in ("pertev", "build/bin/pertev", "ffmpeg"):
                    continue
                with self.subTest(document=document.name, command=command):
                    if words[0] == "ffmpeg":
                        self.encode(words)
                    elif words[1] == "view":
                        self.view(words[1:])
                    else:
                        self.succeed(*made_small(words[1:]))
                    ran += 1
                    encoded += words[0] == "ffmpeg"
        self.assertGreater(ran, 35)
        self.assertEqual(encoded, 1)

    def encode(self, words):
        """Runs ffmpeg on frames that the command before has written, or checks that its arguments name these and a film."""
        if shutil.which("ffmpeg"):
            subprocess.run(words, cwd=self.folder, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            self.assertTrue(os.path.exists(self.path(words[-1])))
            return
        given = dict(zip(words[1:-1:2], words[2:-1:2]))
        self.assertEqual(set(given), {"-framerate", "-i", "-pix_fmt"})
        self.assertGreater(float(given["-framerate"]), 0)
        self.assertTrue(os.path.exists(self.path(given["-i"] % 0)) and os.path.exists(self.path(given["-i"] % 1)), given["-i"])
        self.assertRegex(words[-1], r"\.mp4$")

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

    def test_commands_of_measurements_have_what_their_verbs_require(self):
        made = {tuple(at_nowhere(shlex.split(command)[1:])): name for name, command in check_documents.measured_commands()}
        for words, name in made.items():
            with self.subTest(name=name, command=words):
                self.assertFalse(self.is_misused(words))
        self.assertGreater(len(made), 50)
        for words in ("render nowhere.obj", "bench devices", "bench render --job S5", "render nowhere.obj -o a.exr --size 3"):
            self.assertTrue(self.is_misused(words.split()), words)

    def is_misused(self, words):
        """Returns whether a command on a scene that does not exist fails because of its words."""
        outcome = self.run_pertev(*words, "--json")
        self.assertEqual(outcome.status, 2)
        error = outcome.events("error")[-1]
        return "help" in error or error.get("setting", "scene") not in ("scene", "device", "preset", "solution")

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
        elif program == "-m": # python3 has the module
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
