#!/usr/bin/env python3
"""`pertev view` for a program: the picture has the window's shape, grows on a slow machine and keeps its samples. A
second client learns why it does not steer, and no client learns the folders of files."""

import math
import os
import select
import time

from cli_frames_test import moving_gltf
from cli_run import SANITIZED, CliTest, main, read_exr, write
from viewer_client import Client, Viewer


WAITING = Viewer(size="16x16", spp=1)
WAITING_SINCE = 0  # its start


def setUpModule():  # pylint: disable=invalid-name
    global WAITING_SINCE
    WAITING.__enter__()
    WAITING_SINCE = time.monotonic()


def tearDownModule():  # pylint: disable=invalid-name
    WAITING.__exit__()


class Shape(CliTest):
    def test_the_picture_takes_the_shape_of_the_window_and_the_shown_flags_reproduce_it(self):
        with Viewer(size="", spp=2) as viewer, Client(viewer) as client:
            for width, height in [(120, 80), (64, 100)]:
                client.say(type="shape", width=width, height=height)
                state = client.done(lambda s, w=width, h=height: s["flags"].endswith(f" --size {w}x{h}") and s["hash"])
                self.assertTrue(dict(row[1:] for row in state["rows"])["flags for this picture"].endswith(state["flags"]))
                self.assertIn(["Now", "size", f"{width} x {height}"], state["rows"])
                size, camera = f"{width}x{height}", state["flags"].removesuffix(f" --size {width}x{height}")
                made = self.render("--exposure", "auto", *camera.replace("'", "").split(), size=size, spp=2,
                                   output=self.path("x.png"))
                self.assertEqual(made["hash"], state["hash"])
            with Client(viewer, key="second") as other:
                other.say(type="shape", width=30, height=30)  # does not steer
                client.steer(type="orbit", dx=0.1, dy=0)
                self.assertTrue(client.done(lambda s: s["input"] == 1)["flags"].endswith("64x100"))

    def test_a_window_gets_at_most_the_default_number_of_pixels_and_a_requested_size_is_kept(self):
        with Viewer(size="", spp=1) as viewer, Client(viewer) as client:
            client.say(type="shape", width=3840, height=2160)
            client.picture()
            client.say(type="shape", width=2000, height=4000)
            header, _ = client.picture(lambda h: h["full_height"] > h["full_width"])  # not a picture of the previous shape
            self.assertLessEqual(header["full_width"] * header["full_height"], 1280 * 720)
            self.assertAlmostEqual(header["full_height"] / header["full_width"], 2, 2)
        with Viewer(size="64x48", spp=1) as viewer, Client(viewer) as client:
            client.say(type="shape", width=100, height=100)
            state = client.done()
            self.assertNotIn("--size", state["flags"])
            self.assertIn(["Now", "size", "64 x 48"], state["rows"])

    def test_a_calibrated_camera_keeps_its_shape_and_can_be_steered_and_zoomed(self):
        words = ["--camera-pose=-1,0,0,0.25,0,1,0,0.3,0,0,-1,-0.75", "--intrinsics", "50,60,30,26", "--intrinsics-size", "64x48"]
        with Viewer(*words, size="", spp=2) as viewer, Client(viewer) as client:
            client.say(type="shape", width=100, height=100)
            home = client.done()
            self.assertEqual(home["hash"], self.render(*words, size="64x48", spp=2)["hash"])
            client.set("fov", 30)
            last = client.steer(type="move", right=1, up=0, forward=0, ms=100, pace="fast")
            state = client.done(lambda s: s["values"]["fov"] == 30 and s["input"] >= last)
            flags = state["flags"].replace("'", "").split()
            self.assertNotEqual(state["hash"], home["hash"])
            self.assertEqual(state["hash"], self.render(*flags, size="64x48", spp=2)["hash"])
            focal = [float(number) for number in flags[flags.index("--intrinsics") + 1].split(",")]
            self.assertAlmostEqual(focal[1], 24 / math.tan(math.radians(15)), 3)
            self.assertAlmostEqual(focal[0] / focal[1], 50 / 60, 12)
            self.assertEqual(focal[2:], [30, 26])


