"""Moving scenes: times, frames, a camera's path, a turntable, and sequences that are interrupted and resumed."""

import base64
import json
import os
import resource
import signal
import struct
import subprocess
import time

from cli_run import PROGRAM, CliTest, as_flag, main, write

TINY = ["--size", "24x16", "--spp", "2", "--device", "cpu", "--exposure", "0"]


def moving_gltf(way=2):
    """A triangle that moves along x by this distance in 2 s, a camera that moves with another node, and a light."""
    numbers = struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0)  # 0: positions
    numbers += struct.pack("<2f", 0, 2)  # 36: times
    numbers += struct.pack("<6f", 0, 0, 0, way, 0, 0)  # 44: translations
    numbers += struct.pack("<6f", 0, 0, 4, 0, 1, 4)  # 68: translations of the camera
    views = [(0, 36), (36, 8), (44, 24), (68, 24)]
    uri = "data:application/octet-stream;base64," + base64.b64encode(numbers).decode()
    return json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3}]}},
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [{"name": "slide", "samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 3}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}},
                                     {"sampler": 1, "target": {"node": 1, "path": "translation"}}]}],
        "accessors": [{"bufferView": view, "componentType": 5126, "count": count, "type": kind, **limits}
                      for view, (count, kind, limits) in enumerate([
                          (3, "VEC3", {"min": [-1, -1, 0], "max": [1, 1, 0]}), (2, "SCALAR", {"min": [0], "max": [2]}),
                          (2, "VEC3", {}), (2, "VEC3", {})])],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
        "buffers": [{"byteLength": len(numbers), "uri": uri}]})


