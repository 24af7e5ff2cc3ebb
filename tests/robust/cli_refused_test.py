#!/usr/bin/env python3
"""Errors and warnings of the command line: exit status, named settings, and no remaining file."""

import json
import os
import re

from cli_run import FLOOR, SANITIZED, CliTest, gltf_with_cameras, limit_addresses, main, write


class WhatIsRefused(CliTest):
    def test_a_bad_flag_or_value_ends_with_2_and_names_the_flag(self):
        for flag in ["--foo", "--spp 0", "--spp -1", "--spp 1.5", "--spp 4294967297", "--fov nan", "--fov 0",
                     "--fov 180", "--aperture -1", "--aperture nan", "--aperture-blades 1", "--aperture-blades 2", "--aperture-blades 101", "--aperture-blades 4.5", "--aperture-ratio 0", "--aperture-rotation inf", "--focus 0", "--focus inf", "--clamp nan",
                     "--clamp 0", "--shading-rate 0.1", "--shading-rate 65", "--accuracy 0", "--accuracy 1.1", "--hemisphere-rays 15", "--hemisphere-rays 65537",
                     "--time-limit 0", "--time-limit nan", "--time nan", "--time inf", "--fps 0", "--turntable 0", "--environment-scale nan", "--environment-scale -1",
                     "--environment-rotation inf", "--exposure much", "--exposure inf", "--seed -1",
                     "--seed 4294967296", "--threads 0", "--filter-radius nan", "--filter-radius 1e9",
                     "--view-height inf", "--radius 3e-20", "--caustic-radius 9e-10", "--max-depth -1", "--tone-map x", "--sampler x", "--filter x",
                     "--integrator x", "--integrator whitted --ambient x", "--integrator whitted --ambient 1,2", "--integrator cast --ambient -1", "--integrator cast --ambient nan", "--projection x", "--aov x", "--aov albedo", "--size 10", "--size 0x10",
                     "--size x", "--size 10x", "--size 10x10x10", "--size -1x10", "--size nanxnan", "--device gpu",
                     "--device cuda:x", "--eye 1,2", "--eye 1,2,nan", "--target 1,2,3,4", "--up x,y,z",
                     "--structure x", "--traversal x", "--traversal moon=compressed", "--traversal shadow=x", "--rta x", "--order x",
                     "--distribution x", "--build x", "--build sbvh", "--environment -1,0,0", "--environment 1,2", "--environment no.hdr", "--allow-path nowhere",
                     "--unit inch", "--unit 0", "--unit nan", "--up-axis w", "--up-axis -z"]:
            with self.subTest(flag=flag):
                arguments = flag.split()
                self.refuse(2, "render", "cornell-box", "-o", "x.png", *arguments, says=[arguments[-2] if len(arguments) > 2 else arguments[0]])

    def test_a_flag_given_twice_ends_with_2_and_is_named(self):
        for line in ["render cornell-box -o x.png --size 8x8 --size 9x9", "render cornell-box -o x.png --spp 1 --spp 2",
                     "compare x.png x.png --blocks 2 --blocks 2", "bench --size 8x8 --size 8x8",
                     "bench rays --count 5 --count 5", "bench render --scene a.obj --scene b.obj"]:
            self.refuse(2, *line.split(), says=[f"{line.split()[-2]}: "])

    def test_errors_of_the_command_line_point_to_the_help_of_their_verb(self):
        for verb in ["render", "info", "bench", "bench rays", "bench render", "compare"]:
            self.refuse(2, *verb.split(), "--foo", says=[f"pertev {verb} --help)"])

    def test_an_invalid_exposure_is_refused(self):
        for exposure in ["AUTO", "bright"]:
            self.refuse(2, "render", "cornell-box", "-o", "x.png", "--exposure", exposure,
                        says=[f"--exposure {exposure}: "])

    def test_a_number_that_is_too_large_is_refused_with_the_maximum(self):
        for flag, limit in [("--time-limit 1e300", "3.4028235e+38"), ("--clamp 1e300", "3.4028235e+38"),
                            ("--exposure 1e300", "3.4028235e+38"), ("--eye 1e300,0,0", "3.4028235e+38"),
                            ("--environment-rotation 1e30", "1000000"), ("--environment-scale 1e30", "1000000000000"),
                            ("--focus 1e30", "1099511627776")]:
            outcome = self.refuse(2, "render", "cornell-box", "-o", "x.png", *flag.split(), says=[*flag.split(), limit])
            self.assertNotIn("finite", outcome.stderr)

    def test_a_number_that_is_too_small_for_a_float_is_0(self):
        for flag, number in [("--focus", "1e-60"), ("--time-limit", "1e-400"), ("--clamp", "1e-5000"), ("--fps", "0.0e-9")]:
            told = self.refuse(2, "render", "cornell-box", "-o", "x.png", flag, number, says=[f"{flag} {number} is not a number"])
            self.assertEqual("so near 0" in told.stderr, number != "0.0e-9")
        small = ["--size", "8x6", "--spp", "1", "--device", "cpu", "--json"]
        flags = ["--environment {0},1,1", "--eye 1,{0},3", "--exposure {0}", "--environment-rotation {0}",
                 "--lamp light={0}lm", "--aperture {0}"]
        for flag in flags:
            with self.subTest(flag=flag):
                hashes = [self.succeed("render", "cornell-box", "-o", "x.png", *small, *flag.format(number).split()).events("done")[0]["hash"]
                          for number in ["0", "1e-46", "1e-5000"]]
                self.assertEqual(len(set(hashes)), 1)

    def test_a_flag_without_effect_ends_with_2_before_the_scene_is_read(self):
        for flag, output in [("--transparent", "x.jpg"), ("--transparent", "x.hdr"), ("--aov albedo", "x.png"),
                             ("--exposure 1", "x.exr"), ("--exposure auto", "x.hdr"), ("--tone-map agx", "x.exr"),
                             ("--view-height 2 --projection perspective", "x.png"),
                             ("--focus 2 --aperture 0", "x.png"), ("--denoise svgf --max-depth 0", "x.png"),
                             ("--ambient 1", "x.png"), ("--ambient 1 --integrator distributed", "x.png"),
                             ("--clamp 1 --integrator whitted --ambient 1", "x.png")]:
            with self.subTest(flag=flag, output=output):
                self.refuse(2, "render", "nowhere.obj", "-o", output, *flag.split(), says=[flag.split()[0]])

    def test_errors_of_integrator_settings_name_the_setting_its_value_and_those_it_depends_on(self):
        self.render(output="heights.png")
        for flags, status, setting, value, others in [
                ("--integrator whitted --denoise svgf", 2, "denoise", "svgf", ["integrator"]),
                ("--integrator distributed --max-depth 256", 3, "max_depth", "256", ["integrator"]),
                ("--integrator bidirectional --denoise svgf", 2, "denoise", "svgf", ["integrator"]),
                ("--integrator bidirectional --max-depth 256", 3, "max_depth", "256", ["integrator"]),
                ("--integrator hybrid --aperture 0.1 --focus 1", 2, "integrator", "hybrid", ["aperture", "integrator"]),
                ("--integrator raster --aperture 0.1", 2, "integrator", "raster", ["aperture", "integrator"]),
                ("--integrator hybrid --time 0 --shutter 0.1", 2, "shutter", None, ["integrator"]),
                ("--time 0 --shutter 1e30", 2, "shutter", "1e30", []),
                ("--time 0 --shutter 1e999,2", 2, "shutter", "1e999,2", []),
                ("--time 0 --shutter 1,2,3", 2, "shutter", "1,2,3", []),
                ("--integrator raster --ambient 1 --aperture 0.1 --focus 1", 2, "integrator", "raster", ["aperture", "integrator"]),
                ("--integrator photon_map --max-depth 65", 3, "max_depth", "65", ["integrator"]),
                ("--integrator photon_map --max-depth 64 --photons 16777216", 3, "photons", "16777216", ["max_depth"]),
                ("--integrator light --photons 5", 2, "photons", None, ["integrator"]),
                ("--integrator irradiance_cache --denoise svgf", 2, "denoise", "svgf", ["integrator"]),
                ("--integrator irradiance_cache --lpe a=LE -o x.exr", 2, "lpe", None, ["integrator"]),
                ("--integrator irradiance_cache --clamp 1", 2, "clamp", None, ["integrator"]),
                ("--accuracy 0.3", 2, "accuracy", None, ["integrator"]),
                ("--integrator light --hemisphere-rays 99", 2, "hemisphere_rays", None, ["integrator"]),
                ("--integrator photon_map --show-records", 2, "show_records", None, ["integrator"]),
                ("--integrator radiosity --solver hierarchical --form-factors hemicube", 2, "form_factors", "hemicube", ["solver"]),
                ("--integrator photon_map --lamp light=0W --environment 0,0,0", 2, "integrator", "photon_map", []),
                ("--gather final", 2, "gather", None, ["integrator"]),
                ("--shading flat", 2, "shading", None, ["integrator"]),
                ("--integrator cast --ambient 1 --wireframe", 2, "wireframe", None, ["integrator"]),
                ("--integrator raster --ambient 1 --wireframe --shading flat", 2, "wireframe", None, ["shading"]),
                ("--integrator reyes --ambient 1 --aperture 0.1 --focus 1", 2, "integrator", "reyes", ["aperture", "integrator"]),
                ("--integrator reyes", 2, "integrator", "reyes", ["ambient", "integrator"]),
                ("--integrator reyes --denoise svgf", 2, "denoise", "svgf", ["integrator"]),
                ("--integrator raster --ambient 1 --shading-rate 2", 2, "shading_rate", None, ["integrator"]),
                ("--displacement white=x.png,1", 2, "displacement", None, ["integrator"]),
                ("--integrator reyes --ambient 1 --displacement white=x.png", 2, "displacement", "white=x.png", []),
                ("--integrator reyes --ambient 1 --displacement nobody=x.png,1", 2, "displacement", "nobody=x.png,1", []),
                ("--integrator reyes --ambient 1 --displacement *=heights.png,1", 2, "displacement", "*=heights.png,1", []),
                ("--integrator cast", 2, "integrator", "cast", ["ambient", "integrator"])]:
            with self.subTest(flags=flags):
                error = self.refuse(status, "render", "cornell-box", "-o", "x.png", *flags.split(), "--json").events("error")[0]
                self.assertEqual((error.get("setting"), error.get("value")), (setting, value), error)
                self.assertEqual(sorted(error.get("settings", {})), others, error)
                self.assertNotIn("\n", error["text"])
        nowhere = self.refuse(2, "render", "cornell-box", "-o", "x.png", "--integrator", "reyes", "--ambient", "1", "--displacement",
                              "white=nothere.png,1", "--json").events("error")[0]
        self.assertEqual(nowhere["place"], {"file": "nothere.png"})
        self.refuse(2, "render", "cornell-box", "-o", "x.png", *"--integrator radiosity --lamp light=0W --environment 0,0,0".split())
        self.refuse(2, "bench", "frames", "cornell-box", "--integrator", "distributed", "--restir", "di", says=["apply to path"])

    def test_the_error_for_too_little_memory_names_the_limit_and_the_settings_to_reduce(self):
        with open("/proc/meminfo", encoding="ascii") as file:
            machine_mib = int(re.search(r"MemTotal:\s*(\d+) kB", file.read()).group(1)) / 1024
        self.assertLess(machine_mib, 1e6)
        for flags, says, hides in [
                ("--size 64x64 --max-memory 0.001", ["--max-memory", "0.001 MiB", "--size"], "GPU"),
                ("--size 64x64 --max-memory 3 --integrator photon_map", ["3.0 MiB", "--photons", "--max-depth"], "--size"),
                ("--size 64x64 --max-memory 0.4 --integrator irradiance_cache", ["0.4 MiB", "64x64", "--size"], "film"),
                ("--size 65536x16384 --aov depth,albedo,normal,position " + " ".join(f"--lpe l{i}=LD+E" for i in range(99)),
                 ["99 layers of --lpe"], "--max-memory")]:
            outcome = self.refuse(4, "render", "cornell-box", "-o", "x.exr", "--spp", "1", "--device", "cpu", *flags.split(),
                                  says=says)
            last = outcome.stderr.strip().splitlines()[-1]
            self.assertNotIn(hides, last)
            if says[0] == " has ":
                told = float(re.search(r"(?:this machine|service) has ([\d.]+) MiB", last).group(1))
                self.assertLessEqual(told, machine_mib + 1)

    def test_a_flag_without_effect_on_the_scene_causes_a_warning(self):
        write(self.path("floor.obj"), FLOOR)
        ortho = json.loads(gltf_with_cameras())
        ortho["cameras"][0] = {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 9}}
        write(self.path("ortho.gltf"), json.dumps(ortho))
        look = ["--eye", "0,2,4", "--target", "0,0,0"]
        for scene, flags, useless in [
                ("cornell-box", ["--environment-scale", "2"], ["--environment-scale"]),
                ("cornell-box", ["--environment-rotation", "90"], ["--environment-rotation"]),
                ("cornell-box", ["--environment-scale", "2", "--environment", "1,1,1"], []),
                ("floor.obj", [*look, "--environment-scale", "2", "--environment-rotation", "9"], []),
                ("cornell-box", ["--view-height", "1"], ["--view-height"]),
                ("cornell-box", ["--view-height", "1", "--projection", "orthographic"], []),
                ("cornell-box", ["--fov", "30", "--projection", "orthographic"], []),
                ("ortho.gltf", ["--view-height", "1"], []), ("ortho.gltf", ["--fov", "30"], ["--fov"]),
                ("ortho.gltf", ["--fov", "30", "--projection", "orthographic"], ["--fov"]),
                ("cornell-box", ["--focus", "1"], ["--focus"]),
                ("cornell-box", ["--focus", "1", "--aperture", "0.01"], [])]:
            with self.subTest(scene=scene, flags=flags):
                outcome = self.succeed("render", scene, "-o", "x.png", "--size", "8x8", "--spp", "1", "--json", *flags)
                self.assertEqual([event["text"].split(":")[0] for event in outcome.events("warning")], useless, outcome)

    def test_a_line_without_verb_scene_or_output_ends_with_2(self):
        self.refuse(2, says=["render"])
        for strange in ["rendr", "--verison", "-x", "rendr cornell-box -o x.png"]:
            self.refuse(2, *strange.split(), says=[strange.split()[0], "render, merge, view, compare, measure, solve, info, check, convert, bench, lab"])
        self.refuse(2, "--verison", "info", "cornell-box", says=["--verison"])
        self.refuse(2, "render", "-o", "x.png", says=["SCENE"])
        self.refuse(2, "render", "cornell-box", says=["--output"])
        self.refuse(2, "compare", "x.png")
        self.refuse(2, "info")

    def test_a_missing_or_unsupported_file_ends_with_2_and_is_named(self):
        os.mkdir(self.path("folder.obj"))
        os.mkfifo(self.path("pipe.obj"))
        os.symlink("/dev/zero", self.path("endless.png"))
        write(self.path("empty.png"), "")
        for name in ["nowhere.obj", "nowhere.gltf", "cornel-box", "folder.obj", "pipe.obj", "a" * 300 + ".obj"]:
            self.refuse(2, "render", name, "-o", "x.png", says=[name])
            self.refuse(2, "info", name, says=[name])
        write(self.path("README"), "text")
        for name in ["README", "spnza"]:
            self.refuse(2, "render", name, "-o", "x.png", says=[name, ".gltf", "cornell-box"])
            self.refuse(2, "info", name, says=[name, ".gltf", "cornell-box", ".exr"])
        for name in ["nowhere.exr", "endless.png", "empty.png"]:
            self.refuse(2, "info", name, says=[name])
            self.refuse(2, "compare", name, name, says=[name])
            self.refuse(2, "render", "cornell-box", "-o", "x.png", "--environment", name, says=[name])

    def test_a_value_over_a_limit_ends_with_3(self):
        for flag in ["--size 70000x70000", "--size 70000x1", "--size 65536x65536", "--size 99999999999x1",
                     "--eye 1e30,0,0", "--target 0,2e12,0"]:
            with self.subTest(flag=flag):
                self.refuse(3, "render", "cornell-box", "-o", "x.png", *flag.split(), says=["limit"])

    def test_a_picture_that_memory_cannot_hold_ends_with_4_and_lists_the_largest_buffers(self):
        if SANITIZED:
            self.skipTest("sanitizers reserve more than any limit")
        self.refuse(4, "render", "cornell-box", "-o", "x.png", "--size", "20000x20000", "--device", "cpu",
                    says=["film", "MiB"], preexec_fn=limit_addresses(2))

    def test_cuda_without_a_gpu_ends_with_2_and_the_reason(self):
        outcome = self.refuse(2, "render", "cornell-box", "-o", "x.png", "--device", "cuda", says=["--device cuda: "])
        self.assertGreater(len(outcome.stderr.split("--device cuda: ")[1]), 20)

    def test_an_eye_at_its_target_or_an_up_vector_along_the_view_is_refused(self):
        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--eye", "1,2,3", "--target", "1,2,3", says=["--eye"])
        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--eye", "0,3,0", "--target", "0,0,0", "--up", "0,1,0",
                    says=["--up"])
        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--up", "0,0,0", says=["--up"])

    def test_an_unknown_camera_is_refused_with_a_list_of_the_cameras(self):
        write(self.path("two.gltf"), gltf_with_cameras())
        for name in ["middle", "2", "-1", "0x0"]:
            self.refuse(2, "render", "two.gltf", "-o", "x.png", "--camera", name, says=["0  wide", "1  tall"])

    def test_errors_are_reported_even_when_quiet_and_as_json_with_json(self):
        for flags in [[], ["-q"], ["--json"], ["-q", "--json"]]:
            outcome = self.refuse(2, "render", "nowhere.obj", "-o", "x.png", *flags, says=["nowhere.obj"])
            kinds = {event["event"] for event in outcome.events()}
            self.assertLessEqual(kinds, {"error", *(["notice"] if flags == ["--json"] else [])} if "--json" in flags else set())

    def test_skipped_parts_are_reported_before_the_error_that_follows(self):
        write(self.path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        outcome = self.refuse(2, "info", "flat.obj", says=["flat.obj: "])
        self.assertLess(outcome.stderr.index("without area"), outcome.stderr.index("no visible triangle"))

    def test_non_finite_samples_are_counted_and_fail_only_a_strict_render(self):
        light = ["--environment", "1e13,1e13,1e13", "--eye", "0,0,-3", "--target", "0,0,-9"]
        self.assertEqual(self.render(*light)["invalid_samples"], 256)
        outcome = self.run_pertev("render", "cornell-box", "-o", "strict.png", "--size", "16x16", "--spp", "1",
                                  "--strict", *light)
        self.assertEqual(outcome.status, 2, outcome)
        self.assertIn("256 samples", outcome.stderr)
        self.assertEqual(self.render("--strict")["invalid_samples"], 0)


if __name__ == "__main__":
    main()
