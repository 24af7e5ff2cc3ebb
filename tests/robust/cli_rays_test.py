#!/usr/bin/env python3
"""`pertev bench rays`: errors of invalid requests, and measurements of the requested rays."""

from cli_run import FLOOR, CliTest, main, write


class RaysOnTheRecord(CliTest):
    def rays(self, *arguments):
        return self.succeed("bench", "rays", "--device", "cpu", "--runs", "2", "--json", *arguments).events("rays")

    def test_a_bad_flag_or_value_ends_with_2_and_names_the_flag(self):
        for flag in ["--count 0", "--count -1", "--count 1.5", "--count 4294967297", "--count x", "--runs 0", "--fov 0",
                     "--fov nan", "--eye 1,2", "--target x", "--device gpu", "--threads 0", "--size 10x10", "--build x",
                     "--traversal x", "--foo"]:
            with self.subTest(flag=flag):
                self.refuse(2, "bench", "rays", "--scene", "cornell-box", *flag.split(), says=[flag.split()[0]])

    def test_a_missing_scene_ends_with_2_and_is_named(self):
        for name in ["spnza", "nowhere.obj", "", "a" * 300 + ".obj"]:
            self.refuse(2, "bench", "rays", "--device", "cpu", "--scene", name, says=[name or "--scene"])
        write(self.path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        self.refuse(2, "bench", "rays", "--device", "cpu", "--scene", "flat.obj", says=["flat.obj", "no visible triangle"])

    def test_a_missing_record_scene_ends_with_2_and_its_path_is_named(self):
        for folder in [None, "nowhere"]:
            environment = {key: value for key, value in self.environment.items() if key != "PERTEV_SCENES"}
            if folder:
                environment["PERTEV_SCENES"] = self.path(folder)
            for name, file in [("sponza", "crytek-sponza/sponza.obj"), ("bunny", "record/bunny.ply"), ("forest", "record/forest.ply")]:
                self.refuse(2, "bench", "rays", "--device", "cpu", "--scene", name, env=environment,
                            says=["PERTEV_SCENES", file])

    def test_five_sets_are_timed_and_checked(self):
        sets = self.rays("--scene", "cornell-box", "--count", "3000", "--check")
        self.assertEqual([of["set"] for of in sets], ["primary", "shadow", "diffuse1", "diffuse2", "diffuse3"])
        for of in sets:
            self.assertEqual(of["rays"], 3000)
            self.assertEqual((of["scene"], of["runs"], of["best_mrays"], of["ratio_to_best"]), ("cornell-box", 2, None, None))
            self.assertTrue(of["checked"])
            self.assertGreater(of["rays_per_second"], 0)
            self.assertLessEqual(of["least_seconds"], of["median_seconds"])
            self.assertLessEqual(of["median_seconds"], of["greatest_seconds"])
            self.assertGreater(of["hit_share"], 0.2)
            self.assertLessEqual(of["hit_share"], 1)
            self.assertGreaterEqual(of["most_nodes"], of["nodes"])
            self.assertTrue(of["tracer"].startswith("sbvh-reinsertion wide8-simd"), of["tracer"])
        again = self.rays("--scene", "cornell-box", "--count", "3000", "--threads", "1")
        self.assertEqual({of["checked"] for of in again}, {False})
        text = self.succeed("bench", "rays", "--device", "cpu", "--runs", "1", "--scene", "cornell-box", "--count", "3000",
                            "--check").stdout
        self.assertRegex(text, r"\ncornell-box: checked.*\n$")
        for key in ["hit_share", "nodes", "triangles", "most_nodes"]:
            self.assertEqual([of[key] for of in sets], [of[key] for of in again])

    def test_axes_adds_two_sets_of_rays(self):
        sets = self.rays("--scene", "cornell-box", "--count", "3000", "--check", "--axes")
        self.assertEqual([of["set"] for of in sets[5:]], ["along_axes", "beside_axes"])
        along, beside = sets[5:]
        self.assertTrue(along["checked"] and beside["checked"])
        self.assertLess(abs(along["hit_share"] - beside["hit_share"]), 0.01)
        self.assertLess(along["nodes"], 1.1 * beside["nodes"])

    def test_rays_are_traced_according_to_the_flags(self):
        for flags, tracer in [("--build fast", "binned wide8-simd"), ("--traversal skip-links", "sbvh-reinsertion skip-links"),
                              ("--structure octree", "octree octree")]:
            with self.subTest(flags=flags):
                sets = self.rays("--scene", "cornell-box", "--count", "500", "--check", *flags.split())
                self.assertEqual([(of["tracer"][:len(tracer)], of["checked"]) for of in sets], [(tracer, True)] * 5)

    def test_rays_start_at_the_given_camera(self):
        write(self.path("floor.obj"), FLOOR)
        down = self.rays("--scene", "floor.obj", "--count", "1000", "--eye", "0,1,0.01", "--target", "0,0,0", "--fov", "20")
        self.assertEqual([of["hit_share"] for of in down][0], 1)
        self.assertEqual([(of["rays"], of["hit_share"]) for of in down[1:3]], [(1000, 0)] * 2)
        up = self.rays("--scene", "floor.obj", "--count", "1000", "--eye", "0,1,0.01", "--target", "0,9,0")
        self.assertEqual([(of["rays"], of["hit_share"]) for of in up], [(1000, 0)] + [(0, 0)] * 4)
        self.assertEqual([of["rays_per_second"] is None for of in up], [False] + [True] * 4)

    def test_cameras_are_the_same_as_for_pictures(self):
        """The share of rays that hit the floor is that of the camera's view, however the camera is stated."""
        write(self.path("floor.obj"), FLOOR)
        above = ["--scene", "floor.obj", "--count", "1000"]
        pose = ["--camera-pose", "1,0,0,0,0,0,1,1,0,-1,0,0", "--intrinsics-size", "64x36"]
        for camera in [["--eye", "0,1,0", "--target", "0,0,0", "--up", "0,0,-1", "--fov", "20"],
                       ["--eye", "0,1,0", "--target", "0,0,0", "--up", "0,0,-1", "--projection", "orthographic", "--view-height", "0.1"],
                       [*pose, "--intrinsics", "200,200,32,18"]]:
            with self.subTest(camera=camera):
                self.assertEqual(self.rays(*above, *camera)[0]["hit_share"], 1)
        far = self.rays(*above, *pose, "--intrinsics", "200,200,9999,18")
        self.assertEqual(far[0]["hit_share"], 0)
        self.refuse(2, "bench", "rays", *above, "--camera", "none", says=["--camera"])
        self.refuse(2, "bench", "rays", *above, *pose[:2], "--intrinsics", "200,200,32,32", "--intrinsics-size", "64x64",
                    says=["--intrinsics"])
        render = ["render", "floor.obj", "--device", "cpu", "--spp", "1", "-q"]
        self.succeed(*render, "--size", "64x36", "--eye", "0,1,0", "--target", "0,0,0", "--up", "0,0,-1", "--fov", "20", "-o", "a.exr")
        self.assertEqual(self.rays(*above, "--camera-from", "a.exr")[0]["hit_share"], 1)

    def test_a_set_without_rays_is_reported_as_empty(self):
        write(self.path("floor.obj"), FLOOR)
        text = self.succeed("bench", "rays", "--device", "cpu", "--runs", "1", "--scene", "floor.obj", "--count", "1000",
                            "--eye", "0,1,0.01", "--target", "0,9,0", "--check").stdout
        self.assertRegex(text, r"(?m)^floor +primary +1000 +[\d.]+ ")
        for name in ["shadow", "diffuse1", "diffuse2", "diffuse3"]:
            self.assertRegex(text, rf"(?m)^floor +{name} +0 .* empty, because ")

    def test_camera_errors_name_only_flags_that_bench_rays_has(self):
        outcome = self.refuse(2, "bench", "rays", "--scene", "cornell-box", "--eye", "1,2,3", "--target", "1,2,3",
                              says=["--eye 1,2,3"])
        self.assertNotIn("--up", outcome.stderr)

    def test_without_json_a_table_is_printed(self):
        text = self.succeed("bench", "rays", "--device", "cpu", "--runs", "1", "--scene", "cornell-box", "--count",
                            "1000").stdout
        self.assertRegex(text, r"Mrays/s")
        self.assertNotIn("checked", text)
        self.assertRegex(text, r"(?m)^cornell-box +diffuse3 +1000 +[\d.]+ +[\d.]+ +[\d.]+ +[\d.]+ +0\.\d+ ")


if __name__ == "__main__":
    main()
