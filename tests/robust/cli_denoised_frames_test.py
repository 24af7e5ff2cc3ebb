"""Sequences of denoised frames, whose light goes on from frame to frame: pertev render --frames --denoise svgf."""

import hashlib
import os
import signal
import subprocess
import time

from cli_frames_test import moving_gltf
from cli_run import PROGRAM, CliTest, main, read_exr, write

LINE = ["--size", "32x24", "--spp", "2", "--max-depth", "3", "--device", "cpu", "--fps", "4"]


class DenoisedFrames(CliTest):
    def setUp(self):
        super().setUp()
        write(self.path("m.gltf"), moving_gltf())

    def render(self, folder, *arguments, output="f-#.exr", line=("--denoise", "svgf")):
        os.makedirs(self.path(folder), exist_ok=True)
        flags = [flag for flag in LINE if "--device" not in arguments or flag not in ("--device", "cpu")]
        return self.succeed("render", "m.gltf", "-o", f"{folder}/{output}", *flags, *line, "--json", *arguments)

    def hashes(self, *arguments, **options):
        events = self.render("x", *arguments, **options).events("frame")
        return [event["denoised_hash"] for event in events], [event["hash"] for event in events]

    def pictures(self, folder):
        names = sorted(name for name in os.listdir(self.path(folder)) if name.endswith(".exr"))
        return {name: self.digest(f"{folder}/{name}") for name in names}

    def digest(self, name, *channels):
        """Returns the hash of an EXR's channels, all by default; its metadata have times."""
        pixels = read_exr(self.path(name))[2]
        return hashlib.sha256(repr([(channel, pixels[channel]) for channel in channels or sorted(pixels)]).encode()).hexdigest()

    def test_frames_go_on_from_those_before_them(self):
        denoised, films = self.hashes("--frames", "0-3")
        self.assertEqual(len(set(films)), 4)
        self.assertEqual(self.hashes("--frames", "0-1"), (denoised[:2], films[:2]))
        alone, film = self.hashes("--frames", "3-3")
        self.assertEqual(film, films[3:])  # its own samples
        self.assertNotEqual(alone, denoised[3:])
        cut, films_of_cut = self.hashes("--frames", "0-3", "--cuts", "3")
        self.assertEqual((cut, films_of_cut), ([*denoised[:3], *alone], films))
        self.assertNotEqual(self.hashes("--frames", "0-3", "--history", "2")[0][3], denoised[3])
        self.assertEqual(self.hashes("--frames", "0-3", "--device", "cpu,cpu"), (denoised, films))

    def test_frames_of_a_scene_at_rest_have_other_samples(self):
        os.mkdir(self.path("still"))
        line = ["render", "cornell-box", "-o", "still/f-#.exr", *LINE, "--denoise", "svgf", "--frames", "0-3", "--json"]
        frames = self.succeed(*line).events("frame")
        self.assertEqual([event["samples"] for event in frames], [2] * 4)
        self.assertEqual(len({event["hash"] for event in frames}), 4)
        both = self.succeed("render", "cornell-box", "-o", "two.exr", *LINE[:2], *LINE[4:-2], "--samples", "2:4", "--json").events("done")[0]
        self.assertEqual(both["hash"], frames[1]["hash"])

    def test_without_history_frames_are_single_pictures(self):
        denoised, films = self.hashes("--frames", "0-2", "--history", "0")
        self.assertEqual(self.hashes("--frames", "2-2", "--history", "0"), (denoised[2:], films[2:]))
        self.assertEqual(self.hashes("--frames", "0-2", "--history", "1"), (denoised, films))
        one = self.succeed("render", "m.gltf", "-o", "one.exr", *LINE[:-2], "--denoise", "svgf", "--time", "0.5", "--json").events("done")[0]
        self.assertEqual((one["denoised_hash"], one["hash"]), (denoised[2], films[2]))

    def test_layers_are_those_of_the_frames_samples(self):
        layers = ["--aov", "ids,motion,depth", "--frames", "0-2"]
        self.render("with", *layers)
        self.render("without", *layers, "--history", "0")
        made, plain = ([self.digest(f"{folder}/f-2.exr", name) for name in ("id.instance", "id.primitive", "motion.u", "depth.Z")]
                       for folder in ("with", "without"))
        self.assertEqual(made[:3], plain[:3])
        self.assertNotEqual(made[3], plain[3])
        info = self.info("with/f-2.exr")
        self.assertEqual((info["pertev.history"], info["pertev.frame"], info["pertev.first_frame"], info["pertev.spp"]), (32, 2, 0, 2))
        self.assertNotIn("pertev.history", self.info("without/f-2.exr"))
        for folder, output in (("with", "y-#.exr"), ("without", "y.exr")):
            write(self.path("s.json"), self.succeed("info", f"{folder}/f-2.exr", "--settings").stdout)
            output = "y-#.exr"  # motion needs frames
            again = self.succeed("render", "m.gltf", "-o", output, "--settings", "s.json", "--device", "cpu", "--json").events("frame")[-1]
            self.assertEqual((again["frame"], again["denoised_hash"]), (2, self.info(f"{folder}/f-2.exr")["hash"]))

    def test_continuing_renders_kept_frames_again_or_takes_the_checkpoint(self):
        self.render("whole", "--frames", "0-5", "--cuts", "4")
        expected = self.pictures("whole")
        self.render("parts", "--frames", "0-2", "--cuts", "4")
        end = self.render("parts", "--frames", "0-5", "--cuts", "4", "--continue").events("sequence")[0]
        self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (3, 3, 3))
        self.assertEqual(self.pictures("parts"), expected)
        for missing, again in (("1", 1), ("4", 0), ("5", 1)):
            os.remove(self.path(f"parts/f-{missing}.exr"))
            end = self.render("parts", "--frames", "0-5", "--cuts", "4", "--continue").events("sequence")[0]
            self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (1, 5, again))
            self.assertEqual(self.pictures("parts"), expected)
        kept = ["--cuts", "4", "--checkpoint", "c.pvf", "--continue"]
        self.render("kept", "--frames", "0-1", *kept)
        said = self.render("kept", "--frames", "0-3", *kept, "--device", "cpu,cpu")
        self.assertIn("resumes after frame 1 in c.pvf", [event["text"] for event in said.events("notice")])
        end = self.render("kept", "--frames", "0-5", *kept).events("sequence")[0]
        self.assertEqual((end["written"], end["kept"], end["rendered_again"]), (2, 4, 0))
        self.assertEqual(self.pictures("kept"), expected)
        os.remove(self.path("kept/f-3.exr"))
        self.refuse(2, "render", "m.gltf", "-o", "kept/f-#.exr", *LINE, "--denoise", "svgf", "--frames", "0-5", *kept, "--history", "8",
                    says=["--history"])
        for part in ("2/2", "1/2"):
            self.render("both", "--frames", "0-5", "--cuts", "4", "--part", part)
        self.assertEqual(self.pictures("both"), expected)

    def test_an_interrupt_keeps_the_history_of_the_last_whole_frame(self):
        line = ["render", "cornell-box", "-o", "x/f-##.exr", "--size", "64x64", "--spp", "4", "--device", "cpu",
                "--denoise", "svgf", "--frames", "0-39", "--checkpoint", "c.pvf", "--continue"]
        os.mkdir(self.path("x"))
        program = subprocess.Popen([PROGRAM, *line], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        while program.poll() is None and not os.path.exists(self.path("x/f-02.exr")):
            time.sleep(0.01)
        program.send_signal(signal.SIGINT)
        said = program.communicate(timeout=300)[1].decode()
        self.assertEqual(program.returncode, 75, said)
        end = self.succeed(*line, "--json").events("sequence")[0]
        self.assertEqual((end["rendered_again"], end["written"] + end["kept"]), (0, 40))
        line[3] = "y/f-##.exr"
        os.mkdir(self.path("y"))
        self.succeed(*line[:-3])
        self.assertEqual(self.pictures("x"), self.pictures("y"))

    def test_a_history_needs_frames_and_a_denoiser(self):
        for flags, says in [(["--denoise", "svgf", "--history", "4"], ["--history: needs --frames or --turntable"]),
                            (["--denoise", "svgf", "--cuts", "1"], ["--cuts", "--frames"]),
                            (["--frames", "0-1", "--history", "4"], ["--history: needs --real-time or --denoise svgf"]),
                            (["--frames", "0-1", "--denoise", "svgf", "--passes", "3"], ["--passes: needs --real-time"]),
                            (["--frames", "0-1", "--denoise", "svgf", "--history", "1025"], ["--history"])]:
            self.refuse(2, "render", "cornell-box", "-o", "f-#.exr", "--size", "8x8", "--spp", "1", "--device", "cpu", *flags, says=says)


if __name__ == "__main__":
    main()
