#!/usr/bin/env python3
"""`render --part` and `--samples`, film files, and `merge`: merged parts are the files of one run, and other files are refused."""

import json
import os
import signal
import struct
import subprocess
import unittest
import zlib

from cli_run import FLOOR, PATIENCE_S, PROGRAM, SANITIZED, CliTest, main, read_exr, write

SMALL = ["--size", "20x16", "--device", "cpu"]
UNMETERED = ["--exposure", "0"]
LUT = b"LUT_3D_SIZE 2\n" + b"".join(f"{i & 1} {i >> 1 & 1} {i >> 2}\n".encode() for i in range(8))


def take_plane(data, at, count):
    """Returns a packed plane by docs/film_file.md, and its end."""
    kind = data[at]
    if kind < 2:
        return (bytes([data[at + 1]]) * count, at + 2) if kind == 0 else (data[at + 1 : at + 1 + count], at + 1 + count)
    end = at + 5 + struct.unpack_from("<I", data, at + 1)[0]
    return zlib.decompress(data[at + 5 : end], -15), end


def take_sums(data, at, count, before):
    """Returns the packed sums of a channel, and their end."""
    lengths, at = take_plane(data, at, count)
    lowest, at = take_plane(data, at, count)
    ends = [((a + abs(b).bit_length()) % 128, low) for a, b, low in zip(lengths, before, lowest)]
    size = (sum(max(0, length - low - 2) for length, low in ends) + 7) // 8
    bits, sums = int.from_bytes(data[at : at + size], "little"), []
    for (length, low), code in zip(ends, lengths):
        between = max(0, length - low - 2)
        number = ((bits & (1 << between) - 1) << (low + 1)) | (1 << low | 1 << (length - 1) if length else 0)
        bits >>= between
        sums.append(-number if code > 127 else number)
    return sums, at + size