class MovingPictures(CliTest):
    def setUp(self):
        super().setUp()
        write(self.path("m.gltf"), moving_gltf())

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def hash_at(self, *arguments, scene="m.gltf"):
        return self.succeed("render", scene, "-o", "one.png", *TINY, "--json", *arguments).events("done")[0]["hash"]

    def frames(self, *arguments, scene="m.gltf", output="f-###.png"):
        return self.succeed("render", scene, "-o", output, *TINY, "--json", *arguments)

    def test_time_moves_the_scene_and_its_camera(self):
        self.assertEqual(self.hash_at("--time", "0"), self.hash_at())  # the scene at rest is that at time 0
        self.assertNotEqual(self.hash_at("--time", "1"), self.hash_at())
        self.assertEqual(self.hash_at("--time", "2"), self.hash_at("--time", "1000"))
        self.assertEqual(self.hash_at("--time=-1"), self.hash_at("--time", "0"))
        self.succeed("render", "m.gltf", "-o", "x.exr", "--size", "8x8", "--spp", "1", "--device", "cpu", "--time", "1")
        info = self.info("x.exr")
        self.assertEqual(info["pertev.time"], 1)
        self.assertEqual(info["pertev.eye"], [0, 0.5, 4])

    def test_an_unused_animation_and_a_time_without_animation_are_reported(self):
        said = self.succeed("render", "m.gltf", "-o", "x.png", *TINY, "--json").events("notice")
        (still,) = [notice for notice in said if notice.get("place") == {"file": "m.gltf"} and "time" in notice.get("settings", {})]
        self.assertIn("0 to 2 s", still["reason"])
        said = self.succeed("render", "cornell-box", "-o", "x.png", *TINY, "--time", "1", "--json").events("warning")
        self.assertEqual([warning["setting"] for warning in said], ["time"])
        self.assertEqual(self.info("m.gltf")["animations"], ["slide (2 s)"])

    def test_each_frame_is_the_picture_at_its_time(self):
        said = self.frames("--frames", "9-12", "--fps", "10")
        self.assertEqual(self.files(), ["f-###.json", "f-009.png", "f-010.png", "f-011.png", "f-012.png", "m.gltf"])
        frames = said.events("frame")
        self.assertEqual([event["frame"] for event in frames], [9, 10, 11, 12])
        for event in frames:
            self.assertEqual(event["time"], event["frame"] / 10)
            self.assertEqual(event["hash"], self.hash_at("--time", repr(event["time"])))
            self.assertEqual(self.read(f"f-{event['frame']:03}.png"), self.read("one.png"))
        self.assertEqual(len({event["hash"] for event in frames}), 4)
        end = said.events("sequence")[0]
        self.assertEqual((end["frames"], end["written"], end["kept"], end["interrupted"]), (4, 4, 0, False))

    def test_frames_of_a_scene_at_rest_have_the_samples_of_one(self):
        frames = self.frames("--frames", "0-2", scene="cornell-box").events("frame")
        self.assertEqual({(event["samples"], event["hash"]) for event in frames}, {(2, self.hash_at(scene="cornell-box"))})

    def test_a_frame_is_reproduced_from_its_metadata(self):
        small = ["--size", "24x16", "--spp", "2", "--device", "cpu"]
        for motion, output in [(["--frames", "3-4", "--fps", "7", "--shutter", "0.1"], "one.exr"),
                               (["--frames", "3-4", "--fps", "7", "--turntable", "90"], "one-#.exr"),
                               (["--frames", "3-4", "--fps", "7", "--real-time"], "one-#.exr")]:
            with self.subTest(motion=motion):
                once = [flag for flag in small if "--real-time" not in motion or flag not in ("--spp", "2")]
                frames = self.succeed("render", "m.gltf", "-o", "f-#.exr", *once, *motion, "--json").events("frame")
                self.assertNotEqual(frames[0]["hash"], frames[1]["hash"])
                for event in frames:
                    write(self.path("s.json"), self.succeed("info", f"f-{event['frame']}.exr", "--settings").stdout)
                    again = self.succeed("render", "m.gltf", "-o", output, "--settings", "s.json", "--device", "cpu", "--json")
                    last = [made for made in again.events() if made["event"] in ("done", "frame")][-1]
                    self.assertEqual(last["hash"], event["hash"])

    def test_frames_have_motion_layers_and_names_of_ids(self):
        def render(frames, *more):
            return self.succeed("render", "m.gltf", "-o", "f-#.exr", "--size", "24x16", "--spp", "1", "--device", "cpu",
                                "--aov", "motion,ids", "--frames", frames, "--fps", "4", *more)

        render("0-2")
        info = self.info("f-2.exr")
        self.assertIn("motion.u", info["channels"])
        self.assertIn("motion.v", info["channels"])
        self.assertIn('"0":', info["pertev.instances"])
        (remark,) = self.remarks("render", "m.gltf", "-o", "one.exr", "--size", "8x8", "--spp", "1", "--device", "cpu",
                                 "--aov", "motion", about="aov")
        self.assertIn("frames", remark["settings"])

    def test_a_frame_has_the_hashes_of_the_picture_at_its_time(self):
        names = ["hash", "layers_hash", "denoised_hash"]
        small = ["--size", "24x16", "--spp", "2", "--device", "cpu", "--json"]
        lpes = ["--lpe", "seen=LE", "--lpe", "others=L.+E"]
        for flags, told in [([], [0]), (lpes, [0, 1]), (["--denoise", "svgf", "--history", "0"], [0, 1, 2])]:
            frames = self.succeed("render", "m.gltf", "-o", "f-#.exr", *small, *flags, "--frames", "3-4", "--fps", "4").events("frame")
            flags = flags[:2] if "--history" in flags else flags  # one picture has none
            for event in frames:
                self.assertEqual([i for i, name in enumerate(names) if event[name] is not None], told)
                done = self.succeed("render", "m.gltf", "-o", "x.exr", *small, *flags, "--time", repr(event["time"])).events("done")[0]
                self.assertEqual([event[name] for name in names], [done[name] for name in names])
            for i in told:
                self.assertNotEqual(frames[0][names[i]], frames[1][names[i]])

    def test_a_shutter_blurs_motion(self):
        sharp = self.hash_at("--time", "1")
        blurred = self.hash_at("--time", "1", "--shutter", "0.5")
        self.assertNotEqual(blurred, sharp)
        self.assertEqual(self.hash_at("--time", "1", "--shutter=0,0.5"), blurred)
        self.assertNotEqual(self.hash_at("--time", "1", "--shutter=-0.5,0"), blurred)
        self.assertEqual(self.hash_at("--time", "5", "--shutter", "1"), self.hash_at("--time", "5"))  # nothing moves at that time
        for integrator in ("distributed", "direct", "whitted", "cast"):
            moved = ["--time", "1", "--integrator", integrator]
            self.assertNotEqual(self.hash_at(*moved, "--shutter", "0.5"), self.hash_at(*moved))
        self.succeed("render", "m.gltf", "-o", "x.exr", "--size", "8x8", "--spp", "1", "--device", "cpu", "--time", "1",
                     "--shutter=-0.25,0.1")
        info = self.info("x.exr")
        self.assertEqual(info["pertev.shutter"], [-0.25, 0.1])
        self.frames("--frames", "0-1", "--fps", "2", "--shutter", "0.1")
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, "--frames", "0-1", "--fps", "2", "--continue",
                    "--shutter", "0.2", says=['--shutter is "0,0.1" there'])
        self.frames("--frames", "0-1", "--fps", "2", "--shutter", "0,0.1", "--continue")

    def test_an_invalid_shutter_is_refused(self):
        def refuse(*arguments, says):
            self.refuse(2, "render", "m.gltf", "-o", "x.png", *TINY, *arguments, says=says)
        refuse("--shutter", "0.1", says=["--shutter: ", "--time", "--frames"])
        for text in ("", "a", "1,2,3", "1,", ",1", "nan", "inf", "1e30"):
            refuse("--time", "1", "--shutter=" + text, says=["--shutter"])
        refuse("--time", "1", "--shutter", "1e400", says=["--shutter 1e400: "])
        self.assertEqual(self.hash_at("--time", "1", "--shutter", "1e-400"), self.hash_at("--time", "1", "--shutter", "0"))
        refuse("--time", "1", "--shutter=1e-400,-1", says=["--shutter 1e-400,-1"])
        refuse("--time", "1", "--shutter", "0.2,0.1", says=["--shutter 0.2,0.1"])
        refuse("--time", "1", "--shutter", "0.1", "--turntable", "9", says=["--shutter 0.1: ", "--frames"])
        for integrator in ("hybrid", "raster", "light", "bidirectional"):
            refuse("--time", "1", "--shutter", "0.1", "--integrator", integrator, says=["--shutter", integrator])
        refuse("--time", "1", "--shutter", "0.1", "--denoise", "svgf", says=["--shutter: ", "--denoise svgf"])

    def test_all_frames_are_exposed_as_the_first(self):
        said = self.succeed("render", "m.gltf", "-o", "f-#.png", "--size", "24x16", "--spp", "2", "--device", "cpu",
                            "--json", "--frames", "0-2", "--fps", "1")
        self.assertEqual(len(said.events("exposure")), 1)
        stops = said.events("exposure")[0]["stops"]
        self.succeed("render", "m.gltf", "-o", "one.png", "--size", "24x16", "--spp", "2", "--device", "cpu", "--time",
                     "2", "--exposure", stops)
        self.assertEqual(self.read("one.png"), self.read("f-2.png"))

    def test_continuing_keeps_complete_frames_and_renders_the_others(self):
        self.frames("--frames", "0-3", "--fps", "2")
        files = ["f-000.png", "f-001.png", "f-002.png", "f-003.png"]
        whole = [self.read(name) for name in files]
        os.remove(self.path("f-000.png"))
        with open(self.path("f-002.png"), "r+b") as file:
            file.truncate(60)
        kept = os.stat(self.path("f-001.png")).st_mtime_ns
        end = self.frames("--frames", "0-4", "--fps", "2", "--continue").events("sequence")[0]
        self.assertEqual((end["frames"], end["written"], end["kept"]), (5, 3, 2))
        self.assertEqual([self.read(name) for name in files], whole)
        self.assertEqual(os.stat(self.path("f-001.png")).st_mtime_ns, kept)
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, "--frames", "0-4", "--fps", "3", "--continue",
                    says=["f-###.json: /settings", "--fps"])
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, "--frames", "0-4", "--fps", "2", "--seed", "1",
                    "--continue", says=['--seed is "0" there'])
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, "--frames", "0-4", "--fps", "2", "--integrator",
                    "distributed", "--continue", says=['--integrator is "path" there'])
        for flags, named in ((["--exposure", "0", "--efficacy", "200"], "--efficacy"),
                             (["--false-color", "luminance", "--false-color-range", "1,10"], "--tone-map")):
            self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY[:TINY.index("--exposure")], *flags, "--frames", "0-4",
                        "--fps", "2", "--continue", says=[f'{named} is "'])
        write(self.path("m.gltf"), moving_gltf() + " ")
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, "--frames", "0-4", "--fps", "2", "--continue",
                    says=["f-###.json: ", "hash of the scene's file"])
        write(self.path("f-###.json"), "{")
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, "--frames", "0-4", "--fps", "2", "--continue",
                    says=["f-###.json: "])

    def test_an_interrupt_ends_after_a_whole_frame_and_continuing_gives_the_same_bytes(self):
        arguments = ["render", "m.gltf", "-o", "f-##.png", "--size", "64x64", "--spp", "64", "--device", "cpu",
                     "--exposure", "0", "--frames", "0-39", "--fps", "20"]
        program = subprocess.Popen([PROGRAM, *arguments], cwd=self.folder, env=self.environment,
                                   stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        while program.poll() is None and not os.path.exists(self.path("f-02.png")):
            time.sleep(0.01)
        program.send_signal(signal.SIGINT)
        said = program.communicate(timeout=300)[1].decode()
        self.assertEqual(program.returncode, 75, said)
        self.assertIn("--continue", said)
        there = [name for name in self.files() if name.endswith(".png")]
        self.assertEqual(there, [f"f-{k:02}.png" for k in range(len(there))])
        self.assertLess(len(there), 40)
        before = {name: self.read(name) for name in there}
        end = self.succeed(*arguments, "--continue", "--json").events("sequence")[0]
        self.assertEqual(end["kept"], len(there))
        self.assertEqual({name: self.read(name) for name in there}, before)
        os.mkdir(self.path("again"))
        arguments[3] = "again/f-##.png"
        self.succeed(*arguments)
        for k in range(40):
            self.assertEqual(self.read(f"f-{k:02}.png"), self.read(f"again/f-{k:02}.png"), k)

    def test_parts_of_a_sequence_have_the_files_of_one_run(self):
        metered = ["--size", "24x16", "--spp", "2", "--device", "cpu", "--json"]

        def render(folder, *arguments, scene="m.gltf"):
            os.makedirs(self.path(folder), exist_ok=True)
            return self.succeed("render", scene, "-o", f"{folder}/f-##.png", *metered, *arguments)

        def pictures(folder):
            return {name: self.read(f"{folder}/{name}") for name in os.listdir(self.path(folder)) if name.endswith(".png")}

        for number, (scene, motion) in enumerate([("m.gltf", ["--frames", "2-8", "--fps", "5"]), ("cornell-box", ["--turntable", "3"])]):
            whole, parts = f"whole{number}", f"parts{number}"
            count = len(render(whole, *motion, scene=scene).events("frame"))
            for part in ("3/4", "1/4", "4/4", "2/4"):
                said = render(parts, *motion, "--part", part, scene=scene)
                self.assertEqual(len(said.events("exposure")), 1)
                end = said.events("sequence")[0]
                index = int(part[0])
                own = [event["frame"] for event in said.events("frame")]
                begin = int(motion[1].split("-")[0]) if "--frames" in motion else 0
                self.assertEqual(own, list(range(begin + count * (index - 1) // 4, begin + count * index // 4)))
                self.assertEqual((end["frames"], end["written"], end["interrupted"]), (len(own), len(own), False))
            self.assertEqual(pictures(parts), pictures(whole))
            records = [f"f-##.part-{i}-of-4.json" for i in range(1, 5) if count * (i - 1) // 4 < count * i // 4]
            self.assertEqual(sorted(name for name in os.listdir(self.path(parts)) if name.endswith(".json")), records)
            os.remove(self.path(f"{parts}/f-02.png"))  # one run of all frames keeps those of all parts
            end = render(parts, *motion, "--continue", scene=scene).events("sequence")[0]
            self.assertEqual((end["written"], end["kept"]), (1, count - 1))
            end = render(parts, *motion, "--part", "1/1", "--continue", scene=scene).events("sequence")[0]
            self.assertEqual((end["written"], end["kept"]), (0, count))
            self.assertEqual(pictures(parts), pictures(whole))

    def test_a_part_refuses_its_own_record_alone_if_that_has_other_settings(self):
        motion = ["--frames", "0-3", "--fps", "2"]
        self.frames(*motion, "--part", "1/2")
        self.frames(*motion, "--part", "2/2", "--seed", "4")
        self.refuse(2, "render", "m.gltf", "-o", "f-###.png", *TINY, *motion, "--part", "1/2", "--seed", "4", "--continue",
                    says=["f-###.part-1-of-2.json: ", "--seed"])
        write(self.path("f-###.part-9-of-9.json"), "{")  # is no record, and no part's own
        end = self.frames(*motion, "--part", "1/2", "--continue").events("sequence")[0]
        self.assertEqual((end["written"], end["kept"]), (0, 2))
        end = self.frames(*motion, "--continue").events("sequence")[0]  # frames of the other seed are rendered again
        self.assertEqual((end["written"], end["kept"]), (2, 2))

    def test_invalid_parts_of_sequences_are_refused(self):
        for part in ("0/2", "3/2", "1/0", "x"):
            self.refuse(2, "render", "m.gltf", "-o", "f-#.png", *TINY, "--frames", "0-1", "--part", part, says=[f"--part {part}"])
        self.refuse(2, "render", "m.gltf", "-o", "f-#.png", *TINY, "--frames", "0-1", "--samples", "0:1", says=["--samples"])
        self.frames("--frames", "0-1", "--part", "0/2", "--part-base", "0", output="b-#.png")
        self.assertEqual([name for name in self.files() if name.startswith("b-")], ["b-#.part-1-of-2.json", "b-0.png"])

    def run_on_a_full_disk(self, limit, *arguments):
        """Returns the last object and that of the sequence if no file may exceed `limit` bytes."""
        outcome = self.run_pertev("render", "m.gltf", *arguments, "--json",
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assertEqual((outcome.status, outcome.events()[-1]["event"]), (6, "error"), outcome)
        return outcome, outcome.events("sequence")[0]

    def test_a_full_disk_counts_only_complete_frames(self):
        sequence = ["--frames", "0-2", "--fps", "1"]
        outcome, end = self.run_on_a_full_disk(1024, "-o", "g-#.exr", "--size", "24x16", "--spp", "2", "--device", "cpu", *sequence)
        self.assertEqual((end["frames"], end["written"], end["kept"], end["interrupted"]), (3, 0, 0, False))
        self.assertEqual([event["written"] for event in outcome.events("output")], [False])
        self.assertEqual((outcome.events("frame"), self.files()), ([], ["m.gltf"]))
        # One of two files of a frame fits: the frame is not complete.
        outcome, end = self.run_on_a_full_disk(1024, "-o", "g-#.png", "-o", "g-#.exr", *TINY, *sequence)
        self.assertEqual([event["written"] for event in outcome.events("output")], [True, False])
        self.assertEqual((end["written"], self.files()), (0, ["g-0.png", "m.gltf"]))

    def test_frames_count_even_if_their_list_cannot_be_written(self):
        names = ["-o", "f-##.png", *TINY]
        self.frames("--frames", "0-0", "--fps", "20", output="f-##.png")
        limit = os.path.getsize(self.path("f-##.json")) + 500  # the hashes of some frames
        outcome, end = self.run_on_a_full_disk(limit, *names, "--frames", "0-39", "--fps", "20")
        there = [name for name in self.files() if name.endswith(".png")]
        self.assertEqual((end["frames"], end["written"], end["kept"]), (40, len(there), 0))
        self.assertEqual(len(outcome.events("frame")), len(there))
        self.assertGreater(len(there), 2)
        self.assertLess(len(there), 20)
        self.assertIn("f-##.json", outcome.error())
        kept = len(there) - 1  # the last one is not in the record
        outcome, end = self.run_on_a_full_disk(limit, *names, "--frames", "0-39", "--fps", "20", "--continue")
        self.assertEqual((end["written"], end["kept"]), (1, kept))

    def test_the_camera_follows_the_keys_of_a_path(self):
        keys = [{"time": 0, "eye": [0, 0, 5], "target": [0, 0, 0], "fov": 50},
                {"time": 1, "eye": [3, 0, 4], "target": [0, 1, 0], "fov": 40},
                {"time": 3, "eye": [0, 2, 6], "target": [0, 0, 0], "up": [0.1, 1, 0], "fov": 60}]
        write(self.path("path.json"), json.dumps({"keys": keys}))
        at_1 = self.hash_at("--camera-path", "path.json", "--time", "1")
        self.assertEqual(at_1, self.hash_at("--eye", "3,0,4", "--target", "0,1,0", "--up", "0,1,0", "--fov", "40",
                                            "--time", "1"))
        self.assertEqual(self.hash_at("--camera-path", "path.json"),
                         self.hash_at("--eye", "0,0,5", "--target", "0,0,0", "--up", "0,1,0", "--fov", "50"))
        frames = self.frames("--camera-path", "path.json", "--frames", "0-3", "--fps", "1").events("frame")
        self.assertEqual(frames[1]["hash"], at_1)
        self.assertEqual(len({event["hash"] for event in frames}), 4)
        # The metadata of an EXR reproduces a frame between keys.
        self.succeed("render", "m.gltf", "-o", "e-#.exr", "--size", "24x16", "--spp", "2", "--device", "cpu",
                     "--camera-path", "path.json", "--frames", "2-2", "--fps", "1")
        told = self.info("e-2.exr")
        words = [word for name in ["eye", "target", "up", "fov", "time"]
                 for word in [f"--{name}={as_flag(told['pertev.' + name])}"]]
        self.assertEqual(self.hash_at(*words), frames[2]["hash"])

    def test_an_invalid_camera_path_is_refused_with_the_location(self):
        def refuse(text, *says):
            write(self.path("path.json"), text)
            self.refuse(2, "render", "m.gltf", "-o", "x.png", *TINY, "--camera-path", "path.json",
                        says=["path.json", *says])

        key = '{"time":0,"eye":[0,0,1],"target":[0,0,0]}'
        refuse("{", "not valid JSON")
        refuse("{}", "keys")
        refuse('{"keys":[]}', "/keys: ")
        refuse('{"keys":[{"time":0,"eye":[0,0],"target":[0,0,0]}]}', "/keys/0/eye")
        refuse('{"keys":[{"time":-1,"eye":[0,0,1],"target":[0,0,0]}]}', "/keys/0/time: -1")
        refuse(f'{{"keys":[{key},{key}]}}', "/keys/1/time: 0; expected more than 0")
        refuse('{"keys":[{"time":0,"eye":[0,0,1],"target":[0,0,1]}]}', "/keys/0: the target must differ")
        refuse('{"keys":[{"time":0,"eye":[0,0,1],"target":[0,0,0],"fov":180}]}', "/keys/0/fov: 180")
        refuse(f'{{"keys":[{key},{{"time":1,"eye":[0,0,1],"target":[0,0,0],"fov":50}}]}}', "/keys/1", "in all or none")
        self.refuse(2, "render", "m.gltf", "-o", "x.png", *TINY, "--camera-path", "no.json", says=["no.json"])

    def test_a_turntable_makes_one_turn(self):
        frames = self.frames("--turntable", "3", scene="cornell-box").events("frame")
        self.assertEqual([event["frame"] for event in frames], [0, 1, 2])
        self.assertEqual([event["time"] for event in frames], [None] * 3)
        self.assertEqual(frames[0]["hash"], self.hash_at(scene="cornell-box"))
        slow = self.frames("--turntable", "24", "--frames", "0-24", scene="cornell-box").events("frame")
        self.assertEqual(slow[24]["hash"], slow[0]["hash"])
        self.assertNotEqual(slow[1]["hash"], slow[0]["hash"])
        self.assertEqual(slow[8]["hash"], frames[1]["hash"])

    def test_incompatible_flags_of_frames_are_refused(self):
        for line, flag in [("--frames 3-2", "--frames 3-2"), ("--frames x", "--frames x"), ("--fps 3", "--fps"),
                           ("--continue", "--continue"), ("--frames 0-1 --time 1", "--time"),
                           ("--frames 0-1 --time-limit 1", "--time-limit"),
                           ("--camera-path p --turntable 2", "--turntable"), ("--camera-path p --eye 0,0,1", "--eye")]:
            with self.subTest(line=line):
                self.refuse(2, "render", "m.gltf", "-o", "f-#.png", *TINY, *line.split(), says=[flag])
        self.refuse(2, "render", "m.gltf", "-o", "f.png", *TINY, "--frames", "0-1", says=["-o f.png"])


if __name__ == "__main__":
    main()
