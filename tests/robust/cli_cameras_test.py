"""Cameras on the command line: matrices, K and lenses, the metadata of a picture, and files of many cameras."""

import json
import math
import os

from cli_lab_run import rows_of
from cli_run import CliTest, as_flag, main, read_exr, read_png, write

VIEW = ["--eye", "0.3,0.35,-0.7", "--target", "0.2,0.25,0.3", "--fov", "40"]  # into the box


class CamerasOfCalibrations(CliTest):
    def matrix(self, *flags):
        """Returns the columns of the matrix world from camera."""
        self.render(*flags, output="x.exr")
        return self.info("x.exr")["pertev.world_from_camera"]

    def pose(self, columns):
        return ",".join(str(column[row]) for row in range(3) for column in columns)

    def test_every_convention_of_a_pose_makes_the_picture_of_eye_and_target_to_the_byte(self):
        expected = self.render(*VIEW)["hash"]
        x, y, z, at = self.matrix(*VIEW)

        def minus(v):
            return [-n for n in v]

        def with_z_up(v):
            return [v[0], -v[2], v[1]]

        conventions = {"opengl": [x, y, z, at], "opencv": [x, minus(y), minus(z), at],
                       "blender": [with_z_up(v) for v in [x, y, z, at]]}
        for convention, columns in conventions.items():
            with self.subTest(convention=convention):
                flags = ["--camera-pose=" + self.pose(columns), "--convention", convention, "--fov", "40"]
                self.assertEqual(self.render(*flags)["hash"], expected)

    def test_a_picture_s_metadata_make_its_camera_again_to_the_byte(self):
        calibrated = ["--intrinsics", "20.5,24,7,9", "--distortion=-0.2,0.1,0.01,0,0.02", *VIEW[:4]]
        for flags in [VIEW, ["--projection", "orthographic", *VIEW[:4]], [*VIEW, "--aperture", "0.05"], calibrated,
                      ["--lens", "fisheye", "--distortion", "0.1,0,0,0", *VIEW]]:
            with self.subTest(flags=flags):
                first = self.render(*flags, output="a.exr")
                again = self.succeed("render", "cornell-box", "-o", "b.exr", "--camera-from", "a.exr", "--spp", 1, "--device",
                                     "cpu", "--json").events("done")[0]
                self.assertEqual(again["hash"], first["hash"])
        self.assertEqual(as_flag(self.info("b.exr")["pertev.lens"]), "fisheye")

    def test_intrinsics_of_another_size_scale_with_the_picture(self):
        small = self.render("--intrinsics", "20,24,7,9", *VIEW[:4], size="16x16")["hash"]
        flags = ["--intrinsics", "40,48,14,18", "--intrinsics-size", "32x32", *VIEW[:4]]
        self.assertEqual(self.render(*flags, size="16x16")["hash"], small)
        self.refuse(2, "render", "cornell-box", "-o", "x.exr", "--size", "32x16", *flags, says=["--intrinsics-size"])

    def test_depth_is_along_the_axis_and_distance_along_the_ray(self):
        self.render("--aov", "depth,distance", "--filter", "box", *VIEW, output="x.exr", size="17x17", spp=64)
        _, _, rows = read_exr(self.path("x.exr"))
        self.assertAlmostEqual(rows["depth.Z"][8][8], rows["distance.Z"][8][8], delta=0.01)
        aside = rows["distance.Z"][8][4] / rows["depth.Z"][8][4]
        self.assertAlmostEqual(aside, 1 / math.cos(math.atan(math.tan(math.radians(20)) * 8 / 17)), delta=0.002)

    def test_other_verbs_take_calibrated_cameras(self):
        pose = "--camera-pose=-1,0,0,0.3,0,1,0,0.35,0,0,-1,-0.8"
        cameras = [["--eye", "0.3,0.35,-0.8", "--target", "0.3,0.35,0.2", "--fov", "40"], [pose, "--fov", "40"],
                   [pose, "--intrinsics", "12,24,12,12", "--intrinsics-size", "24x24"], [pose, "--fov", "40", "--distortion", "0.3,0,0,0"]]
        small = ["--size", "24x24", "--device", "cpu", "--json"]
        noise = ["bench", "noise", "cornell-box", "--spp", "1", "--seeds", "2", *small]
        lab = ["lab", "cornell-box", "--structures", "binned", "--traversals", "if-if", "--runs", "1", *small]

        def found_by_noise(camera):
            event = self.succeed(*noise, *camera).events("noise")[0]
            return event["mean"], event["rel_mse"]

        def found_by_lab(camera):
            return [row["hit_share"] for row in rows_of(self.succeed(*lab, *camera).events("lab")[0], "sets")]

        for found_by in (found_by_noise, found_by_lab):
            found = [found_by(camera) for camera in cameras]
            self.assertEqual(found[0], found[1])
            self.assertNotIn(found[0], found[2:])
        self.render(*VIEW[:4], "--lens", "fisheye", "--distortion", "0.1,0,0,0", output="fisheye.exr")
        self.succeed(*noise, "--camera-from", "fisheye.exr")
        for verb in (["bench", "frames"], ["bench", "sequence", "--turntable", "90", "--frames", "0-1"], ["view"]):
            self.refuse(2, *verb[:2], "cornell-box", *verb[2:], "--device", "cpu", "--camera-from", "fisheye.exr", says=["distortion"])

    def test_settings_that_exclude_each_other_are_refused(self):
        pose = ["--camera-pose", "1,0,0,0,0,1,0,1,0,0,1,4"]
        lens = ["--distortion", "0.1,0,0,0"]
        intrinsics = ["--intrinsics", "20,20,8,8"]
        size = ["--size", "16x16"]
        for flags, says in [([*pose, "--eye", "0,0,1"], ["--camera-pose", "--eye"]), (["--convention", "opencv"], ["--camera-pose"]),
                            (intrinsics, ["--size"]), ([*intrinsics, *size, "--fov", 40], ["--fov"]),
                            (["--lens", "fisheye", "--denoise", "svgf"], ["--denoise"]), ([*lens, "--integrator", "hybrid"], ["distortion"]),
                            ([*lens, "--projection", "orthographic"], ["--projection"]),
                            (["--lens", "fisheye", "--aperture", 0.1], ["--aperture"]),
                            (["--camera-pose", "1,2,3"], ["--camera-pose", "12 or 16"]),
                            (["--camera-from", "none.exr"], ["none.exr"])]:
            with self.subTest(flags=flags):
                self.refuse(2, "render", "cornell-box", "-o", "x.exr", "--spp", 1, *flags, says=says)


