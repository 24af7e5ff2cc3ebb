#!/usr/bin/env python3
"""Time in `pertev view`: animations that play and pause, moving cameras, the recorded path."""

import json
import math
import time

from cli_clips_test import CLIPS, gltf
from cli_frames_test import moving_gltf
from cli_run import CliTest, main, write
from viewer_client import Client, Viewer

SIZE = "64x48"


def words_of(state):
    return state["flags"].replace("'", "").split()


class Times(CliTest):
    """Each viewer shows files of the test's folder, and its picture at rest is that of pertev render."""

    def setUp(self):
        super().setUp()
        write(self.path("m.gltf"), moving_gltf())

    def view(self, *arguments, scene="m.gltf"):
        return Viewer(*arguments, scene=self.path(scene) if "." in scene else scene, size=SIZE, spp=4)

    def rendered(self, *arguments, scene="m.gltf"):
        return self.render(*arguments, scene=scene, size=SIZE, spp=4)["hash"]

    def play(self, client, on, loops=True, speed=1):
        return client.steer(type="play", on=on, loops=loops, speed=speed)

    def still(self, client, number):
        """Returns the state once all samples that this input requested are complete."""
        return client.done(lambda s: s["input"] >= number)

    def test_paused_animation_has_the_hash_of_render_at_that_time(self):
        with self.view() as viewer, Client(viewer) as client:
            first = client.text("state", lambda s: s["clock"]["at"] > 0)
            self.assertEqual((first["clock"]["end"], first["clock"]["on"], first["phase"]), (2, True, "moving"))
            later = client.text("state", lambda s: s["clock"]["at"] != first["clock"]["at"])
            self.assertTrue(later["clock"]["on"])
            self.assertNotEqual(words_of(first), words_of(later))
            paused = self.still(client, self.play(client, False))
            self.assertFalse(paused["clock"]["on"])
            words = words_of(paused)
            self.assertEqual(words[-2], "--time")
            self.assertEqual(paused["hash"], self.rendered(*words))
            self.assertEqual(paused["hash"], self.rendered("--time", words[-1]))  # the camera moves with it
            again = client.text("state", timeout=5)  # the animation is paused
            self.assertEqual(again["clock"]["at"], paused["clock"]["at"])

    def test_the_panel_lists_the_animations_and_scenes_of_the_file_and_which_is_shown(self):
        write(self.path("clips.gltf"), gltf(CLIPS, (("one", [0, 1, 2]), ("two", [3, 1, 2]))))
        for flags, plays, shows, end, alone in [([], "go", "one", 2, "go"), (["--animation", "4", "--file-scene", "two"], "4", "two", 3, "4")]:
            with self.view("--time", "0.5", *flags, scene="clips.gltf") as viewer, Client(viewer) as client:
                told = dict(row[1:] for row in client.text("welcome")["about"])
                self.assertTrue(told["animation"].startswith(f"{plays} of go, rise, 2 (twin), 3 (twin), 4, 1, dim"), told)
                self.assertTrue(told["scene of the file"].startswith(f"{shows} of one, two"), told)
                state = client.done()
                self.assertEqual(state["clock"]["end"], end)
                self.assertEqual(state["hash"], self.rendered("--time", "0.5", "--animation", alone, *flags[2:], scene="clips.gltf"))

    def test_a_requested_time_is_shown_whatever_was_shown_before(self):
        with self.view("--time", "0.75") as viewer, Client(viewer) as client:
            begins = client.done()
            self.assertFalse(begins["clock"]["on"])
            self.assertEqual(begins["hash"], self.rendered("--time", "0.75"))
            for at in ["1.5", "0.25", "2"]:
                state = self.still(client, client.steer(type="time", at=float(at)))
                self.assertEqual(state["clock"]["at"], float(at))
                self.assertEqual(state["hash"], self.rendered("--time", at))
            # No structure or traversal changes it.
            hashes = {self.still(client, client.set(name, value))["hash"] for name, value in
                      [("structure", "octree"), ("structure", "sbvh"), ("rta", "off")]}
            self.assertEqual(hashes, {state["hash"]})
            with open(self.path("saved.exr"), "wb") as file:
                file.write(viewer.get("/save?format=exr")[2])
            info = self.info("saved.exr")
            self.assertEqual((info["pertev.time"], info["hash"]), (2, state["hash"]))
            write(self.path("s.json"), self.succeed("info", "saved.exr", "--settings").stdout)
            self.succeed("render", "m.gltf", "-o", "again.exr", "--settings", "s.json", "--device", "cpu")
            self.assertEqual(self.info("again.exr")["hash"], state["hash"])

    def test_with_radiosity_time_moves_only_the_camera(self):
        scene = json.loads(moving_gltf())
        scene["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 0}}]
        scene["meshes"][0]["primitives"][0]["material"] = 0
        write(self.path("m.gltf"), json.dumps(scene))
        solved = ["--integrator", "radiosity", "--patch-size", "0.5", "--patch-rays", "16", "--subdivisions", "0"]
        for given, said in [(["--time", "0.75"], "at 0.75 s"), ([], "at rest")]:
            with self.view(*solved, *given) as viewer, Client(viewer) as client:
                begins = client.done()
                self.assertEqual(begins["clock"]["end"], 0)
                self.assertEqual(begins["hash"], self.rendered(*solved, *given))
                self.assertIn(said, dict(row[1:] for row in begins["rows"])["scene"])
                self.assertEqual(words_of(begins)[-len(given):], given or words_of(begins))
                played = self.still(client, self.play(client, True))
                self.assertEqual(played["hash"], begins["hash"])
                gone = self.still(client, client.steer(type="time", at=1.5))
                self.assertEqual((gone["hash"], gone["flags"]), (begins["hash"], begins["flags"]))
                # A recorded path has times, which move the camera.
                client.steer(type="key", at=0)
                client.steer(type="move", right=0.3, up=0, forward=0.5, ms=200, pace="normal")
                client.steer(type="key", at=2)
                client.steer(type="follow")
                self.play(client, False)
                shown = self.still(client, client.steer(type="time", at=1.25))
                self.assertNotEqual(shown["hash"], begins["hash"])
                self.assertEqual(words_of(shown)[-len(given):], given or words_of(shown))
                self.assertEqual(shown["hash"], self.rendered(*solved, *words_of(shown)))
                path = self.still(client, client.set("integrator", "path"))
                self.assertEqual(path["hash"], self.rendered(*words_of(path)))
                viewer.end()
                self.assertIn(f"the scene is shown {said}", viewer.process.stderr.read().decode())

    def test_time_loops_or_stops_at_its_end(self):
        with self.view("--time", "1.5") as viewer, Client(viewer) as client:
            client.done()
            self.play(client, True, loops=False, speed=4)
            state = client.done(lambda s: s["clock"]["at"] == 2)
            self.assertFalse(state["clock"]["on"])
            self.assertEqual(state["hash"], self.rendered("--time", "2"))
            self.play(client, True, loops=True, speed=4)
            seen, end = [], time.monotonic() + 20
            while not any(b < a for a, b in zip(seen, seen[1:])) and time.monotonic() < end:
                seen.append(client.text("state")["clock"]["at"])
            self.assertLess(max(seen), 2)
            self.assertTrue(any(b < a for a, b in zip(seen, seen[1:])), seen)

    def test_moving_the_camera_overrides_its_animation_until_home_restores_it(self):
        with self.view("--time", "0.5") as viewer, Client(viewer) as client:
            home = client.done()
            own = self.still(client, client.steer(type="move", right=1, up=0, forward=0, ms=100, pace="normal"))
            self.assertEqual(own["hash"], self.rendered(*words_of(own)))
            moved = self.still(client, client.steer(type="time", at=1))
            self.assertEqual(words_of(moved)[:-2], words_of(own)[:-2])  # only the scene has moved
            self.assertEqual(moved["hash"], self.rendered(*words_of(moved)))
            back = self.still(client, client.steer(type="home"))
            self.assertEqual(back["hash"], self.rendered("--time", "1"))
            again = self.still(client, client.steer(type="time", at=0.5))
            self.assertEqual(again["hash"], home["hash"])

    def test_a_scene_without_animation_has_no_time_line(self):
        with self.view(scene="cornell-box") as viewer, Client(viewer) as client:
            state = client.done()
            self.assertEqual(state["clock"]["end"], 0)
            after = self.still(client, self.play(client, True))
            self.assertEqual((after["hash"], after["flags"]), (state["hash"], state["flags"]))

    def test_a_time_that_cannot_be_shown_is_reported_and_the_previous_one_stays(self):
        write(self.path("far.gltf"), moving_gltf(way=1e15))
        with self.view("--time", "0", scene="far.gltf") as viewer, Client(viewer) as client:
            first = client.done()
            number = client.steer(type="time", at=1.5)
            self.assertIn("1.5", client.text("notice")["text"])
            back = self.still(client, number)
            self.assertEqual((back["clock"]["at"], back["hash"]), (0, first["hash"]))
            near = self.still(client, client.steer(type="time", at=0.0001))
            self.assertEqual(near["hash"], self.rendered("--time", near["flags"].split()[-1], scene="far.gltf"))

    def test_the_orbit_centre_stays_when_another_setting_changes(self):
        with self.view("--time", "0.5") as viewer, Client(viewer) as client:
            client.done()
            client.steer(type="pick", x=0.6, y=0.6, use="show")
            centre = client.text("picked")["position"]
            client.steer(type="pick", x=0.6, y=0.6, use="orbit")
            client.text("notice")
            client.done(lambda s, n=client.steer(type="set", name="max_depth", value=3): s["input"] >= n)
            turned = self.still(client, client.steer(type="orbit", dx=0.2, dy=0))
            eye = [float(x) for x in words_of(turned)[words_of(turned).index("--eye") + 1].split(",")]
            self.assertGreater(abs(eye[0]), 1)
            self.assertAlmostEqual(math.hypot(eye[0] - centre[0], eye[2] - centre[2]), math.hypot(centre[0], 4), 3)

    def test_only_the_steering_client_sets_the_time_and_all_see_it(self):
        with self.view("--time", "0") as viewer, Client(viewer) as client, Client(viewer, key="second") as other:
            client.done()
            other.steer(type="time", at=2)  # this has no effect
            client.steer(type="time", at=1)
            self.assertEqual(other.done(lambda s: s["clock"]["at"] > 0)["clock"]["at"], 1)

    def test_recorded_keys_form_a_camera_path_for_render(self):
        with self.view(scene="cornell-box") as viewer, Client(viewer) as client:
            client.done()
            client.steer(type="orbit", dx=0.1, dy=0)
            client.steer(type="key", at=3)
            client.steer(type="set", name="fov", value=50)
            client.steer(type="move", right=0.3, up=0, forward=1, ms=200, pace="normal")
            client.steer(type="key", at=0.5)
            client.steer(type="key", at=7)
            state = self.still(client, client.steer(type="unkey", index=2))
            keys = state["keys"]
            self.assertEqual([key["time"] for key in keys], [0.5, 3])
            self.assertAlmostEqual(keys[0]["fov"], 50, 3)
            write(self.path("path.json"), json.dumps({"keys": keys}))
            client.set("aperture", 0.02)  # keys do not contain it, so it stays
            client.steer(type="follow")
            self.play(client, False)
            for at in ["0.5", "1.75", "3"]:
                shown = self.still(client, client.steer(type="time", at=float(at)))
                self.assertEqual(shown["hash"], self.rendered("--camera-path", "path.json", "--time", at, "--aperture",
                                                              "0.02", scene="cornell-box"))
                words = words_of(shown)
                self.assertEqual(shown["hash"], self.rendered(*words, scene="cornell-box"))
            # Without its last key the path ends elsewhere, and so does the camera.
            gone = self.still(client, client.steer(type="unkey", index=1))
            self.assertNotEqual(gone["hash"], shown["hash"])
        with self.view("--camera-path", self.path("path.json"), "--time", "1.75", scene="cornell-box") as viewer, \
                Client(viewer) as client:
            state = client.done()
            self.assertEqual(state["keys"], keys)
            self.assertEqual(state["hash"], self.rendered("--camera-path", "path.json", "--time", "1.75", scene="cornell-box"))
            self.assertEqual(state["clock"]["end"], 3)
            client.steer(type="orbit", dx=0.1, dy=0)
            back = self.still(client, client.steer(type="home"))
            self.assertEqual(back["hash"], state["hash"])

    def test_a_turntable_turns_until_the_camera_is_moved(self):
        with self.view("--turntable", "96", "--time", "0", scene="cornell-box") as viewer, Client(viewer) as client:
            first = client.done()
            self.assertEqual((first["clock"]["end"], first["hash"]), (4, self.rendered("--time", "0", scene="cornell-box")))
            quarter = self.still(client, client.steer(type="time", at=1))
            self.assertEqual(quarter["hash"], self.rendered(*words_of(quarter), scene="cornell-box"))
            self.assertNotEqual(quarter["hash"], first["hash"])
            own = self.still(client, client.steer(type="zoom", steps=1))
            self.assertEqual(own["clock"]["end"], 0)  # nothing moves any more
            back = self.still(client, client.steer(type="home"))
            self.assertEqual((back["hash"], back["clock"]["end"]), (quarter["hash"], 4))


if __name__ == "__main__":
    main()