class Keeps(CliTest):
    def test_a_setting_that_is_refused_keeps_the_samples(self):
        with Viewer("--threads", "1", size="64x48", spp=100000) as viewer, Client(viewer) as client:
            # So many samples that a restarted picture has fewer for seconds.
            before = client.text("state", lambda s: s["samples"] > 200)["samples"]
            for name, value in [("integrator", "whitted"), ("max_depth", -1), ("integrator", "nothing"), ("fov", 500),
                                ("integrator", "path"), ("structure", 7), ("home", "where it is")]:
                number = client.steer(type="home") if name == "home" else client.set(name, value)
            client.text("state", lambda s: s["input"] == number)
            for _ in range(3):  # the first state may precede the last setting
                self.assertGreaterEqual(client.text("state", lambda s: s["hash"])["samples"], before)


class Grows(CliTest):
    def test_on_a_slow_machine_resolution_grows_and_restarts_small_after_a_change(self):
        with Viewer("--threads", "1", size="1280x960", spp=64) as viewer, Client(viewer) as client:
            end, widths = time.monotonic() + 60, []
            while time.monotonic() < end and (not widths or widths[-1] < 640):
                header, _ = client.picture()
                if not widths or header["width"] != widths[-1]:
                    widths.append(header["width"])
            self.assertGreater(len(widths), 2, widths)
            self.assertEqual(widths[-3:], sorted(widths[-3:]))  # until then the size depends on earlier frames
            for name, value in [("max_depth", 3), ("integrator", "distributed"), ("layer", "albedo")]:
                began = time.monotonic()
                number = client.set(name, value)
                header, _ = client.picture(lambda h, n=number: h["input"] == n)
                self.assertLess(time.monotonic() - began, 10 if SANITIZED else 3, name)  # takes a second on an idle machine
                self.assertLess(header["width"], 640, name)


class Together(CliTest):
    def test_a_second_client_gets_the_reason_why_it_cannot_steer_and_the_first_sees_its_request(self):
        with Viewer() as viewer, Client(viewer, key="first") as first:
            before = first.done()["flags"]
            with Client(viewer, key="second") as second:
                second.text("people")
                for _ in range(20):
                    second.steer(type="orbit", dx=0.1, dy=0)
                told = second.text("notice")
                self.assertEqual(told["kind"], "why")
                people = first.text("people", lambda p: any(person["request"] for person in p["people"]))
                requester = next(person for person in people["people"] if person["request"])
                self.assertIn(f"viewer {people['you']} steers", told["text"])
                self.assertNotEqual(requester["id"], people["you"])
                self.assertEqual(requester["request"], "orbit the view")
                first.say(type="hand", to=requester["id"])
                second.text("people", lambda p: p["steers"] == p["you"] and not any(q["request"] for q in p["people"]))
                second.steer(type="orbit", dx=0.1, dy=0)
                second.text("state", lambda s: s["flags"] != before)


class Secrets(CliTest):
    def test_no_client_gets_the_path_of_the_scene(self):
        os.mkdir(self.path("a-secret"))
        write(self.path("a-secret/m.gltf"), moving_gltf())
        with Viewer("--time", "0", scene=self.path("a-secret/m.gltf"), spp=1) as viewer, Client(viewer) as client:
            welcome = client.text("welcome")
            self.assertEqual(welcome["scene"], "m.gltf")
            self.assertIn(["Scene", "file", "m.gltf"], welcome["about"])
            state = client.done()
            for format_ in ("png", "exr"):
                with open(self.path("saved"), "wb") as file:
                    file.write(viewer.get(f"/save?format={format_}")[2])
                with open(self.path("saved"), "rb") as file:
                    self.assertNotIn(b"a-secret", file.read())
            self.assertEqual(read_exr(self.path("saved"))[:2], (64, 48))
            self.assertNotIn("a-secret", str(welcome) + str(state))


class Waits(CliTest):  # the last test by name, because its viewer waits during all others
    def test_the_log_of_an_idle_viewer_has_no_line_twice(self):
        heard, end = b"", WAITING_SINCE + 11  # the log gets a line every 10 s if there is progress
        while (left := end - time.monotonic()) > 0 or select.select([WAITING.process.stderr], [], [], 0)[0]:
            if select.select([WAITING.process.stderr], [], [], max(left, 0))[0]:
                chunk = os.read(WAITING.process.stderr.fileno(), 4096)
                self.assertNotEqual(chunk, b"", "the viewer has ended")
                heard += chunk
        lines = [line for line in heard.decode().splitlines() if line]
        self.assertEqual(len(lines), len(set(lines)), lines)
        self.assertNotIn("waiting", heard.decode())


if __name__ == "__main__":
    main()