FRONT = {"name": "front", "eye": [0.3, 0.35, -0.7], "target": [0.2, 0.25, 0.3], "fov": 40, "size": "12x8"}
SIDE = {"name": "side", "camera_pose": [[-1, 0, 0, 0.25], [0, 1, 0, 0.3], [0, 0, -1, -0.8]], "intrinsics": [10, 12, 7, 9],
        "intrinsics_size": "16x16", "distortion": [-0.1, 0, 0, 0]}
ALONE = {"front": [*VIEW, "--size", "12x8"],
         "side": ["--camera-pose=-1,0,0,0.25,0,1,0,0.3,0,0,-1,-0.8", "--intrinsics", "10,12,7,9", "--distortion=-0.1,0,0,0",
                  "--size", "16x16"]}


class ManyCameras(CliTest):
    def many(self, *arguments, output="{name}.exr", cameras=(FRONT, SIDE)):
        write(self.path("views.json"), json.dumps({"cameras": list(cameras)}))
        return ["render", "cornell-box", "-o", output, "--cameras", "views.json", "--spp", "1", "--device", "cpu", "--json",
                *arguments]

    def alone(self, name):
        return self.succeed("render", "cornell-box", "-o", "x.exr", "--spp", "1", "--device", "cpu", "--json",
                            *ALONE[name]).events("done")[0]["hash"]

    def test_each_picture_has_the_bytes_of_a_single_render_of_its_camera(self):
        frames = self.succeed(*self.many()).events("frame")
        self.assertEqual([(frame["frame"], frame["camera"]) for frame in frames], [(0, "front"), (1, "side")])
        self.assertEqual([frame["hash"] for frame in frames], [self.alone("front"), self.alone("side")])
        self.assertEqual(read_exr(self.path("front.exr"))[:2], (12, 8))
        self.assertEqual(read_exr(self.path("side.exr"))[:2], (16, 16))

    def test_a_picture_s_settings_reproduce_it(self):
        frames = self.succeed(*self.many("-o", "{name}.png")).events("frame")
        settings = self.succeed("info", "side.exr", "--settings").stdout
        self.assertNotIn("cameras", json.loads(settings)["settings"])
        write(self.path("side.json"), settings)
        again = self.succeed("render", "cornell-box", "-o", "again.exr", "-o", "again.png", "--settings", "side.json",
                             "--device", "cpu", "--json")
        self.assertEqual(again.events("done")[0]["hash"], frames[1]["hash"])
        self.assertEqual(read_png(self.path("again.png")), read_png(self.path("side.png")))  # with the exposure of the list

    def test_an_interrupted_list_continues_where_files_are_missing_and_refuses_other_cameras(self):
        self.succeed(*self.many(output="v-##-{name}.exr"))
        self.assertEqual([name for name in self.files() if name.endswith("exr")], ["v-00-front.exr", "v-01-side.exr"])
        os.remove(self.path("v-00-front.exr"))
        frames = self.succeed(*self.many("--continue", output="v-##-{name}.exr")).events("frame")
        self.assertEqual([frame.get("kept", False) for frame in frames], [False, True])
        moved = dict(SIDE, intrinsics=[10, 12, 7, 8])
        self.refuse(2, *self.many("--continue", output="v-##-{name}.exr", cameras=[FRONT, moved]), says=["--cameras"])

    def test_parts_of_a_list_have_the_files_of_one_run(self):
        cameras = [FRONT, SIDE, dict(FRONT, name="again", fov=50)]
        whole = self.succeed(*self.many(output="w-{name}.png", cameras=cameras)).events("frame")
        for part, own in (("3/3", [2]), ("1/3", [0]), ("2/3", [1])):
            frames = self.succeed(*self.many("--part", part, output="v-{name}.png", cameras=cameras)).events("frame")
            self.assertEqual([(frame["frame"], frame["hash"]) for frame in frames], [(whole[k]["frame"], whole[k]["hash"]) for k in own])
        for name in ("front", "side", "again"):
            self.assertEqual(read_png(self.path(f"v-{name}.png")), read_png(self.path(f"w-{name}.png")))
        self.refuse(2, *self.many("--part", "4/3", output="v-{name}.png", cameras=cameras), says=["--part 4/3"])

    def test_a_stereo_pair_has_the_pictures_of_its_eyes(self):
        front = ["render", "cornell-box", *ALONE["front"], "--spp", "1", "--device", "cpu", "--json"]
        converging = ["--convergence", "0.8"]
        for flags in [], converging:
            eyes = self.succeed(*front, *flags, "--stereo", "0.1", "-o", "{name}.exr").events("frame")
            self.assertEqual([eye["camera"] for eye in eyes], ["left", "right"])
            alone = [self.succeed(*front, *flags, f"--eye-offset={x}", "-o", "x.exr").events("done")[0]["hash"] for x in (-0.05, 0.05)]
            self.assertEqual([eye["hash"] for eye in eyes], alone)
            self.assertNotEqual(*alone)
        again = self.succeed("render", "cornell-box", "-o", "again.exr", "--camera-from", "right.exr", "--spp", "1", "--device", "cpu",
                             "--json")
        self.assertEqual(again.events("done")[0]["hash"], alone[1])
        left, right = (json.loads(self.succeed("info", f"{eye}.exr", "--json").stdout) for eye in ("left", "right"))
        for key in "pertev.eye", "pertev.target":  # both look along the same direction
            self.assertAlmostEqual(math.dist(left[key], right[key]), 0.1, places=4)
        write(self.path("right.json"), self.succeed("info", "right.exr", "--settings").stdout)
        again = self.succeed("render", "cornell-box", "-o", "again.exr", "--settings", "right.json", "--device", "cpu", "--json")
        self.assertEqual(again.events("done")[0]["hash"], alone[1])
        self.succeed(*self.many("--stereo", "0.1"))
        self.assertEqual([name for name in self.files() if "-" in name],
                         [f"{camera}-{eye}.exr" for camera in ("front", "side") for eye in ("left", "right")])
        for flags, says in [(["--frames", "0-1"], "--frames"), (["--rows", "0:4"], "--rows"), (["--time-limit", "9"], "--time-limit"),
                            (["--integrator", "irradiance_cache", "--records", "r"], "--records"), (["--lens", "fisheye", *converging], "--convergence"),
                            (["--projection", "orthographic", *converging], "--convergence"), (["--eye-offset", "1"], "--eye-offset"), (["--convergence", "1e-9"], "--convergence")]:
            with self.subTest(flags=flags):
                self.refuse(2, *front, "--stereo", "0.1", "-o", "{name}.exr", *flags, says=[says])
        self.refuse(2, *self.many("--stereo", "0.1", cameras=[FRONT, dict(SIDE, eye_offset=1)]), says=["/cameras/1", "--stereo"])

    def test_each_camera_of_a_file_has_the_size_of_its_own_film(self):
        sensors = "".join(f'<sensor type="perspective" id="{name}"><film type="hdrfilm"><integer name="width" value="{width}"/>'
                          '<integer name="height" value="20"/></film></sensor>' for name, width in [("A", 32), ("B", 40)])
        write(self.path("two.xml"), f'<scene version="3.0.0">{sensors}<shape type="cube"/></scene>')
        flags = ["render", "two.xml", "--spp", "1", "--device", "cpu", "-o"]
        for camera, own, size in [("A", [], (32, 20)), ("B", [], (40, 20)), ("1", [], (40, 20)), ("B", ["--size", "7x5"], (7, 5))]:
            self.succeed(*flags, "x.exr", "--camera", camera, *own)
            self.assertEqual(read_exr(self.path("x.exr"))[:2], size)
            self.assertEqual("size" in self.info("x.exr").get("pertev.by_scene", "").split(), not own)
        write(self.path("views.json"), json.dumps({"cameras": [{"name": "a", "camera": "A"}, {"name": "b", "camera": "B"}]}))
        self.succeed(*flags, "{name}.exr", "--cameras", "views.json")
        self.assertEqual([read_exr(self.path(f"{name}.exr"))[:2] for name in "ab"], [(32, 20), (40, 20)])

    def test_an_invalid_file_of_cameras_is_refused_with_the_location(self):
        for camera, says in [({"name": "front"}, "/cameras/1"), ({"spp": 4}, "spp"), ({"fov": 400}, "/cameras/1"),
                             ({"eye": [0, 0, 1], "camera_pose": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}, "/cameras/1")]:
            with self.subTest(camera=camera):
                arguments = self.many(cameras=[FRONT, camera])
                self.refuse(2, *arguments, says=[says])
        self.refuse(2, *self.many(output="x.exr"), says=["{name}"])
        self.refuse(2, *self.many("--frames", "0-1"), says=["--frames"])

    def test_transforms_and_colmap_poses_give_the_expected_picture(self):
        matrix = [[-1, 0, 0, 0.25], [0, 1, 0, 0.3], [0, 0, -1, -0.8], [0, 0, 0, 1]]
        write(self.path("transforms.json"), json.dumps(
            {"fl_x": 10, "fl_y": 12, "cx": 7, "cy": 9, "w": 16, "h": 16, "k1": -0.1,
             "frames": [{"file_path": "images/side.png", "transform_matrix": matrix}]}))
        os.mkdir(self.path("sparse"))
        write(self.path("sparse/cameras.txt"), "1 OPENCV 16 16 10 12 7 9 -0.1 0 0 0\n")
        # This camera in OpenCV's axes, rotated by half a turn about z, and the inverse of its pose.
        write(self.path("sparse/images.txt"), "1 0 0 0 1 0.25 0.3 0.8 1 side.png\n\n")
        expected = self.alone("side")
        for cameras in ["transforms.json", "sparse"]:
            frames = self.succeed("render", "cornell-box", "-o", "{name}.exr", "--cameras", cameras, "--spp", "1", "--device",
                                  "cpu", "--json").events("frame")
            self.assertEqual([frame["hash"] for frame in frames], [expected], cameras)


