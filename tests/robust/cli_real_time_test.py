"""Sequences of pertev render --real-time: frames depend on earlier ones, and sequences are stopped and continued."""

import json
import os
import random
import signal
import subprocess
import threading
import time

from cli_frames_test import moving_gltf
from cli_run import PATIENCE_S, PROGRAM, SANITIZED, CliTest, main, write

KILLS = 1000 if os.environ.get("PERTEV_LONG_TESTS") else 20
SMALL = ["--size", "32x24", "--max-depth", "4", "--device", "cpu"]
LINE = ["--real-time", *SMALL]


def line_with(*arguments):
    """Returns the flags of all sequences, without those that the arguments set."""
    pairs = [SMALL[at:at + 2] for at in range(0, len(SMALL), 2)]
    return ["--real-time", *(text for pair in pairs if pair[0] not in arguments for text in pair)]


class RealTime(CliTest):
    def setUp(self):
        super().setUp()
        write(self.path("m.gltf"), moving_gltf())

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def pictures(self, folder):
        names = sorted(name for name in os.listdir(self.path(folder)) if not name.endswith(".json"))
        return {name: self.read(f"{folder}/{name}") for name in names}

    def render(self, folder, *arguments, scene="m.gltf", output="f-##.png"):
        os.makedirs(self.path(folder), exist_ok=True)
        return self.succeed("render", scene, "-o", f"{folder}/{output}", *line_with(*arguments), "--json", *arguments)

    def refuse_to_render(self, folder, *arguments, says):
        return self.refuse(2, "render", "m.gltf", "-o", f"{folder}/f-##.png", *LINE, *arguments, says=says)

    def test_frames_have_the_hashes_of_bench_sequence(self):
        for number, flags in enumerate([[], ["--restir", "gi", "--no-temporal-gradients"],
                                        ["--resolution-scale", "0.5", "--passes", "2"], ["--integrator", "hybrid"]]):
            for scene, motion in [("m.gltf", ["--frames", "0-3", "--fps", "4"]), ("cornell-box", ["--turntable", "90", "--frames", "0-3"])]:
                with self.subTest(scene=scene, flags=flags):
                    said = self.render(f"a{scene}{number}", *motion, *flags, scene=scene, output="frame-####.png")
                    bench = self.succeed("bench", "sequence", scene, *SMALL, *motion, *flags, "--json")
                    frames = said.events("frame")
                    self.assertEqual(frames[-1]["hash"], bench.events("sequence_errors")[0]["last_frame"])
                    self.assertEqual([event["samples"] for event in frames], [1] * 4)
                    self.assertEqual(len({event["hash"] for event in frames}), 4)

    def test_a_frame_uses_all_frames_since_the_first_and_a_new_sample(self):
        def hashes(*arguments, **options):
            return [event["hash"] for event in self.render("x", *arguments, **options).events("frame")]

        whole = hashes("--frames", "0-3", "--fps", "4")
        self.assertEqual(hashes("--frames", "0-1", "--fps", "4"), whole[:2])
        later = hashes("--frames", "2-3", "--fps", "4")
        self.assertNotEqual(later[0], whole[2])
        self.assertEqual(hashes("--frames", "2-2", "--fps", "4"), later[:1])
        # Frames of a scene at rest differ in their samples, including the first frame.
        still = hashes("--frames", "0-2", scene="cornell-box")
        self.assertEqual(len(set(still)), 3)
        self.assertNotEqual(hashes("--frames", "2-2", scene="cornell-box")[0], still[0])

    def test_all_frames_have_the_exposure_of_the_first(self):
        said = self.render("auto", "--frames", "0-3", "--fps", "1")
        self.assertEqual(len(said.events("exposure")), 1)
        stops = said.events("exposure")[0]["stops"]
        self.render("fixed", "--frames", "0-3", "--fps", "1", "--exposure", stops)
        self.assertEqual(self.pictures("fixed"), self.pictures("auto"))
        single = self.succeed("render", "m.gltf", "-o", "x.png", *SMALL, "--spp", "1", "--time", "0", "--json")
        self.assertEqual(single.events("exposure")[0]["stops"], stops)

    def test_continuing_renders_existing_frames_again_only_for_the_history(self):
        motion = ["--fps", "4", "--restir", "gi"]
        self.render("whole", "--frames", "0-5", *motion)
        expected = self.pictures("whole")
        self.render("parts", "--frames", "0-2", *motion)
        made = {name: os.stat(self.path(f"parts/{name}")).st_mtime_ns for name in self.pictures("parts")}
        for name in ("f-04.png", "f-##.json"):
            write(self.path(f"parts/.{name}.4194305.0"), "no process has this number")
        said = self.render("parts", "--frames", "0-5", "--continue", *motion)
        self.assertEqual(self.pictures("parts"), expected)
        for name, when in made.items():
            self.assertEqual(os.stat(self.path(f"parts/{name}")).st_mtime_ns, when)
        end = said.events("sequence")[0]
        self.assertEqual((end["frames"], end["written"], end["kept"], end["rendered_again"]), (6, 3, 3, 3))

        os.remove(self.path("parts/f-01.png"))  # later frames need not be rendered
        end = self.render("parts", "--frames", "0-5", "--continue", *motion).events("sequence")[0]
        self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (1, 5, 1))
        self.assertEqual(self.pictures("parts"), expected)
        end = self.render("parts", "--frames", "0-5", "--continue", *motion).events("sequence")[0]
        self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (0, 6, 0))
        os.remove(self.path("parts/f-05.png"))
        said = self.succeed("render", "m.gltf", "-o", "parts/f-##.png", *LINE, "--frames", "0-5", "--continue", *motion)
        self.assertIn("frames 0 to 4", said.stderr)

    def test_with_a_checkpoint_no_frame_is_rendered_again(self):
        for number, (devices, flags) in enumerate([("cpu", ["--restir", "gi"]), ("cpu,cpu", ["--resolution-scale", "0.5", "--restir", "di"]), ("cpu,cpu", [])]):
            with self.subTest(flags=flags):
                motion = ["--fps", "4", *flags]
                kept = [*motion, "--checkpoint", f"{number}.pvf", "--device", devices]
                self.render(f"whole{number}", "--frames", "0-6", *motion)
                self.render(f"parts{number}", "--frames", "0-2", *kept)
                said = self.render(f"parts{number}", "--frames", "0-4", "--continue", *kept)
                self.assertIn(f"resumes after frame 2 in {number}.pvf", [event["text"] for event in said.events("notice")])
                end = said.events("sequence")[0]
                self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (2, 3, 0))
                self.flip(f"{number}.pvf")  # the generation before is of frame 2
                end = self.render(f"parts{number}", "--frames", "0-6", "--continue", *kept).events("sequence")[0]
                self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (2, 5, 2))
                self.assertEqual(self.pictures(f"parts{number}"), self.pictures(f"whole{number}"))
                end = self.render(f"parts{number}", "--frames", "0-6", "--continue", *kept).events("sequence")[0]
                self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (0, 7, 0))
                os.remove(self.path(f"parts{number}/f-01.png"))  # before the checkpoint's frame, so that it does not help
                end = self.render(f"parts{number}", "--frames", "0-6", "--continue", *kept).events("sequence")[0]
                self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (1, 6, 1))
                self.assertEqual(self.pictures(f"parts{number}"), self.pictures(f"whole{number}"))

    def test_parts_render_the_history_before_them_and_begin_at_cuts(self):
        for number, (cuts, devices, rendered) in enumerate([("", "cpu", [0, 3, 6]), ("2,5", "cpu", [0, 1, 1]), ("6", "cpu,cpu", [0, 3, 1])]):
            with self.subTest(cuts=cuts):
                motion = ["--frames", "1-9", "--fps", "4", "--restir", "gi", *(["--cuts", cuts] if cuts else [])]
                said = self.render(f"whole{number}", *motion)
                hashes = {event["frame"]: event["hash"] for event in said.events("frame")}
                expected = self.pictures(f"whole{number}")
                for part in (2, 3, 1):
                    said = self.render(f"parts{number}", *motion, "--part", f"{part}/3", "--device", devices)
                    own = {event["frame"]: event["hash"] for event in said.events("frame")}
                    self.assertEqual(own, {frame: hashes[frame] for frame in range(3 * part - 2, 3 * part + 1)})
                    end = said.events("sequence")[0]
                    self.assertEqual((end["frames"], end["written"], end["kept"], end["rendered_again"]), (3, 3, 0, 0))
                    notices = [event["text"] for event in said.events("notice") if "for the history" in event["text"]]
                    self.assertEqual(len(notices), rendered[part - 1] > 0)
                self.assertEqual(self.pictures(f"parts{number}"), expected)

    def test_frames_after_a_cut_are_those_of_a_sequence_that_begins_there(self):
        motion = ["--fps", "4", "--restir", "di", "--aov", "albedo"]
        frames = self.render("cut", "--frames", "0-5", "--cuts", "0,3,9", *motion, output="f-#.exr").events("frame")
        later = self.render("later", "--frames", "3-5", *motion, output="f-#.exr").events("frame")
        self.assertEqual([event["hash"] for event in frames[3:]], [event["hash"] for event in later])
        self.assertNotEqual(frames[4]["hash"], self.render("x", "--frames", "0-4", *motion, output="f-#.exr").events("frame")[4]["hash"])
        info = self.info("cut/f-5.exr")
        self.assertEqual((info["pertev.frame"], info["pertev.first_frame"]), (5, 3))
        write(self.path("s.json"), self.succeed("info", "cut/f-5.exr", "--settings").stdout)
        again = self.succeed("render", "m.gltf", "-o", "y-#.exr", "--settings", "s.json", "--device", "cpu", "--json").events("frame")
        self.assertEqual([(event["frame"], event["hash"]) for event in again][-1], (5, frames[5]["hash"]))
        self.assertEqual(len(again), 3)
        self.refuse_to_render("cut", "--frames", "0-5", "--cuts", "3,3", says=["--cuts 3,3"])
        self.refuse(2, "render", "m.gltf", "-o", "f-#.exr", *SMALL, "--spp", "1", "--frames", "0-5", "--cuts", "3", says=["--cuts", "--real-time"])

    def test_continuing_a_part_renders_runs_that_lack_frames_alone(self):
        motion = ["--frames", "0-11", "--fps", "4", "--cuts", "4,8"]
        self.render("whole", *motion)
        expected = self.pictures("whole")
        self.render("parts", *motion, "--part", "2/2")  # frames 6 to 11, of which 6 and 7 have the history 4 and 5
        for missing, rendered in (("09", 1), ("06", 0), ("11", 3)):
            os.remove(self.path(f"parts/f-{missing}.png"))
            end = self.render("parts", *motion, "--part", "2/2", "--continue").events("sequence")[0]
            self.assertEqual((end["frames"], end["written"], end["kept"], end["rendered_again"]), (6, 1, 5, rendered))
        for name in ("f-07.png", "f-08.png"):
            os.remove(self.path(f"parts/{name}"))
        end = self.render("parts", *motion, "--continue").events("sequence")[0]  # all parts' frames are kept
        self.assertEqual((end["frames"], end["written"], end["kept"], end["rendered_again"]), (12, 8, 4, 1))
        self.assertEqual(self.pictures("parts"), expected)
        self.refuse_to_render("parts", *motion[:-1], "4,9", "--continue", says=["--cuts"])

    def test_a_part_goes_on_from_the_checkpoint_of_the_part_before(self):
        motion = ["--frames", "0-5", "--fps", "4", "--restir", "di"]
        self.render("whole", *motion)
        kept = [*motion, "--checkpoint", "c.pvf", "--continue"]
        for part in ("1/3", "2/3", "3/3"):
            said = self.render("parts", *kept, "--part", part)
            self.assertEqual(sum("for the history" in event["text"] for event in said.events("notice")), 0)
            self.assertEqual(sum("resumes after frame" in event["text"] for event in said.events("notice")), part != "1/3")
        self.assertEqual(self.pictures("parts"), self.pictures("whole"))
        for name in ("f-02.png", "f-03.png"):
            os.remove(self.path(f"parts/{name}"))  # before the checkpoint's frame, which does not help
        said = self.render("parts", *kept, "--part", "2/3")
        self.assertEqual(sum("for the history" in event["text"] for event in said.events("notice")), 1)
        self.assertEqual(self.pictures("parts"), self.pictures("whole"))

    def flip(self, name):
        data = bytearray(self.read(name))
        data[len(data) // 2] ^= 4
        with open(self.path(name), "wb") as file:
            file.write(data)

    def test_a_checkpoint_of_another_sequence_is_refused(self):
        motion = ["--fps", "4", "--frames", "0-2", "--checkpoint", "c.pvf"]
        self.render("x", *motion)
        self.render("y", *motion[:4], "--seed", "3")
        os.remove(self.path("y/f-02.png"))
        self.refuse_to_render("y", *motion, "--seed", "3", "--continue", says=["c.pvf", "--seed"])
        self.refuse(2, "render", "m.gltf", "-o", "x/f-##.png", *SMALL, "--spp", "1", *motion, says=["--checkpoint", "--continue"])
        self.refuse(6, "render", "m.gltf", "-o", "x/f-##.png", *LINE, *motion[:4], "--checkpoint", "nowhere/c.pvf", says=["nowhere/c.pvf"])

    def test_a_sequence_that_is_killed_at_any_moment_loses_one_interval_at_most(self):
        count, moments = 40, random.Random(3)
        line = ["--frames", f"0-{count - 1}", "--fps", "20", "--restir", "di", "--size", "96x72", "--exposure", "0"]
        self.render("whole", *line)
        os.mkdir(self.path("x"))
        line = ["render", "m.gltf", "-o", "x/f-##.png", *line_with(*line), *line, "--continue", "--checkpoint", "c.pvf", "--checkpoint-every", "1e-9"]
        killed = 0
        for _ in range(KILLS):
            program = subprocess.Popen([PROGRAM, *line, "--json"], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
            self.addCleanup(program.kill)
            threading.Timer(moments.uniform(0, 0.3 if not SANITIZED else 6), program.kill).start()
            said = [json.loads(text) for text in program.communicate(timeout=PATIENCE_S)[0].decode().splitlines(keepends=True) if text.endswith("\n")]
            killed += program.returncode == -signal.SIGKILL
            # A frame's checkpoint is written before the next frame begins, so one frame at most has none.
            self.assertLessEqual(sum(event["event"] == "frame" and "kept" in event and "hash" in event for event in said), 1)
            if program.returncode == 0:  # the whole sequence: start again
                self.assertEqual(self.pictures("x"), self.pictures("whole"))
                for name in os.listdir(self.path("x")):
                    os.remove(self.path(f"x/{name}"))
        self.assertGreater(killed, 0)
        print(f"killed {killed} times")
        end = self.succeed(*line, "--json").events("sequence")[0]
        self.assertLessEqual(end["rendered_again"], 1)
        self.assertEqual(self.pictures("x"), self.pictures("whole"))
        self.assertEqual([name for name in self.files() if name.startswith(".")], [])  # files that killed processes left

    def test_frames_with_another_hash_than_recorded_are_refused(self):
        motion = ["--fps", "4", "--frames", "0-3"]
        self.render("x", *motion)
        os.remove(self.path("x/f-03.png"))
        record = json.loads(self.read("x/f-##.json"))
        self.assertEqual([entry["frame"] for entry in record["pictures"]], [0, 1, 2, 3])
        record["pictures"][2]["hash"] = "0" * 32
        write(self.path("x/f-##.json"), json.dumps(record))
        self.refuse_to_render("x", *motion, "--continue", says=["x/f-##.json: ", "frame 2", "0" * 32])
        self.assertFalse(os.path.exists(self.path("x/f-03.png")))

    def test_other_settings_of_the_reconstruction_are_refused(self):
        motion = ["--fps", "4", "--frames", "0-1"]
        self.render("x", *motion)
        for flags in (["--passes", "4"], ["--history", "8"], ["--restir", "di"], ["--restir-history", "3"],
                      ["--resolution-scale", "0.5"], ["--moving-depth", "1"], ["--no-anti-alias"], ["--no-firefly-clamping"], ["--no-history-clamping"],
                      ["--no-temporal-gradients"], ["--no-reconstruction"]):
            self.refuse_to_render("x", *motion, "--continue", *flags, says=[flags[0], "--continue"])
        self.refuse(2, "render", "m.gltf", "-o", "x/f-##.png", *SMALL, "--spp", "1", *motion, "--continue",
                    says=['--real-time is "true" there'])
        self.refuse_to_render("x", "--fps", "4", "--frames", "1-2", "--continue", says=['first frame is "0" there'])

    def test_an_interrupt_ends_after_a_whole_frame_and_continuing_gives_the_same_bytes(self):
        self.check_interrupt(signal.SIGINT)

    def test_a_signal_writes_the_checkpoint_so_that_no_frame_is_rendered_again(self):
        self.check_interrupt(signal.SIGTERM, "--checkpoint", "c.pvf")

    def check_interrupt(self, kind, *more):
        os.mkdir(self.path("x")), os.mkdir(self.path("again"))
        arguments = ["render", "m.gltf", "-o", "x/f-##.png", "--real-time", "--size", "200x150", "--device", "cpu",
                     "--exposure", "0", "--frames", "0-29", "--fps", "20"]
        program = subprocess.Popen([PROGRAM, *arguments, *more], cwd=self.folder, env=self.environment,
                                   stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        while program.poll() is None and not os.path.exists(self.path("x/f-02.png")):
            time.sleep(0.01)
        program.send_signal(kind)
        said = program.communicate(timeout=300)[1].decode()
        self.assertEqual(program.returncode, 75, said)
        self.assertIn("--continue", said)
        there = self.pictures("x")
        self.assertEqual(list(there), [f"f-{k:02}.png" for k in range(len(there))])
        self.assertLess(len(there), 30)
        end = self.succeed(*arguments, *more, "--continue", "--json").events("sequence")[0]
        self.assertEqual((end["kept"], end["rendered_again"], end["written"]), (len(there), 0 if more else len(there), 30 - len(there)))
        arguments[3] = "again/f-##.png"
        self.succeed(*arguments)
        self.assertEqual(self.pictures("x"), self.pictures("again"))

    def test_an_exr_holds_the_frame_its_layers_and_its_settings(self):
        frames = ["--frames", "3-4", "--fps", "4", "--restir", "di", "--passes", "2"]
        said = self.render("x", *frames, "--moving-depth", "0", "--aov", "albedo,ids", output="f-#.exr")
        hashes = [[event["hash"] for event in self.render("z", *frames, *depth).events("frame")] for depth in ([], ["--max-depth", "0"])]
        self.assertEqual([event["hash"] for event in said.events("frame")], hashes[1])
        self.assertNotEqual(*hashes)
        info = self.info("x/f-4.exr")
        self.assertEqual(info["pertev.hash"], said.events("frame")[1]["hash"])
        self.assertEqual((info["pertev.frame"], info["pertev.first_frame"], info["pertev.spp"]), (4, 3, 1))
        made = json.loads(info["pertev.reconstruction"])
        self.assertEqual((made["restir"], made["passes"], made["history"], made["no_anti_alias"]), ("di", 2, 32, False))
        self.assertEqual(made["moving_depth"], 0)
        write(self.path("kept.json"), json.dumps({"version": 1, "settings": made})) # the names are those of the table
        said = self.render("y", "--frames", "3-4", "--fps", "4", "--settings", "kept.json", output="f-#.exr")
        self.assertEqual(said.events("frame")[1]["hash"], info["pertev.hash"])
        self.assertIn("albedo.R", info["channels"])
        self.assertIn('"0":', info["pertev.instances"])
        self.assertEqual(self.info("x/f-3.exr")["pertev.time"], 0.75)
        self.succeed("render", "m.gltf", "-o", "x.exr", *SMALL, "--spp", "1")
        self.assertNotIn("pertev.reconstruction", self.info("x.exr"))

    def test_motion_is_that_of_ordinary_frames_and_none_after_a_cut(self):
        plain = self.succeed("render", "m.gltf", "-o", "p-#.exr", *SMALL, "--spp", "1", "--frames", "0-4", "--fps", "4",
                             "--aov", "motion", "--json").events("frame")
        none = self.succeed("render", "m.gltf", "-o", "n.exr", *SMALL, "--spp", "1", "--aov", "motion", "--json").events("done")[0]
        expected = [none["layers_hash"], *(event["layers_hash"] for event in plain[1:])]
        self.assertEqual(len(set(expected)), 5)
        for number, flags in enumerate([[], ["--resolution-scale", "0.5", "--device", "cpu,cpu"], ["--restir", "gi", "--no-reconstruction"]]):
            line = ["--frames", "0-4", "--fps", "4", "--aov", "motion", *flags]
            said = self.render(f"x{number}", *line, "--cuts", "3", output="f-#.exr").events("frame")
            self.assertEqual([event["layers_hash"] for event in said], [*expected[:3], expected[0], expected[4]])
            without = self.render("y", *line[:4], *flags, "--cuts", "3").events("frame")
            self.assertEqual([event["hash"] for event in said], [event["hash"] for event in without])
        kept = ["--fps", "4", "--aov", "motion", "--checkpoint", "c.pvf", "--continue"]
        self.render("z", "--frames", "0-2", *kept, output="f-#.exr")
        said = self.render("z", "--frames", "0-4", *kept, output="f-#.exr").events("frame")
        self.assertEqual([event.get("layers_hash") for event in said], [None] * 3 + expected[3:])

    def test_settings_that_real_time_frames_do_not_support_are_refused(self):
        motion = "--frames 0-1 --real-time"
        for line, says in [("--real-time", "--frames or --turntable"), ("--real-time --time 1", "--frames"),
                           (f"{motion} --spp 4", "--spp 4: a frame with --real-time has one sample"),
                           (f"{motion} --spp 64", "--spp 64"), (f"{motion} --denoise svgf", "--denoise svgf"),
                           (f"{motion} --transparent", "--transparent"), (f"{motion} --lpe d=LDE", "--lpe"),
                           (f"{motion} --false-color illuminance --false-color-range 1,2", "--false-color illuminance"),
                           (f"{motion} --time-limit 1", "--time-limit"), ("--frames 0-1 --passes 5", "--passes: needs --real-time"),
                           ("--frames 0-1 --restir gi", "--restir: needs --real-time"),
                           ("--no-anti-alias", "--no-anti-alias: needs --real-time")]:
            with self.subTest(line=line):
                self.refuse(2, "render", "m.gltf", "-o", "f-#.exr", "--size", "8x8", "--device", "cpu", *line.split(),
                            says=[says])
        for name in ("cast", "whitted", "distributed", "raster", "light", "bidirectional"):
            self.refuse(2, "render", "m.gltf", "-o", "f-#.png", *LINE, "--frames", "0-1", "--integrator", name,
                        says=["--real-time: ", "--integrator path", name])
        self.assertEqual(self.render("one", "--frames", "0-0", "--spp", "1").events("frame")[0]["samples"], 1)


if __name__ == "__main__":
    main()