def sums_of(data):
    """Returns the header of a film file and the channels of its target `film`, each as a list of whole numbers."""
    size = struct.unpack_from("<I", data, 12)[0]
    header, at = json.loads(data[16 : 16 + size]), 16 + size + 16
    target = header["targets"][0]
    stride = target["stride"]
    channels, left = [[] for _ in range(stride // 16)], target["bytes"] // stride
    while left:
        count = min(left, 1 << 15, max(1, (1 << 22) // stride))
        end, before = at + 4 + struct.unpack_from("<I", data, at)[0], [0] * count
        at += 4
        for c, channel in enumerate(channels):
            kind, at = data[at], at + 1
            if kind == 0:
                sums, at = [int.from_bytes(data[at : at + 16], "little", signed=True)] * count, at + 16
            elif kind == 1:
                planes = []
                for _ in range(16):
                    plane, at = take_plane(data, at, count)
                    planes.append(plane)
                sums = [int.from_bytes(bytes(number), "little", signed=True) for number in zip(*planes)]
            else:
                sums, at = take_sums(data, at, count, before if kind == 3 else [0] * count)
            channel += sums
            before = sums
        assert at == end, (at, end)
        at, left = at + 16, left - count
    return header, channels


def peak_of(*arguments, cwd):
    """Returns the most memory, in bytes, that a run of the program had."""
    program = subprocess.Popen([PROGRAM, *arguments], cwd=cwd, stdin=subprocess.DEVNULL)
    _, status, usage = os.wait4(program.pid, 0)
    program.returncode = os.waitstatus_to_exitcode(status)
    if program.returncode != 0:
        raise AssertionError(f"status {program.returncode}")
    return usage.ru_maxrss << 10


class Merge(CliTest):
    def part(self, output, *flags, scene="cornell-box"):
        size = [] if "--size" in flags else SMALL[:2]
        fixed = [] if "--exposure" in flags or output == "alone.exr" else UNMETERED
        return self.succeed("render", scene, "-o", output, *size, *SMALL[2:], *fixed, *flags, "--json").events("done")[0]

    def parts(self, count, *flags):
        names = [f"part.{i}.pvf" for i in range(1, count + 1)]
        for i, name in enumerate(names, 1):
            self.part(name, "--part", f"{i}/{count}", *flags)
        return names

    def write_all(self, files):
        for name, content in files.items():
            with open(self.path(name), "wb") as output:
                output.write(content)

    def merge(self, *arguments):
        return self.succeed("merge", *arguments, "--json").events("done")[0]

    def metadata(self, name):
        """Returns an EXR's metadata except its name, times and device."""
        return {key: value for key, value in self.info(name).items()
                if key not in ("file", "pertev.device") and not key.endswith("_seconds")}

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def check_parts(self, counts, *flags):
        outputs = ["-o", "whole.png"]
        whole = self.part("whole.exr", *outputs, *flags)
        for count in counts:
            with self.subTest(count=count):
                names = self.parts(count, *flags)
                for order in [names, names[::-1]]:
                    done = self.merge(*order, "-o", "all.exr", "-o", "all.png", "-o", "all.pvf")
                    for key in ["hash", "layers_hash", "denoised_hash", "samples", "invalid_samples"]:
                        self.assertEqual(done[key], whole[key], key)
                    self.assertEqual(done["parts"], count)
                    self.assertEqual(self.metadata("all.exr"), self.metadata("whole.exr"))
                    self.assertEqual(self.read("all.png"), self.read("whole.png"))
                self.assertEqual(self.merge("all.pvf", "-o", "again.exr")["hash"], whole["hash"])

    def test_merged_parts_have_the_hashes_and_metadata_of_one_run(self):
        self.check_parts([1, 2, 5], "--spp", "7", "--seed", "3")

    def test_merged_parts_have_layers_ids_and_alpha_of_one_run(self):
        self.check_parts([3], "--spp", "4", "--aov", "albedo,normal,ids", "--lpe", "diffuse=LD+E", "--transparent")

    def test_merged_parts_of_other_integrators_have_the_hashes_of_one_run(self):
        for integrator in ["direct", "hybrid", "whitted", "distributed", "raster", "reyes", "light", "bidirectional", "photon_map"]:
            with self.subTest(integrator=integrator):
                lights = ["--ambient", "0.5"] if integrator in ("whitted", "raster", "reyes") else []
                self.check_parts([2], "--spp", "3", "--integrator", integrator, *lights)

    def test_parts_by_rows_and_samples_have_the_hashes_of_one_run(self):
        flags = ["--spp", "4", "--aov", "ids,depth", "--exposure", "auto"]
        whole = self.part("whole.exr", "-o", "whole.png", *flags)
        for name, part in {"a": "--rows 0:5", "b": "--rows 5:16 --part 1/2", "c": "--rows 5:16 --part 2/2"}.items():
            self.part(f"{name}.pvf", *flags, *part.split())
        self.assertEqual((self.info("b.pvf")["rows"], self.info("b.pvf")["samples"]), ("5:16", "0:2"))
        done = self.merge("b.pvf", "c.pvf", "a.pvf", "-o", "all.exr", "-o", "all.png", "-o", "all.pvf")
        self.assertEqual((done["hash"], done["layers_hash"]), (whole["hash"], whole["layers_hash"]))
        self.assertEqual(self.metadata("all.exr"), self.metadata("whole.exr"))
        self.assertEqual(self.read("all.png"), self.read("whole.png"))
        self.assertEqual(self.info("all.pvf")["rows"], "0:16")
        self.refuse(2, "merge", "a.pvf", "b.pvf", "-o", "x.exr", says=["samples 2 to 3 of rows 5 to 15", "--partial"])
        self.refuse(2, "merge", "b.pvf", "c.pvf", "-o", "x.exr", says=["samples 0 to 3 of rows 0 to 4", "--partial"])

    def test_rows_beside_rows_without_samples_keep_their_light_when_denoised(self):
        flags = ["--spp", "16", "--size", "48x36", "--denoise", "svgf"]
        self.part("alone.exr", *flags)
        self.part("b.pvf", *flags, "--rows", "20:36")
        self.merge("b.pvf", "--partial", "-o", "some.exr")
        whole, some = (read_exr(self.path(name))[2] for name in ("alone.exr", "some.exr"))
        for row in range(20, 24):
            light = [sum(of["G"][row][2:46]) for of in (some, whole)]
            self.assertAlmostEqual(light[0] / light[1], 1, delta=0.06, msg=row)

    def test_rows_that_lack_samples_are_merged_without_them_and_named(self):
        flags = ["--spp", "4", "--aov", "ids,samples,variance,crypto_object", "--transparent", "--exposure", "auto"]
        whole = self.part("whole.exr", "-o", "whole.png", *flags)
        for name, part in {"a": "--rows 0:5", "b": "--rows 5:12 --part 1/2", "c": "--rows 5:12 --part 2/2", "d": "--rows 12:16"}.items():
            self.part(f"{name}.pvf", *flags, *part.split())
        outcome = self.succeed("merge", "b.pvf", "a.pvf", "--partial", "-o", "some.exr", "-o", "some.png", "-o", "some.pvf", "--json")
        warnings, done = [event["text"] for event in outcome.events("warning")], outcome.events()[-1]
        self.assertEqual(warnings, ["the rows have unequal numbers of samples: rows 0 to 4 have 4, rows 5 to 11 have 2, rows 12 to 15 have 0"])
        self.assertEqual((done["samples"], done["least_samples"], done["warnings"]), (4, 0, warnings))
        some = self.info("some.exr")
        self.assertEqual((some["pertev.spp"], some["pertev.least_spp"]), (4, 0))
        self.assertEqual(json.loads(some["pertev.row_samples"]), {"0:5": 4, "5:12": 2, "12:16": 0})
        self.assertIn("0 to 4 spp of 2 parts", self.succeed("merge", "a.pvf", "b.pvf", "--partial", "-o", "some.exr").stderr)
        self.assertEqual(self.info("some.pvf")["parts"], ["rows 0:5, samples 0:4", "rows 5:12, samples 0:2"])
        self.assertEqual(json.loads(self.succeed("info", "some.exr", "--settings").stdout)["settings"]["spp"], 4)
        self.refuse(2, "render", "cornell-box", "-o", "x.exr", *SMALL, *flags, "--checkpoint", "some.pvf", says=["some.pvf", "merged film"])
        self.refuse(2, "merge", "c.pvf", "some.pvf", "-o", "x.exr", says=["samples 0 to 3 of rows 12 to 15", "--partial"])
        self.refuse(2, "merge", "c.pvf", "some.pvf", "b.pvf", "--partial", "-o", "x.exr", says=["b.pvf", "samples 0 to 1 of rows 5 to 11", "some.pvf"])
        for order in (["d.pvf", "some.pvf", "c.pvf"], ["some.pvf", "c.pvf", "d.pvf"]):
            done = self.merge(*order, "-o", "all.exr", "-o", "all.png", "-o", "all.pvf")
            for key in ["hash", "layers_hash"]:
                self.assertEqual(done[key], whole[key], key)
            self.assertEqual((done["samples"], done["least_samples"]), (4, 4))
            self.assertEqual(self.metadata("all.exr"), self.metadata("whole.exr"))
            self.assertEqual(self.read("all.png"), self.read("whole.png"))

    def test_parts_by_rows_and_samples_are_denoised_as_a_whole_picture(self):
        flags = ["--spp", "4", "--denoise", "svgf", "--aov", "normal", "--exposure", "auto"]
        whole = self.part("whole.exr", "-o", "whole.png", "-o", "whole.pvf", *flags)
        for name, part in {"a": ["0:5"], "b": ["5:16", "--part", "1/2"], "c": ["5:16", "--part", "2/2"]}.items():
            self.part(f"{name}.pvf", *flags, "--rows", *part)
        done = self.merge("c.pvf", "a.pvf", "b.pvf", "-o", "all.exr", "-o", "all.png", "-o", "all.pvf")
        for key in ["hash", "layers_hash", "denoised_hash", "samples"]:
            self.assertEqual(done[key], whole[key], key)
        self.assertIsNotNone(done["denoised_hash"])
        self.assertEqual(self.metadata("all.exr"), self.metadata("whole.exr"))
        self.assertEqual(self.read("all.png"), self.read("whole.png"))
        for name in ("all.pvf", "whole.pvf"):
            self.assertEqual(self.merge(name, "-o", "again.exr")["denoised_hash"], whole["denoised_hash"])
        self.assertEqual(self.merge("all.pvf", "-o", "again.exr", "--denoise", "svgf")["denoised_hash"], whole["denoised_hash"])
        self.refuse(2, "merge", "all.pvf", "-o", "x.exr", "--denoise", "oidn", says=["all.pvf", "--denoise svgf"])
        self.part("alone.pvf", "--spp", "4")
        self.refuse(2, "merge", "alone.pvf", "-o", "x.exr", "--denoise", "svgf", says=["alone.pvf", "--denoise svgf"])
        self.part("plain.pvf", "--spp", "4", "--aov", "normal", "--exposure", "auto", "--rows", "0:5")
        self.refuse(2, "merge", "b.pvf", "c.pvf", "plain.pvf", "-o", "x.exr", says=["--denoise"])

    def test_a_part_of_rows_goes_on_from_its_checkpoint(self):
        flags = ["--rows", "3:9", "--checkpoint", "c.pvf"]
        self.part("a.exr", "--spp", "2", *flags)
        again = self.part("b.exr", "--spp", "5", *flags)
        self.assertEqual(again["hash"], self.part("d.pvf", "-o", "d.exr", "--spp", "5", "--rows", "3:9")["hash"])
        self.assertEqual((self.info("c.pvf")["rows"], self.info("c.pvf")["samples"]), ("3:9", "0:5"))
        self.refuse(2, "render", "cornell-box", "-o", "x.exr", *SMALL, *UNMETERED, "--spp", "5", "--rows", "3:8", "--checkpoint", "c.pvf",
                    says=["--checkpoint", "has the rows 3 to 8, not 3 to 7"])

    def test_lines_and_progress_name_the_part(self):
        flags = ["render", "cornell-box", "-o", "x.pvf", *SMALL, "--spp", "4", "--part", "2/3", "--rows", "0:8"]
        lines = self.succeed(*flags).stderr.splitlines()
        self.assertTrue(lines and all(line.startswith("part 2/3, rows 0:8: ") for line in lines), lines)
        for event in self.succeed(*flags, "--json").events("progress"):
            self.assertEqual(event["part"], "part 2/3, rows 0:8")
        said = [json.loads(line) for line in self.succeed(*flags, "--progress", "json", "-q").stderr.splitlines()]
        self.assertEqual({(line["event"], line["part"]) for line in said}, {("progress", "part 2/3, rows 0:8")})
        self.assertEqual(said[-1]["share"], 1)
        self.assertNotIn("part", self.succeed(*flags[:-4], "--json").events("progress")[-1])

    def test_the_metered_exposure_of_parts_is_that_of_one_run(self):
        flags = ["--spp", "2", "--exposure", "auto"]
        self.part("whole.png", *flags)
        for i in (1, 2):
            self.part(f"{i}.pvf", *flags, "--part", f"{i}/2")
        self.merge("1.pvf", "2.pvf", "-o", "all.png", "-o", "all.exr")
        self.assertEqual(self.read("all.png"), self.read("whole.png"))
        self.merge("1.pvf", "2.pvf", "-o", "plain.exr")
        self.assertIn("pertev.exposure", self.info("all.exr"))
        self.assertNotIn("pertev.exposure", self.info("plain.exr"))

    def test_another_tone_map_or_exposure_of_a_merge_is_that_of_one_run(self):
        def said_of(name):
            said = self.metadata(name)
            return {key: json.loads(value) if key == "pertev.settings" else value for key, value in said.items()}

        for made in (["--exposure", "auto"], ["--exposure", "0.5", "--tone-map", "neutral"]):
            for i in (1, 2):
                self.part(f"{i}.pvf", "--spp", "2", "--part", f"{i}/2", *made)
            # The meter's exposure for linear light differs from that for agx, for aces hardly.
            for shown in (["--tone-map", "srgb"], ["--exposure", "1.25"], ["--tone-map", "aces", "--exposure", "-2"]):
                with self.subTest(made=made, shown=shown):
                    as_one = [*(made[:2] if "--exposure" not in shown else []), *(made[2:] if "--tone-map" not in shown else []), *shown]
                    self.part("whole.exr", "-o", "whole.png", "--spp", "2", *as_one)
                    self.merge("1.pvf", "2.pvf", "-o", "all.exr", "-o", "all.png", "-o", "all.pvf", *shown)
                    self.assertEqual(self.read("all.png"), self.read("whole.png"))
                    self.assertEqual(said_of("all.exr"), said_of("whole.exr"))
                    self.merge("all.pvf", "-o", "again.png")
                    self.assertEqual(self.read("again.png"), self.read("whole.png"))
        self.refuse(2, "merge", "1.pvf", "2.pvf", "-o", "x.png", "--exposure", "auto", says=["1.pvf", "--exposure auto", "meter"])
        for flags, says in ((["--tone-map", "sepia"], "--tone-map sepia"), (["--exposure", "bright"], "--exposure bright")):
            self.refuse(2, "merge", "1.pvf", "2.pvf", "-o", "x.png", *flags, says=[says])
        for shown in (["--tone-map", "aces"], ["--exposure", "1"]):
            self.refuse(2, "merge", "1.pvf", "2.pvf", "-o", "x.exr", *shown, says=[shown[0], "PNG"])
        self.refuse(2, "merge", "1.pvf", "2.pvf", "-o", "x.exr", "--denoise", "smooth", says=["--denoise smooth", "svgf"])
        self.succeed("render", "cornell-box", "-o", "colors.pvf", *SMALL, "--spp", "2", "--false-color", "luminance")
        self.refuse(2, "merge", "colors.pvf", "-o", "x.png", "--tone-map", "agx", says=["--exposure"])

    def test_a_part_is_a_range_of_samples_and_may_be_empty(self):
        whole = self.part("alone.exr", "--spp", "3")
        names = self.parts(5, "--spp", "3")
        empty = self.part("again.pvf", "--spp", "3", "--part", "1/5")
        self.assertEqual((empty["samples"], empty["seconds_per_frame"], empty["samples_per_second"]), (0, None, None))
        said = self.succeed("render", "cornell-box", "-o", "again.pvf", *SMALL, "--spp", "3", "--part", "1/5").stderr
        self.assertIn("no samples", said)
        self.assertNotRegex(said, "nan|inf|per frame")
        self.assertEqual(self.merge(*names, "-o", "all.exr")["hash"], whole["hash"])
        for i in range(3):
            self.assertEqual(self.part(f"{i}.pvf", "--spp", "3", "--part", f"{i}/3", "--part-base", "0")["samples"], 1)
        self.assertEqual(self.merge("1.pvf", "2.pvf", "0.pvf", "-o", "all.exr")["hash"], whole["hash"])

    def test_a_picture_beside_a_film_file_has_its_usual_metadata(self):
        self.part("alone.exr", "--spp", "2")
        self.succeed("render", "cornell-box", "-o", "beside.exr", "-o", "beside.pvf", *SMALL, "--spp", "2")
        self.assertEqual(self.metadata("beside.exr"), self.metadata("alone.exr"))
        self.assertNotIn("pertev.exposure", self.info("alone.exr"))

    def test_samples_are_added_to_a_finished_picture(self):
        whole = self.part("whole.exr", "-o", "whole.png", "--spp", "6")
        self.part("finished.pvf", "--spp", "4")
        self.part("more.pvf", "--samples", "4:6")
        said = self.info("more.pvf")
        self.assertEqual((said["width"], said["samples"], said["spp"], said["pertev.seed"]), (20, "4:6", 6, "0"))
        self.assertEqual(self.merge("more.pvf", "finished.pvf", "-o", "all.exr", "-o", "all.png")["hash"], whole["hash"])
        self.assertEqual(self.metadata("all.exr"), self.metadata("whole.exr"))
        self.assertIn('"spp":6', self.succeed("info", "all.exr", "--settings").stdout)

    def test_a_film_file_is_read_by_its_description(self):
        self.part("film.pvf", "--spp", "5", "-o", "film.exr", "--aov", "normal", "--size", "64x48")
        header, channels = sums_of(self.read("film.pvf"))
        self.assertEqual((header["size"], header["samples"], header["layers"]), ([64, 48], [0, 5], ["normal"]))
        self.assertEqual(len(channels), 7)
        means = [sum(channel) / 2**64 / 5 / len(channel) for channel in channels]
        for mean, known in zip(means, self.info("film.exr")["mean"]):
            self.assertAlmostEqual(mean, known, places=6)
        self.assertLess(min(channels[4]), 0)

    def test_an_interrupted_render_resumes_from_its_film(self):
        program = subprocess.Popen([PROGRAM, "render", "cornell-box", "-o", "ended.pvf", *SMALL, *UNMETERED, "--spp", "1000000", "--json"],
                                   cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.addCleanup(program.kill)
        first = next(line for line in program.stdout
                     if json.loads(line)["event"] == "progress" and json.loads(line)["samples"] > 0)
        program.send_signal(signal.SIGTERM)
        lines = (first + program.communicate(timeout=PATIENCE_S)[0]).decode().splitlines()
        samples = next(json.loads(line) for line in lines if json.loads(line)["event"] == "done")["samples"]
        self.assertEqual(program.returncode, 75)
        self.refuse(2, "merge", "ended.pvf", "-o", "x.exr", says=["ended.pvf", f"samples {samples} to 999999", "--partial"])
        whole = self.part("alone.exr", "--spp", samples + 5)
        self.part("more.pvf", "--samples", f"{samples}:{samples + 5}")
        done = self.merge("ended.pvf", "more.pvf", "--partial", "-o", "all.exr")
        self.assertEqual((done["hash"], done["samples"]), (whole["hash"], samples + 5))

    def test_parts_that_are_missing_overlap_or_belong_to_other_pictures_are_refused(self):
        names = self.parts(3, "--spp", "6")
        self.refuse(2, "merge", names[0], names[2], "-o", "x.exr", says=["samples 2 to 3"])
        self.refuse(2, "merge", *names, names[1], "-o", "x.exr", says=[names[1], "samples 2 to 3"])
        done = self.merge(names[0], names[2], "--partial", "-o", "some.exr")
        self.assertEqual((done["samples"], len(done["warnings"])), (4, 1))
        self.merge(names[0], names[2], "--partial", "-o", "some.pvf")
        self.assertEqual(self.merge(names[1], "some.pvf", "-o", "all.exr")["hash"], self.merge(*names, "-o", "whole.exr")["hash"])
        for flags, name in [(["--max-depth", "3"], "--max-depth"), (["--seed", "7"], "--seed"), (["--exposure", "1"], "exposure"),
                            (["--size", "16x16"], "--size"), (["--aov", "depth"], "--aov")]:
            with self.subTest(flags=flags):
                self.part("other.pvf", "--spp", "6", "--part", "2/3", *flags)
                self.refuse(2, "merge", names[0], "other.pvf", names[2], "-o", "x.exr", says=["other.pvf", name])
        self.part("other.pvf", "--spp", "6", "--part", "2/3", scene="blind")
        self.refuse(2, "merge", names[0], "other.pvf", names[2], "-o", "x.exr", says=["other.pvf", "hash of the scene"])

    def test_parts_and_checkpoints_do_not_survive_a_change_of_a_file_that_the_scene_refers_to(self):
        write(self.path("a.obj"), "mtllib a.mtl\nusemtl grey\nvt 0 0\nvt 1 0\nvt 1 1\n" + FLOOR.replace("f 4 3 2 1", "f 3/3 2/2 1/1"))
        material = b"newmtl grey\nKd 0.5 0.5 0.5\nmap_Kd maps/a.hdr\n"
        texture, heights = ("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n".encode() + bytes([value, 90, 90, 128]) for value in (90, 40))
        files = {"a.mtl": material, "maps/a.hdr": texture, "h.hdr": heights, "l.cube": LUT}
        view = ["--eye", "0,2,0.1", "--target", "0,0,0", "--spp", "2", "--integrator", "reyes", "--displacement", "grey=h.hdr,0.01",
                "--lut", "l.cube"]
        os.mkdir(self.path("maps"))
        os.mkdir(self.path("other"))
        self.write_all(files)
        self.part("1.pvf", "--part", "1/2", "--checkpoint", "c.pvf", *view, scene="a.obj")
        header = sums_of(self.read("1.pvf"))[0]["settings"]
        self.assertEqual({name for name in header if name.startswith("file ")}, {f"file {name}" for name in files})
        self.assertNotIn(self.folder, json.dumps(header))
        for name, after, says in [("a.mtl", material.replace(b"0.5", b"0.6", 1), "a.mtl is another file there"),
                                  ("a.mtl", material.replace(b"a.hdr", b"../h.hdr"), "a.mtl is another file there"),
                                  ("maps/a.hdr", heights, "maps/a.hdr is another file there"),
                                  ("maps/a.hdr", None, "maps/a.hdr is read there and not here"),
                                  ("h.hdr", texture, "h.hdr is another file there"),
                                  ("l.cube", LUT.replace(b"1 1 1", b"1 1 0"), "l.cube is another file there"),
                                  ("a.hdr", texture, "")]: # where it is found too
            with self.subTest(name=name, says=says):
                self.write_all(files)
                if says == "" or after is None:
                    os.remove(self.path("maps/a.hdr"))
                if after is not None:
                    with open(self.path(name), "wb") as output:
                        output.write(after)
                self.part("2.pvf", "--part", "2/2", *view, scene="a.obj")
                if says == "":
                    self.merge("1.pvf", "2.pvf", "-o", "all.exr")
                    continue
                self.refuse(2, "merge", "1.pvf", "2.pvf", "-o", "x.exr", says=["2.pvf", says])
                self.refuse(2, "render", "a.obj", "-o", "1.pvf", "--part", "1/2", "--checkpoint", "c.pvf", *SMALL, *UNMETERED, *view,
                            says=["c.pvf", says])

    def test_parts_may_have_the_files_of_settings_in_other_folders(self):
        write(self.path("a.obj"), "mtllib a.mtl\nusemtl grey\nvt 0 0\nvt 1 0\nvt 1 1\n" + FLOOR.replace("f 4 3 2 1", "f 3/3 2/2 1/1"))
        write(self.path("a.mtl"), "newmtl grey\nKd 0.5 0.5 0.5\n")
        sky, other = ("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n".encode() + bytes([value, 90, 90, 128]) for value in (90, 40))
        folders = ["one", "another one"]
        for folder in folders:
            os.mkdir(self.path(folder))
            self.write_all({f"{folder}/sky.hdr": sky, f"{folder}/l.cube": LUT, f"{folder}/h.hdr": sky})
        def part(number, folder):
            self.part(f"{number}.pvf", "--part", f"{number}/2", "--eye", "0,2,0.1", "--target", "0,0,0", "--spp", "2", "--integrator", "reyes",
                      "--environment", self.path(f"{folder}/sky.hdr"), "--lut", self.path(f"{folder}/l.cube"),
                      "--displacement", f"grey={self.path(folder)}/h.hdr,0.01", scene="a.obj")
        for number, folder in enumerate(folders, 1):
            part(number, folder)
        self.merge("1.pvf", "2.pvf", "-o", "all.exr")
        self.assertNotIn(self.folder, json.dumps(sums_of(self.read("1.pvf"))[0]["settings"]))
        self.write_all({f"{folders[1]}/sky.hdr": other})
        part(2, folders[1])
        self.refuse(2, "merge", "1.pvf", "2.pvf", "-o", "x.exr", says=["2.pvf", "sky.hdr is another file there"])

    def test_a_part_is_of_the_files_that_it_has_read(self):
        write(self.path("a.obj"), "mtllib a.mtl\nusemtl grey\n" + FLOOR)
        files = {"a.mtl": b"newmtl grey\nKd 0.5 0.5 0.5\n", "l.cube": LUT}
        self.write_all(files)
        view = ["--eye", "0,2,0.1", "--target", "0,0,0", "--lut", "l.cube"]
        program = subprocess.Popen([PROGRAM, "render", "a.obj", "-o", "1.pvf", *SMALL, *UNMETERED, *view, "--spp", "1000000", "--json"],
                                   cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.addCleanup(program.kill)
        next(line for line in program.stdout if json.loads(line)["event"] == "progress" and json.loads(line)["samples"] > 0)
        self.write_all({"a.mtl": b"newmtl grey\nKd 0.1 0.1 0.1\n", "l.cube": LUT.replace(b"1 1 1", b"1 1 0")})
        program.send_signal(signal.SIGTERM)
        samples = next(json.loads(line) for line in program.communicate(timeout=PATIENCE_S)[0].decode().splitlines()
                       if json.loads(line)["event"] == "done")["samples"]
        more = ["--samples", f"{samples}:{samples + 1}", *view]
        self.part("2.pvf", *more, scene="a.obj")
        self.refuse(2, "merge", "1.pvf", "2.pvf", "--partial", "-o", "x.exr", says=["a.mtl is another file there"])
        self.write_all(files)
        self.part("2.pvf", *more, scene="a.obj")
        self.assertEqual(self.merge("1.pvf", "2.pvf", "--partial", "-o", "all.exr")["samples"], samples + 1)

    def test_files_that_are_not_films_or_are_damaged_are_refused(self):
        self.part("film.pvf", "--spp", "1", "-o", "film.exr")
        whole = self.read("film.pvf")
        for name, content in [("cut.pvf", whole[:-1]), ("flipped.pvf", whole[:-40] + bytes([whole[-40] ^ 1]) + whole[-39:]),
                              ("empty.pvf", b""), ("text.pvf", b"a text\n" * 9)]:
            with open(self.path(name), "wb") as file:
                file.write(content)
            self.refuse(2, "merge", name, "-o", "x.exr", says=[name])
            self.refuse(2, "merge", "film.pvf", name, "-o", "x.exr", says=[name])
        self.refuse(2, "merge", "film.exr", "-o", "x.exr", says=["film.exr"])
        self.refuse(2, "merge", "nowhere.pvf", "-o", "x.exr", says=["nowhere.pvf"])
        self.refuse(6, "merge", "film.pvf", "-o", "nowhere/x.exr", says=["nowhere/x.exr"])
        self.refuse(2, "merge", "film.pvf", "-o", "x.bmp", says=["x.bmp"])
        self.refuse(2, "merge", "film.pvf")

    def test_impossible_parts_are_refused(self):
        for flags in ["--part 0/2", "--part 3/2", "--part 1", "--part 1/0", "--part -1/2", "--part 1/2x", "--part 2/2 --part-base 0",
                      "--part-base 1", "--samples 4", "--samples 4:4", "--samples 5:4", "--samples 0:9000000", "--samples 1:2 --spp 4",
                      "--samples 1:2 --part 1/2", "--part 1/2 --time-limit 1", "--samples 0:1 --time-limit 1", "--samples 0:1 --turntable 4",
                      "--aov motion", "--rows 4", "--rows 4:4", "--rows 0:17", "--rows 0:8 --integrator light",
                      "--rows 0:8 --integrator bidirectional", "--rows 0:8 --time-limit 1", "--rows 0:8 --turntable 4"]:
            with self.subTest(flags=flags):
                self.refuse(2, "render", "cornell-box", "-o", "x.pvf", *SMALL, *flags.split(), says=[flags.split()[0]])
        self.refuse(2, "render", "cornell-box", "-o", "x-#.pvf", *SMALL, "--turntable", "4", says=["x-#.pvf"])

    @unittest.skipIf(SANITIZED, "sanitizers take memory of their own")
    def test_memory_does_not_grow_with_the_number_of_parts(self):
        width, height, count = 320, 180, 24
        line = ["render", "cornell-box", "--size", f"{width}x{height}", "--device", "cpu", *UNMETERED, "--spp", str(count), "--max-depth", "1"]
        for i in range(1, count + 1):
            self.succeed(*line, "--part", f"{i}/{count}", "-o", f"{i}.pvf")
        self.succeed(*line, "-o", "whole.exr", "-o", "whole.png")
        of = {}
        for parts in (2, count):
            files = [f"{i}.pvf" for i in range(1, parts + 1)]
            of[parts] = min(peak_of("merge", *files, "--partial", "-o", f"{parts}.exr", "-q", cwd=self.folder) for _ in range(3))
        self.assertEqual(self.info(f"{count}.exr")["pertev.hash"], self.info("whole.exr")["pertev.hash"])
        print(f"peak of 2 parts {of[2]}, of {count} {of[count]}")
        film = width * height * 4 * 16  # bytes of red, green, blue and hits
        self.assertLess(of[count], of[2] + count // 3 * film)


if __name__ == "__main__":
    main()