INSIDE = ["--eye", "0.278,0.4,0.1", "--target", "0.278,0.4,1"]


class Panoramas(CliTest):
    def render_inside(self, output, size, *flags):
        self.succeed("render", "cornell-box", "-o", output, "--size", size, "--device", "cpu", *INSIDE, *flags)
        return read_exr(self.path(output))[2]

    def test_a_face_of_a_cube_is_the_view_of_90_degrees_and_an_equirectangular_picture_has_its_middle(self):
        layers = ["--aov", "position", "--layers-at", "centre", "--spp", "1", "--filter", "box"]
        cube = self.render_inside("cube.exr", "192x32", "--lens", "cube", *layers)
        front = self.render_inside("front.exr", "32x32", "--fov", "90", *layers)
        whole = self.render_inside("whole.exr", "64x32", "--lens", "equirectangular", *layers)
        for axis in "XYZ":
            for row, wanted in zip(cube["position." + axis], front["position." + axis]):
                for x, y in zip(row[:32], wanted):
                    self.assertAlmostEqual(x, y, delta=1e-4)
        # The camera looks along z, thus x is on its left.
        centre = [whole["position." + axis][16][32] for axis in "XYZ"]
        self.assertAlmostEqual(centre[0], 0.278, delta=0.05)
        self.assertLess(whole["position.X"][16][48], 0.278)
        self.assertGreater(whole["position.X"][16][16], 0.278)
        self.assertGreater(whole["position.Y"][2][32], 0.5)
        self.assertLess(whole["position.Y"][30][32], 0.2)  # the short block

    def test_paths_from_the_lights_agree_in_panoramas(self):
        for lens, size in {"equirectangular": "32x16", "cube": "96x16"}.items():
            flags = ["--lens", lens, "--filter", "box", "--sampler", "independent", "--spp", "64", "--aov", "variance", "--max-depth", "3"]
            self.render_inside("path.exr", size, *flags)
            for integrator in "bidirectional", "light":
                self.render_inside("other.exr", size, *flags, "--integrator", integrator, "--seed", "1")
                found = self.succeed("compare", "path.exr", "other.exr", "--json").events("compare")[0]
                self.assertLess(found["p_below"], 0.08, (lens, integrator, found))
                for x, y in zip(found["mean_98"], found["reference_mean_98"]):
                    self.assertAlmostEqual(x / y, 1, delta=0.03)

    def test_panoramas_are_refused_where_they_mean_nothing(self):
        for flags, says in [("--lens cube --filter box --size 100x20", "six"), ("--lens cube --size 96x16", "filter"), ("--lens equirectangular --aperture 0.1", "aperture"),
                            ("--lens equirectangular --fov 40", "--fov"), ("--lens equirectangular --denoise svgf", "denoise"), ("--lens equirectangular --distortion 0,0,0,0", "distortion"),
                            ("--lens equirectangular --integrator hybrid", "integrator"), ("--lens panorama", "--lens")]:
            with self.subTest(flags=flags):
                self.refuse(2, "render", "cornell-box", "-o", "x.exr", *flags.split(), says=[says])
        self.render_inside("x.exr", "64x32", "--lens", "equirectangular", "--spp", "1")
        self.succeed("render", "cornell-box", "-o", "again.exr", "--camera-from", "x.exr", "--spp", "1", "--device", "cpu")
        self.assertEqual(self.info("again.exr")["pertev.hash"], self.info("x.exr")["pertev.hash"])


if __name__ == "__main__":
    main()
