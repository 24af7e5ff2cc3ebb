#!/usr/bin/env python3
"""The command line: exit codes, output streams, and no remaining files."""

import json
import math
import os
import re
import resource
import statistics
import time

from cli_run import FLOOR, PROGRAM, SANITIZED, UNMETERED, CliTest, as_flag, gltf_with_cameras, main, read_exr, write

FLAGS = {
    "merge": "--denoise --exposure --tone-map --lut --lut-input --exr-colors --png-bits --output-format --output -o --partial --progress --quiet -q --json",
    "render": "--output -o --progress --crop --light-group --lut --lut-input --exr-colors --png-bits --output-format --rows --part --part-base --samples --checkpoint --checkpoint-every --records --camera-pose --convention --intrinsics --intrinsics-size --lens --distortion --eye-offset --convergence --camera-from --cameras --stereo --layers-at --frame-denoiser "
              "--allow-path --up-axis --unit --quiet -q --json --strict --camera --eye --target --up --fov --projection "
              "--view-height --aperture --aperture-blades --aperture-rotation --aperture-ratio --focus --environment --sun-sky --environment-rotation --environment-scale --medium "
              "--two-sided-lights --show-back-faces --size --tone-map --exposure --transparent --aov --spp --time-limit --denoise "
              "--integrator --max-depth --ambient --shading --wireframe --seed --sampler --filter --filter-radius --clamp --mip-maps --light-choice --light-sampling --device --threads "
              "--no-bvh-cache --build --structure --traversal --rta --order --distribution --time --frames --fps --camera-path "
              "--turntable --continue --cuts --lpe --lamp --ies --efficacy --false-color --false-color-range --f-number --shutter-time --iso "
              "--shutter --shading-rate --displacement --photons --gather --radius --caustic-radius --nearest "
              "--accuracy --hemisphere-rays --show-records --patch-size --subdivisions --contrast --form-factors --patch-rays --hemicube "
              "--solver --tolerance --steps --link-error --max-memory --solution --flat-patches --real-time --restir --restir-history --resolution-scale --moving-depth --history --passes --no-anti-alias "
              "--no-firefly-clamping --no-temporal-gradients --no-history-clamping --no-reconstruction --animation --file-scene --variant --define --movable --material --max-texture-size --ground --author --license --settings",
    "measure": "--at --normal --spp --max-depth --seed --lamp --ies --efficacy --time --allow-path --up-axis --unit --environment --sun-sky --environment-rotation "
               "--environment-scale --medium --two-sided-lights --device --threads --no-bvh-cache --animation --file-scene --variant --define --material --max-texture-size --strict --quiet -q --json",
    "solve radiosity": "--output -o --patch-size --subdivisions --contrast --form-factors --patch-rays --hemicube --solver "
                       "--tolerance --steps --link-error --max-memory --seed --time --lamp --ies --efficacy --allow-path --up-axis --unit --environment --sun-sky --environment-rotation "
                       "--environment-scale --two-sided-lights --threads --no-bvh-cache --animation --file-scene --variant --define --material --max-texture-size --strict --quiet -q --json",
    "info": "--file-scene --variant --define --material --max-texture-size --allow-path --up-axis --unit --settings --quiet -q --json",
    "check": "--file-scene --variant --define --material --max-texture-size --allow-path --up-axis --unit --quiet -q --json",
    "convert": "--file-scene --variant --define --material --max-texture-size --allow-path --up-axis --unit --strict --quiet -q --json",
    "compare": "--blocks --difference --metric --threshold --quiet -q --json",
    "bench": "--scene --size --spp --device --threads --build --structure --traversal --rta --order --distribution --report --quiet -q --json",
    "bench build": "--scene --runs --compare --device --threads --report --quiet -q --json",
    "bench rays": "--scene --camera --eye --target --up --fov --projection --view-height --camera-pose --convention --intrinsics --intrinsics-size --camera-from --count --runs --check --device --threads --axes --build --structure --traversal --rta --order --distribution --report --quiet -q --json",
}


