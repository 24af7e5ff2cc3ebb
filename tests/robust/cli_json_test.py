#!/usr/bin/env python3
"""`--json`: standard output always has one object per line, and the last one has the result."""

import json
import pathlib
import signal
import subprocess

from cli_run import FLOOR, KEYS, PROGRAM, CliTest, main, write

NAMES = {2: "bad_input", 3: "over_limit", 6: "file_write", 75: "interrupted"}


def is_number(text):
    try:
        float(text)
        return True
    except ValueError:
        return False


class Errors(CliTest):
    def fail_in_json(self, status, *arguments, **options):
        """Returns the last object. There is no other output."""
        outcome = self.run_pertev(*arguments, **options)
        self.assertEqual((outcome.status, outcome.stderr), (status, ""), outcome)
        last = outcome.events()[-1]
        self.assertEqual((last["event"], last["code"], last["status"], last["interrupted"]),
                         ("error", NAMES[status], status, status == 75), outcome)
        self.assertEqual(len(outcome.events("error")), 1, outcome)
        self.assertEqual(self.run_pertev(*(a for a in arguments if a != "--json"), **options).status, status)
        return last

    def test_errors_of_the_command_line_are_json_objects_for_every_verb(self):
        for verb in ["", "render", "measure", "solve radiosity", "info", "compare", "merge", "bench", "bench rays", "bench build", "bench render", "lab",
                     "lab --thesis"]:
            for rest, says in [("--foo --json", "--foo"), ("--json --foo", "--foo"), ("--json --threads", "--threads")]:
                with self.subTest(verb=verb, rest=rest):
                    last = self.fail_in_json(2, *verb.split(), *rest.split())
                    self.assertIn(says, last["text"])
                    self.assertIn(("pertev " + verb.replace(" --thesis", "")).strip() + " --help", last["help"])
        self.assertIn("render", self.fail_in_json(2, "--json")["text"])

    def test_errors_while_a_verb_runs_are_json_objects(self):
        for line in ["render nowhere.obj -o x.png", "solve radiosity nowhere.obj -o x.rad", "info nowhere.obj", "compare nowhere.exr nowhere.exr",
                     "bench --scene nowhere.obj", "bench rays --scene nowhere.obj", "bench render --scene nowhere.obj",
                     "lab nowhere.obj", "lab --thesis nowhere.obj"]:
            with self.subTest(line=line):
                self.assertIn("nowhere", self.fail_in_json(2, *line.split(), "--json")["text"])
        self.fail_in_json(3, "render", "--json", "cornell-box", "-o", "x.png", "--size", "70000x70000")
        self.fail_in_json(6, "render", "cornell-box", "-o", "nowhere/x.png", "--json", "-q")

    def test_messages_have_setting_names_as_fields_and_flags_in_the_text(self):
        last = self.fail_in_json(3, *"render cornell-box -o x.png --integrator whitted --max-depth 256 --json".split())
        self.assertEqual((last["setting"], last["value"], last["settings"]), ("max_depth", "256", {"integrator": "whitted"}))
        self.assertTrue(last["text"].startswith("--max-depth 256: "), last)
        self.assertIn("--integrator whitted", last["text"])
        write(self.path("bad.ply"), "ply\nformat ascii 1.0\nelement vertex\nend_header\n")
        last = self.fail_in_json(2, *"info bad.ply --json".split())
        self.assertEqual(last["place"], {"file": "bad.ply", "line": 3})
        self.assertEqual(last["text"], f"bad.ply:3: {last['reason']}")
        write(self.path("bad.gltf"), '{"asset":{"version":"2.0"},"extensionsRequired":["X"]}')
        said = self.run_pertev("info", "bad.gltf", "--json").events("warning")[0]
        self.assertEqual(said["place"], {"file": "bad.gltf", "pointer": "/extensionsRequired/0"})
        view = "render cornell-box -o x.png --size 8x8 --spp 1 --eye 0,1,3 --json".split()
        told = [notice for notice in self.run_pertev(*view).events("notice") if notice.get("setting") == "eye"]
        self.assertEqual(told[0]["settings"]["eye"], "0,1,3")
        self.assertIn(f"--eye 0,1,3 --target {told[0]['settings']['target']}", told[0]["text"])
        last = self.fail_in_json(2, *"render cornell-box -o x.png --camera".split(), "it's no camera", "--json")
        self.assertEqual((last["setting"], last["value"]), ("camera", "it's no camera"))
        self.assertIn("--camera 'it'\\''s no camera': ", last["text"]) # quoted for a shell

    def test_json_as_a_value_or_file_name_does_not_switch_json_on(self):
        for arguments in [["info", "--", "--json"], ["render", "cornell-box", "-o", "x.png", "--camera=--json"]]:
            outcome = self.refuse_in_words(*arguments)
            self.assertEqual(outcome.stdout, "")
            self.assertIn("pertev: ", outcome.stderr)

    def refuse_in_words(self, *arguments):
        outcome = self.run_pertev(*arguments)
        self.assertEqual(outcome.status, 2, outcome)
        return outcome

    def test_an_error_goes_to_stderr_if_stdout_cannot_be_written(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            outcome = self.run_pertev("info", "nowhere.obj", "--json", stdout=full)
        self.assertEqual(outcome.status, 6, outcome)
        self.assertIn("nowhere.obj", outcome.stderr)
        self.assertIn("standard output", outcome.stderr)

    def test_an_interrupt_while_the_scene_loads_ends_with_75_and_is_reported(self):
        n = 500
        mesh = "".join(f"v {x} {(x * y) % 7} {y}\n" for y in range(n) for x in range(n))
        mesh += "".join(f"f {x + n * y} {x + 1 + n * y} {x + n + n * y}\n" for y in range(n - 1) for x in range(1, n))
        write(self.path("hills.obj"), mesh)
        for verb in [["render", "hills.obj", "-o", "x.png", "--threads", "1"], ["info", "hills.obj"], ["lab", "hills.obj"]]:
            for kind in [signal.SIGINT, signal.SIGTERM]:
                for flags in [[], ["--json"], ["-q"]]:
                    with self.subTest(verb=verb[0], signal=kind, flags=flags):
                        program = subprocess.Popen([PROGRAM, *verb, *flags], cwd=self.folder, env=self.environment,
                                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                        self.addCleanup(program.kill)
                        self.wait_while(program, is_listening=False)
                        program.send_signal(kind)
                        stdout, stderr = program.communicate(timeout=300)
                        self.assertEqual(program.returncode, 75, stderr)
                        if flags == ["--json"]:
                            last = json.loads(stdout.splitlines()[-1])
                            self.assertEqual((last["code"], last["interrupted"]), ("interrupted", True))
                            self.assertEqual(stderr, b"")
                        else:
                            self.assertTrue(stderr.decode().endswith("pertev: interrupted before the first result\n"))
                            self.assertEqual(stdout, b"")
                        self.assertEqual(self.files(), ["hills.obj"])

    def test_the_last_object_of_an_interrupted_benchmark_is_marked_interrupted(self):
        program = subprocess.Popen([PROGRAM, "bench", "rays", "--device", "cpu", "--json", "--runs", "10000", "--count",
                                    "400000", "--scene", "cornell-box"], cwd=self.folder, env=self.environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        self.wait_while(program, is_listening=False)
        program.send_signal(signal.SIGINT)
        stdout, stderr = program.communicate(timeout=300)
        self.assertEqual((program.returncode, stderr), (75, b""))
        self.assertIs(json.loads(stdout.splitlines()[-1])["interrupted"], True)


class Objects(CliTest):
    def test_render_writes_an_object_each_for_scene_picture_camera_exposure_and_outputs(self):
        write(self.path("floor.obj"), FLOOR)
        view = ["--eye", "0.3,2.1,4.7", "--target", "0.1,0.2,0", "--fov", "33", "--aperture", "0.1"]
        outcome = self.succeed("render", "floor.obj", *view, "-o", "a.png", "-o", "b.exr", "--size", "16x8", "--spp", "2",
                               "--device", "cpu", "--tone-map", "agx", "--json")
        kinds = [event["event"] for event in outcome.events() if event["event"] not in ["notice", "warning", "progress"]]
        self.assertEqual(kinds, ["scene", "picture", "camera", "exposure", "output", "output", "done"])
        scene, picture, camera, exposure, first, second, done = [event for event in outcome.events()
                                                                 if event["event"] in kinds]
        self.assertEqual([scene[key] for key in ["scene", "triangles", "instances"]], ["floor.obj", 2, 1])
        self.assertEqual([picture[key] for key in ["width", "height", "spp"]], [16, 8, 2])
        self.assertEqual(picture["device"], done["device"])
        self.assertEqual((camera["eye"], camera["projection"], camera["fov"]), ([0.3, 2.1, 4.7], "perspective", 33))
        told = self.info("b.exr")
        self.assertEqual((camera["target"], camera["up"]), ([0.1, 0.2, 0], [0, 1, 0]))
        self.assertEqual([len(column) for column in camera["world_from_camera"]], [3, 3, 3, 3])
        self.assertEqual(camera["world_from_camera"][3], camera["eye"])
        self.assertEqual({"pertev." + key: value for key, value in camera.items() if key != "event"},
                         {key: told[key] for key in told if key.startswith("pertev.") and key[7:] in camera})
        self.assertEqual((exposure["auto"], exposure["tone_map"]), (True, "agx"))  # its light is made up
        self.assertEqual([(of["path"], of["written"], of["error"]) for of in [first, second]],
                         [("a.png", True, None), ("b.exr", True, None)])

        again = self.render(*view, "--tone-map", "agx", "--exposure", exposure["stops"], scene="floor.obj", size="16x8", spp=2)
        self.assertEqual(again["hash"], done["hash"])
        self.assertEqual(self.info("picture.png")["hash"], self.info("a.png")["hash"])

    def test_all_vectors_are_arrays_of_numbers(self):
        told = self.succeed("measure", "cornell-box", "--at", "0.3,1e-3,-0.25", "--normal", "0,3,1e-400", "--spp", "1",
                            "--max-depth", "0", "--json").events("measure")[0]
        self.assertEqual((told["at"], told["normal"][:2], len(told["irradiance_rgb"])), ([0.3, 1e-3, -0.25], [0, 3], 3))
        self.assertEqual(float(told["normal"][2]), 0)
        self.render("--integrator", "cast", "--ambient", "0.5,0.25,1", "--environment", "1,2,0.5", output="a.exr")
        made = self.info("a.exr")
        self.assertEqual((made["pertev.ambient"], made["pertev.environment"]), ([0.5, 0.25, 1], [1, 2, 0.5]))
        write(self.path("floor.obj"), FLOOR)
        self.render("--eye", "0,1,4", scene="floor.obj", output="b.exr")
        made = self.info("b.exr")
        self.assertEqual(made["pertev.environment"], "made up")  # this is not a vector
        self.assertEqual(self.info("floor.obj")["bounds_low"], [-1, 0, -1])
        texts = [value for value in made.values() if isinstance(value, str)]
        self.assertFalse([text for text in texts if text.replace(",", " ").split() and
                          all(is_number(word) for word in text.replace(",", " ").split()) and "," in text])

    def test_an_exr_alone_reports_no_exposure(self):
        outcome = self.succeed("render", "cornell-box", "-o", "b.exr", "--size", "8x8", "--spp", "1", "--json")
        self.assertEqual(outcome.events("exposure"), [])


# Files that write keys for several events, beside the file that writes the event.
SHARED = ["apps/cli/bench_parts.cpp", "apps/cli/reporter.cpp", "apps/cli/report_result.cpp", "apps/cli/report_error.h", "apps/cli/flag_phrases.h"]
# Events with keys from elsewhere: the table of settings and metadata; measurements; attributes of an EXR itself ("type").
OTHERS = {"camera": ["src/settings/scene_settings.cpp", "src/session/writing/picture_metadata.cpp"], "lab": ["src/lab/measurement.cpp"],
          "thesis": ["src/lab/measurement.cpp"], "transport": ["src/lab/measurement.cpp"], "info": ["src/image/check_exr_header.cpp"]}


class Lists(CliTest):
    def test_every_listed_key_is_written_where_its_event_is(self):
        root = pathlib.Path(__file__).resolve().parents[2]
        texts = {path: path.read_text(encoding="utf-8") for path in (root / "apps/cli").glob("*.cpp")}
        for event, keys in KEYS.items():
            own = [text for text in texts.values() if f'"{event}"' in text]
            self.assertTrue(own, event)
            text = "".join(own + [(root / file).read_text(encoding="utf-8") for file in SHARED + OTHERS.get(event, [])])
            self.assertEqual([key for key in keys if f'"{key}"' not in text and f'pertev.{key}"' not in text], [], event)


if __name__ == "__main__":
    main()