def limit_files():
    """Limits files to 4 KiB (preexec_fn), as on a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


class WhatIsWritten(CliTest):
    def test_an_output_that_cannot_be_written_ends_with_6_before_the_scene_is_read(self):
        os.mkdir(self.path("folder.png"))
        os.symlink("/dev/full", self.path("full.png"))
        os.symlink("nowhere/x.png", self.path("dangling.png"))
        os.symlink("loop.png", self.path("loop.png"))
        for name in ["nowhere/x.png", "folder.png", "full.png", "dangling.png", "loop.png", "/proc/x.png", "a" * 300 + ".png"]:
            with self.subTest(output=name):
                self.refuse(6, "render", "nowhere.obj", "-o", "good.png", "-o", name, says=[name])

    def test_a_picture_too_large_for_its_format_ends_with_3_before_the_scene_is_read(self):
        for size in ["65501x1", "1x65501"]:
            self.refuse(3, "render", "nowhere.obj", "-o", "good.png", "-o", "late.jpg", "--size", size,
                        says=["late.jpg", "65500"])
            self.refuse(3, "bench", "render", "--scene", "nowhere.obj", "-o", "late.jpg", "--size", size,
                        says=["late.jpg", "65500"])
            self.render(output="whole.png", size=size)

    def test_an_unknown_file_extension_ends_with_2_and_lists_the_known_ones(self):
        for name in ["x.bmp", "x", "x.png.", ".png"]:
            self.refuse(2, "render", "cornell-box", "-o", name, says=[name, ".exr"])

    def test_a_disk_that_fills_up_ends_with_6_and_keeps_the_old_picture(self):
        self.render(output="x.hdr")
        with open(self.path("x.hdr"), "rb") as file:
            old = file.read()

        self.refuse(6, "render", "cornell-box", "-o", "x.hdr", "--size", "128x128", "--spp", "1", says=["x.hdr"],
                    preexec_fn=limit_files)
        with open(self.path("x.hdr"), "rb") as file:
            self.assertEqual(file.read(), old)

    def test_one_failed_output_leaves_the_other_outputs_intact(self):
        outcome = self.run_pertev("render", "cornell-box", "-o", "large.hdr", "-o", "small.jpg", "-o", "large.exr",
                                  "--size", "36x36", "--spp", "1", "--device", "cpu", "--json", *UNMETERED,
                                  preexec_fn=limit_files)
        self.assertEqual(outcome.status, 6, outcome)
        self.assertEqual(self.files(), ["small.jpg"])
        self.assertEqual(self.info("small.jpg")["width"], 36)
        self.assertEqual(len(outcome.events("done")), 1)
        for name in ["large.hdr", "large.exr"]:
            self.assertIn(name, outcome.error())
        self.assertEqual([(of["path"], of["written"], of["error"] is None) for of in outcome.events("output")],
                         [("large.hdr", False, False), ("small.jpg", True, True), ("large.exr", False, False)])

    def test_new_files_follow_the_users_mask_and_old_ones_keep_their_permissions(self):
        def mode(name):
            return os.stat(self.path(name)).st_mode & 0o777

        arguments = ["render", "cornell-box", "-o", "x.png", "--size", "8x8", "--spp", "1", *UNMETERED]
        self.succeed(*arguments, umask=0o077)
        self.assertEqual(mode("x.png"), 0o600)
        os.chmod(self.path("x.png"), 0o664)
        self.succeed(*arguments, umask=0o022)
        self.assertEqual(mode("x.png"), 0o664)
        self.succeed(*arguments[:3], "y.png", *arguments[4:], umask=0o002)
        self.assertEqual(mode("y.png"), 0o664)

    def test_one_render_writes_every_output_wherever_its_flag_stands(self):
        self.succeed("render", "-o", "a.png", "cornell-box", "-o", "b.EXR", "--size", "16x8", "--spp", "1", "-o",
                     "c.jpg", "--aov", "normal", "-o", "d.hdr")
        self.assertEqual(self.files(), ["a.png", "b.EXR", "c.jpg", "d.hdr"])
        for name in self.files():
            self.assertEqual((self.info(name)["width"], self.info(name)["height"]), (16, 8), name)
        self.succeed("render", "-o", "a.exr", "--aov", "normal", "cornell-box", "--size", "8x8", "--spp", "1")

    def test_an_output_that_is_a_symbolic_link_stays_one(self):
        os.mkdir(self.path("real"))
        os.symlink("real/picture.png", self.path("link.png"))
        for _ in range(2):  # the link first has no target, then a picture
            self.render(output="link.png")
            self.assertTrue(os.path.islink(self.path("link.png")))
            self.assertEqual(os.listdir(self.path("real")), ["picture.png"])

    def test_a_full_standard_output_ends_with_6(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            for arguments in [["--version"], ["--help"], ["info", "cornell-box"], ["info", "cornell-box", "--json"]]:
                outcome = self.run_pertev(*arguments, stdout=full)
                self.assertEqual(outcome.status, 6, outcome)
                self.assertIn("standard output", outcome.stderr)

    def test_a_closed_pipe_at_standard_output_does_not_lose_the_picture(self):
        whole = self.render(output="whole.png")["hash"]
        reading, writing = os.pipe()
        os.close(reading)
        outcome = self.run_pertev("render", "cornell-box", "-o", "x.exr", "--size", "16x16", "--spp", "1", "--device",
                                  "cpu", "--json", stdout=writing)
        os.close(writing)
        self.assertEqual((outcome.status, outcome.stderr), (0, ""), outcome)
        self.assertEqual(self.info("x.exr")["hash"], whole)

    def test_a_closed_or_full_standard_error_does_not_damage_a_picture(self):
        whole = self.render(output="whole.png")["hash"]
        arguments = ["render", "cornell-box", "-o", "x.exr", "--size", "16x16", "--spp", "1", "--device", "cpu"]
        self.succeed(*arguments, preexec_fn=lambda: os.closerange(0, 3))
        self.assertEqual(self.info("x.exr")["hash"], whole)
        with open("/dev/full", "w", encoding="utf-8") as full:
            self.succeed(*arguments, stderr=full)
            self.assertEqual(self.run_pertev("info", "nowhere.obj", stderr=full).status, 2)

    def test_a_cache_folder_that_cannot_be_written_is_a_warning(self):
        n = 130  # so many triangles that their tree is cached
        mesh = "".join(f"v {x} {math.sin(x * y)} {y}\n" for y in range(n) for x in range(n))
        mesh += "".join(f"f {x + n * y} {x + 1 + n * y} {x + n + n * y}\n" for y in range(n - 1) for x in range(1, n))
        write(self.path("hills.obj"), mesh)
        whole = self.render("--no-bvh-cache", scene="hills.obj")["hash"]

        def check_warning(**options):
            arguments = ["render", "hills.obj", "-o", "x.png", "--size", "16x16", "--spp", "1", "--device", "cpu", "--json",
                         *UNMETERED]
            outcome = self.succeed(*arguments, **options)
            self.assertEqual(len([event for event in outcome.events("warning") if "place" in event]), 1)
            self.assertEqual(outcome.events("done")[0]["hash"], whole)

        check_warning(preexec_fn=limit_files)
        for folder in ["/proc", os.path.abspath(PROGRAM)]:  # the second is a file
            self.environment["XDG_CACHE_HOME"] = folder
            check_warning()
        self.environment.pop("XDG_CACHE_HOME")
        self.environment["HOME"] = "/proc"
        check_warning()


class WhatIsSaid(CliTest):
    def test_json_lines_all_parse_and_stdout_has_nothing_else(self):
        outcome = self.succeed("render", "cornell-box", "-o", "x.exr", "--size", "32x32", "--spp", "3", "--json")
        kinds = [event["event"] for event in outcome.events()]
        self.assertLessEqual(set(kinds), {"notice", "warning", "scene", "picture", "camera", "progress", "exposure", "output",
                                          "done"})
        self.assertEqual(kinds[-1], "done")
        self.assertIs(outcome.events()[-1]["interrupted"], False)
        self.assertEqual(outcome.stderr, "")
        self.assertEqual(outcome.events("progress")[-1]["samples"], 3)
        self.assertEqual(len(self.succeed("info", "x.exr", "--json").events()), 1)
        self.assertEqual(len(self.succeed("compare", "x.exr", "x.exr", "--json").events()), 1)

    def test_json_is_valid_for_any_file_name(self):
        for name in [b"\xff\xfe.obj", b'"quotes\\".obj', "käfer\u2028\x7f.obj".encode(), b"line\nbreak.obj"]:
            name = os.fsdecode(name)
            write(self.path(name), FLOOR)
            self.succeed("info", name, "--json").events("info")
            self.render(scene=name)

    def test_quiet_prints_nothing_on_success(self):
        write(self.path("floor.obj"), FLOOR)
        for arguments in [["render", "floor.obj", "-o", "x.exr", "--size", "8x8", "--spp", "1"],
                          ["info", "floor.obj"], ["info", "x.exr"], ["compare", "x.exr", "x.exr"]]:
            outcome = self.succeed(*arguments, "-q")
            self.assertEqual(outcome.stdout + outcome.stderr, "", outcome)

    def test_the_last_line_has_time_rates_memory_hash_and_invalid_samples(self):
        outcome = self.succeed("render", "cornell-box", "-o", "x.exr", "--size", "8x8", "--spp", "2")
        self.assertEqual(outcome.stdout, "")
        self.assertRegex(outcome.stderr.splitlines()[-1],
                         r"^2 spp in [\d.]+ s .*, [\d.e+-]+ s per frame of 1 spp \([\d.e+]+ frames/s\), [\d.]+ Msamples/s, [\d.]+ Mrays/s, peak \d+ MiB.*, 0 invalid samples, "
                         r"picture [0-9a-f]{32}$")
        self.assertEqual(outcome.stderr.split()[-1], self.info("x.exr")["hash"])

    def test_rates_count_the_pixels_that_get_samples(self):
        for flags in [[], ["--rows", "1:3"], ["--crop", "3,1,5,4"], ["--part", "1/2"], ["--rows", "1:3", "--part", "2/2"]]:
            output = "x.pvf" if "--part" in flags else "x.exr"
            done = self.render("--max-depth", "0", *flags, size="16x12", spp=4, output=output)
            self.assertAlmostEqual(done["samples_per_second"] / done["rays_per_second"], 1, 5, flags)  # a ray each

    def test_next_event_estimation_alone_needs_no_last_ray(self):
        for material in [], ["--material", "white roughness=0.5"]:  # vertices in lanes, and one by one
            rays = {}
            for name in ("mis", "nee", "bsdf"):
                done = self.render("--max-depth", "1", "--light-sampling", name, *material, size="16x12", spp=4)
                rays[name] = done["rays_per_second"] / done["samples_per_second"]
            self.assertAlmostEqual(rays["mis"], rays["nee"] + rays["bsdf"] - 1, 5)  # each traces the camera's ray
            self.assertGreater(rays["nee"], 1.25)
            self.assertGreater(rays["bsdf"], 1.5)

    def test_version_is_quick(self):
        seconds = []
        for _ in range(9):
            start = time.monotonic()
            self.assertRegex(self.succeed("--version").stdout, r"^pertev \d+\.\d+\.\d+ \(([0-9a-f]{12,}\+?|unknown)\)\n")
            seconds.append(time.monotonic() - start)
        print(f"pertev --version: median {1000 * statistics.median(seconds):.1f} ms", flush=True)
        self.assertLess(statistics.median(seconds), 2.0 if SANITIZED else 0.2)  # takes 5 ms on an idle machine

    def test_help_of_each_verb_lists_every_flag(self):
        verbs = self.succeed("--help").stdout
        for verb, flags in FLAGS.items():
            self.assertIn(verb.split()[0], verbs)
            text = self.succeed(*verb.split(), "--help", "all").stdout
            listed = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", re.sub(r" {3,}.*", "", text)))
            self.assertEqual(listed - {"-h", "--help"}, set(flags.split()), verb)
            self.assertNotRegex(" ".join(text.split()), r"[^.] Required\.", verb)

    def test_the_progress_bar_shows_share_samples_rate_and_time_left_only_on_a_terminal(self):
        arguments = ["render", "cornell-box", "-o", "x.png", "--size", "16x16", "--spp", "8", "--device", "cpu", *UNMETERED]
        self.assertNotIn("\r", self.succeed(*arguments).stderr)
        self.assertNotIn("spp  ", self.succeed(*arguments).stderr)
        self.assertRegex(self.stderr_on_a_terminal(arguments),
                         r"\r\[=+\] 100 %  8/8 spp  [\d.]+ Mrays/s  0 s left\x1b\[K\r\n8 spp in ")
        self.assertEqual(self.stderr_on_a_terminal([*arguments, "-q"]), "")
        self.assertEqual(self.stderr_on_a_terminal([*arguments, "--json"]), "")


class WhatIsRendered(CliTest):
    def test_the_picture_does_not_depend_on_the_number_of_threads(self):
        hashes = {self.render("--threads", count, size="40x30", spp=4)["hash"] for count in [1, 2, 5]}
        self.assertEqual(len(hashes), 1)

    def test_info_prints_the_same_hash_as_render(self):
        for flags in [[], ["--transparent"], ["--aov", "albedo,ids"]]:
            done = self.render(*flags, output="x.exr")
            self.assertEqual(self.info("x.exr")["hash"], done["hash"])
            self.assertEqual(self.info("x.exr")["pertev.hash"], done["hash"])

    def test_exr_metadata_record_how_the_picture_was_rendered(self):
        self.render("--seed", "7", "--max-depth", "3", spp=5, output="x.exr")
        made = self.info("x.exr")
        self.assertEqual((made["pertev.spp"], made["pertev.seed"], made["pertev.max_depth"]), (5, "7", 3))
        for name in ["version", "scene", "integrator", "sampler", "filter", "device", "rays", "render_seconds",
                     "load_seconds", "build_seconds", "invalid_samples"]:
            self.assertIn(f"pertev.{name}", made)

    def test_exr_metadata_as_flags_reproduce_the_picture(self):
        write(self.path("floor.obj"), FLOOR)
        view = ["--eye", "0.3,2.1,4.7", "--target", "0.1,0.2,0"]
        for scene, flags in [("cornell-box", view), ("floor.obj", view), ("floor.obj", ["--eye", "0,3,0", "--target", "0,0,0"]),
                             ("floor.obj", [*view, "--up", "1,3,0.2", "--fov", "33"]),
                             ("floor.obj", [*view, "--projection", "orthographic"]),
                             ("floor.obj", [*view, "--projection", "orthographic", "--view-height", "1.7"]),
                             ("floor.obj", [*view, "--aperture", "0.1"]),
                             ("floor.obj", [*view, "--aperture", "0.1", "--aperture-blades", "5", "--aperture-rotation", "33.3", "--aperture-ratio",
                                            "1.7", "--focus", "3", "--filter", "tent"]),
                             ("floor.obj", [*view, "--filter", "gaussian", "--filter-radius", "2.5"]),
                             ("floor.obj", [*view, "--environment-rotation", "70", "--environment-scale", "0.3"]),
                             ("floor.obj", [*view, "--environment", "1,0.5,0.25", "--environment-scale", "3"])]:
            with self.subTest(scene=scene, flags=flags):
                made = self.render(*flags, scene=scene, output="x.exr")
                told = self.info("x.exr")
                again = []
                for name in ["eye", "target", "up", "fov", "projection", "view_height", "aperture", "aperture_blades",
                             "aperture_rotation", "aperture_ratio", "focus", "filter",
                             "filter_radius", "environment", "environment_scale", "environment_rotation"]:
                    value = told.get("pertev." + name)
                    if value not in [None, "made up", "none"]:
                        again += ["--" + name.replace("_", "-"), as_flag(value)]
                self.assertEqual(self.render(*again, scene=scene)["hash"], made["hash"], again)
        self.render(scene="floor.obj", output="x.exr")  # a default view is as precise as its printed numbers
        told = self.info("x.exr")
        same = [word for name in ["eye", "target", "up", "fov", "ground"] for word in ["--" + name, as_flag(told["pertev." + name])]]
        near = self.render(*same, scene="floor.obj", output="y.exr")
        self.assertGreater(near["samples"], 0)
        self.assertLess(self.succeed("compare", "x.exr", "y.exr", "--json").events("compare")[0]["flip"], 0.01)

    def test_info_and_render_count_the_same_lights_and_use_the_singular_for_one(self):
        said = self.succeed("render", "cornell-box", "-o", "x.png", "--size", "8x8", "--spp", "1").stderr
        self.assertIn("38 triangles, 8 instances, 2 lights; ", said)
        told = self.info("cornell-box")
        self.assertEqual((told["lights"], told["emissive_triangles"]), (2, 2))
        write(self.path("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        said = self.succeed("render", "one.obj", "-o", "x.png", "--size", "8x8", "--spp", "1").stderr
        self.assertIn("one.obj: 1 triangle, 1 instance, 1 light; ", said)

    def test_a_camera_without_a_name_is_listed_by_its_number(self):
        cameras = json.loads(gltf_with_cameras())
        del cameras["cameras"][1]["name"]
        write(self.path("two.gltf"), json.dumps(cameras))
        self.assertEqual(self.info("two.gltf")["cameras"], ["wide", "1"])

    def test_aov_layers_are_in_the_exr_and_agree_with_each_other(self):
        # The tall and the short box in front of the open side. With one sample per pixel no pixel is a mean of two surfaces.
        self.render("--aov", "albedo,normal,depth", "--aov", "position,ids", size="24x24", output="x.exr")
        width, height, layers = read_exr(self.path("x.exr"))
        self.assertEqual((width, height), (24, 24))
        self.assertEqual(set(layers), {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y",
                                       "normal.Z", "depth.Z", "position.X", "position.Y", "position.Z", "id.instance",
                                       "id.primitive", "id.material"})
        pixels = [{name: rows[y][x] for name, rows in layers.items()} for y in range(height) for x in range(width)]
        hits = [pixel for pixel in pixels if pixel["id.instance"] < 8]
        self.assertGreater(len(hits), 0.9 * len(pixels))
        for pixel in hits:
            normal = [pixel["normal." + axis] for axis in "XYZ"]
            position = [pixel["position." + axis] for axis in "XYZ"]
            self.assertAlmostEqual(math.hypot(*normal), 1, places=3)
            self.assertTrue(all(-1e-4 <= p <= 0.5593 for p in position), position)
            self.assertAlmostEqual(pixel["depth.Z"], position[2] + 0.8, places=3)  # the eye is at z = -0.8
            self.assertTrue(all(0 <= pixel["albedo." + channel] <= 1 for channel in "RGB"))
            self.assertLess(pixel["id.material"], 4)
        self.assertGreater(len({pixel["id.instance"] for pixel in hits}), 5)

    def test_transparent_stores_coverage_and_does_not_change_covered_pixels(self):
        write(self.path("floor.obj"), FLOOR)
        view = ["--eye", "0,2,4", "--target", "0,0,0", "--environment", "1,1,1"]
        self.render(*view, "--transparent", scene="floor.obj", output="x.exr", spp=4)
        _, _, layers = read_exr(self.path("x.exr"))
        alphas = [value for row in layers["A"] for value in row]
        self.assertEqual((min(alphas), max(alphas)), (0, 1))
        self.assertEqual((layers["A"][0][0], layers["R"][0][0]), (0, 0))
        self.render(*view, scene="floor.obj", output="opaque.exr", spp=4)
        _, _, opaque = read_exr(self.path("opaque.exr"))
        self.assertNotIn("A", opaque)
        self.assertEqual(opaque["R"][0][0], 1)
        for x in range(16):
            if layers["A"][9][x] == 1:
                self.assertEqual(layers["R"][9][x], opaque["R"][9][x])
        both = self.succeed("render", "floor.obj", *view, "--transparent", "-o", "x.png", "-o", "x.jpg", "--size",
                            "16x16", "--spp", "1")
        self.assertIn("x.jpg: --transparent", both.stderr)
        self.assertNotIn("x.png: --transparent", both.stderr)
        with open(self.path("x.png"), "rb") as file:
            self.assertEqual(file.read()[25], 6)  # PNG's colour type with alpha

    def test_tone_maps_and_exposure_change_pngs_but_not_the_hash_of_the_film(self):
        pictures, hashes = set(), set()
        for flags in [["--tone-map", name] for name in ["srgb", "agx", "aces", "neutral"]] + [["--exposure", "-2"]]:
            hashes.add(self.render(*flags)["hash"])
            pictures.add(self.info("picture.png")["hash"])
        self.assertEqual((len(hashes), len(pictures)), (1, 5))

    def test_every_setting_that_changes_the_light_changes_the_hash(self):
        choices = [[], ["--seed", "1"], ["--sampler", "independent"], ["--filter", "box"], ["--filter", "tent"],
                   ["--filter", "gaussian"], ["--filter-radius", "3"], ["--integrator", "direct"],
                   ["--integrator", "indirect"], ["--integrator", "distributed"], ["--integrator", "light"],
                   ["--integrator", "bidirectional"], ["--integrator", "photon_map"],
                   ["--integrator", "photon_map", "--gather", "direct"], ["--integrator", "photon_map", "--photons", "5000"],
                   ["--integrator", "photon_map", "--radius", "0.1"], ["--integrator", "photon_map", "--nearest", "5"],
                   ["--integrator", "irradiance_cache"], ["--integrator", "irradiance_cache", "--accuracy", "0.7"],
                   ["--integrator", "irradiance_cache", "--hemisphere-rays", "50"],
                   ["--integrator", "irradiance_cache", "--show-records"], ["--integrator", "cast", "--ambient", "0.5"],
                   ["--integrator", "radiosity", "--patch-size", "0.3", "--patch-rays", "16", "--subdivisions", "0"],
                   ["--integrator", "whitted", "--ambient", "0.5,0.2,0.1"],
                   ["--integrator", "raster", "--ambient", "0.5"], ["--integrator", "raster", "--wireframe", "--ambient", "0.5"],
                   ["--integrator", "reyes", "--ambient", "0.5"],
                   ["--max-depth", "2"], ["--clamp", "0.1"], ["--fov", "30"],
                   ["--environment", "1,0.5,0.2"], ["--environment", "1,1,1", "--environment-scale", "3"],
                   ["--aperture", "0.05", "--focus", "0.9"], ["--aperture", "0.05", "--focus", "1.3"],
                   ["--eye", "0.3,0.3,-0.7"], ["--target", "0.2,0.2,0"], ["--up", "1,1,0"],
                   ["--projection", "orthographic"], ["--projection", "orthographic", "--view-height", "0.3"]]
        hashes = [self.render(*flags, size="32x32", spp=2)["hash"] for flags in choices]
        self.assertEqual(len(set(hashes)), len(choices))
        for flags in [["--aperture", "0"], ["--integrator", "hybrid"]]:
            self.assertEqual(self.render(*flags, size="32x32", spp=2)["hash"], hashes[0])

    def test_environment_flags_apply_to_the_default_sky(self):
        write(self.path("floor.obj"), FLOOR)
        look = ["--eye", "0,2,4", "--target", "0,0,0"]
        hashes = {self.render(*look, *flags, scene="floor.obj")["hash"]
                  for flags in [[], ["--environment-scale", "2"], ["--environment-rotation", "90"]]}
        self.assertEqual(len(hashes), 3)

    def test_a_camera_is_chosen_by_name_or_number_and_gives_the_picture_its_shape(self):
        write(self.path("two.gltf"), gltf_with_cameras())
        for flags, shape in [([], (1440, 720)), (["--camera", "tall"], (360, 720))]:
            self.succeed("render", "two.gltf", "-o", "x.exr", "--spp", "1", *flags)
            made = self.info("x.exr")
            self.assertEqual((made["width"], made["height"]), shape)
        hashes = {flags[-1] if flags else "none": self.render(*flags, scene="two.gltf")["hash"]
                  for flags in [[], ["--camera", "wide"], ["--camera", "0"], ["--camera", "tall"], ["--camera", "1"]]}
        self.assertEqual({hashes[key] for key in ["none", "wide", "0"]}, {hashes["wide"]})
        self.assertEqual(hashes["tall"], hashes["1"])
        self.assertNotEqual(hashes["tall"], hashes["wide"])
        self.assertEqual(self.info("two.gltf")["cameras"], ["wide", "tall"])

    def test_looking_straight_down_shows_what_lies_below(self):
        write(self.path("floor.obj"), FLOOR)
        for eye, height in [("0,3,0", 3), ("0.3,7,0.3", 7)]:
            self.render("--eye", eye, "--target", eye.replace(f",{height},", ",0,"), "--fov", "10", "--aov", "depth,ids",
                        scene="floor.obj", output="x.exr")
            _, _, layers = read_exr(self.path("x.exr"))
            for row in layers["depth.Z"]:
                self.assertTrue(all(abs(depth - height) < 1e-4 for depth in row))

    def test_an_orthographic_view_has_parallel_rays_and_the_requested_height(self):
        write(self.path("floor.obj"), FLOOR)
        view = ["--eye", "0,3,0", "--target", "0,0,0", "--projection", "orthographic", "--filter", "box"]
        self.render(*view, "--view-height", "1.6", "--aov", "position", scene="floor.obj", output="x.exr", size="20x20",
                    spp=16)
        _, _, layers = read_exr(self.path("x.exr"))
        for x in range(20):
            column = [layers["position.X"][y][x] for y in range(20)]
            self.assertTrue(all(abs(value - (x - 9.5) * 0.08) < 0.03 for value in column), column)
        # Without a height, the view is as high as the perspective one in the target's plane.
        done = self.render(*view, "--fov", "30", scene="floor.obj")
        same = self.render(*view, "--view-height", 6 * math.tan(math.radians(15)), scene="floor.obj")
        self.assertEqual(self.picture_difference(done, same), 0)

    def picture_difference(self, *renders):
        return len({done["hash"] for done in renders}) - 1

    def test_negative_numbers_are_values_and_not_flags(self):
        for view in [["--eye", "-.5,0.2,-1"], ["--eye=-0.5,0.2,-1"]]:
            self.render(*view, "--target", "-0.5,0.2,0", "--exposure", "-1", "--environment-rotation", "-30")


class WhatIsCompared(CliTest):
    def test_a_picture_equals_itself_and_differs_from_another(self):
        self.render(output="a.exr", spp=2)
        self.render("--seed", "1", output="b.exr", spp=2)
        same = self.succeed("compare", "a.exr", "a.exr", "--json").events("compare")[0]
        self.assertEqual([same[key] for key in ["equal", "rel_mse", "mse", "flip", "hdr_flip"]], [True, 0, 0, 0, 0])
        other = self.succeed("compare", "a.exr", "b.exr", "--json").events("compare")[0]
        self.assertFalse(other["equal"])
        self.assertGreater(min(other[key] for key in ["rel_mse", "mse", "flip", "hdr_flip"]), 0)

    def test_pictures_that_differ_only_in_alpha_are_reported(self):
        self.render(output="a.exr")
        self.render("--transparent", output="b.exr")
        for blocks in [[], ["--blocks", "4"]]:
            differ = self.succeed("compare", "a.exr", "b.exr", "--json", *blocks).events("compare")[0]
            self.assertEqual((differ["equal"], differ["equal_colors"], differ["mse"]), (False, True, 0))
            self.assertIn("equal colours to the last bit, different alpha",
                          self.succeed("compare", "a.exr", "b.exr", *blocks).stdout)
        self.render("--seed", "1", output="c.exr")
        self.assertFalse(self.succeed("compare", "a.exr", "c.exr", "--json").events("compare")[0]["equal_colors"])

    def test_pictures_of_different_sizes_are_refused_with_both_sizes(self):
        self.render(output="a.exr", size="16x8")
        self.render(output="b.exr", size="8x16")
        self.refuse(2, "compare", "a.exr", "b.exr", says=["16 x 8", "8 x 16"])


if __name__ == "__main__":
    main()
