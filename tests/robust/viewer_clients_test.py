#!/usr/bin/env python3
"""Several clients of `pertev view` and their links: who steers, and that no client affects another."""

import json
import os
import socket
import threading
import time

from cli_run import CliTest, main, write
from viewer_client import Client, Closed, Tunnel, Viewer
from viewer_test import WithViewer


class Together(WithViewer):
    arguments = ["--threads", "1"]  # it keeps rendering
    options = {"size": "160x120", "spp": 100000}

    def test_one_client_steers_hands_over_control_and_keeps_it_after_reconnecting(self):
        with Client(self.viewer, key="first") as first, Client(self.viewer, key="second") as second:
            first.say(type="ask")  # an earlier test may have left reserved control
            people = second.text("people", lambda p: len(p["people"]) == 2 and p["steers"] == p["you"] - 1)
            first.steer(type="home")
            first.set("exposure", 2)
            before = second.text("state", lambda s: s["values"]["exposure"] == 2)["flags"]
            second.steer(type="orbit", dx=1, dy=0)  # this has no effect
            number = first.steer(type="set", name="exposure", value=3)
            state = second.text("state", lambda s: s["values"]["exposure"] == 3)
            self.assertEqual(state["flags"], before)
            second.say(type="ask")
            asked = first.text("people", lambda p: any(person["asks"] for person in p["people"]))
            self.assertEqual(asked["steers"], asked["you"])
            first.say(type="hand", to=people["you"])
            second.text("people", lambda p: p["steers"] == p["you"])
            second.steer(type="orbit", dx=0.2, dy=0)
            moved = first.text("state", lambda s: s["flags"] != before)["flags"]
            second.socket.close()
            with Client(self.viewer, key="second") as again:
                mine = again.text("people")
                self.assertEqual(mine["steers"], mine["you"])
                self.assertEqual(again.text("state")["flags"], moved)
                again.steer(type="home")
                again.text("state", lambda s: s["flags"] == before)
            self.assertGreater(number, 0)

    def watch(self, client, seconds=1.0):
        """Returns the pictures that the client gets in this time."""
        count, end = 0, time.monotonic() + seconds
        while time.monotonic() < end:
            client.steer(type="orbit", dx=0.001, dy=0)
            client.picture()
            count += 1
        return count

    def test_clients_that_are_silent_or_flood_do_not_stop_the_others(self):
        with Client(self.viewer, key="good") as good:
            good.text("people", lambda p: p["steers"] in (p["you"], 0))
            good.say(type="ask")
            with Client(self.viewer, key="deaf") as deaf, Client(self.viewer, key="mute", acknowledges=False) as mute, \
                    Client(self.viewer, key="flood") as flood:
                halves = [socket.create_connection((self.viewer.host, self.viewer.port)) for _ in range(20)]
                for half in halves:
                    half.sendall(b"GET / HTTP/1.1\r\nHost: loc")
                self.assertGreater(self.watch(good), 3)
                pictures = 0
                try:
                    while True:
                        pictures += isinstance(mute.receive(0.3), tuple)
                except TimeoutError:
                    pass
                self.assertEqual(pictures, 2)
                with self.assertRaises((Closed, OSError)):
                    for _ in range(5000):
                        flood.say(type="zoom", n=1, steps=1)
                    flood.until(lambda m: False, 10)
                self.assertGreater(self.watch(good), 3)
                self.assertEqual(deaf.status, 101)
                for half in halves:
                    half.close()

    def test_sixteen_clients_are_accepted_and_the_next_is_refused_with_the_reason(self):
        clients = []
        try:
            for number in range(16):
                clients.append(Client(self.viewer, key=f"one of many {number}"))
                self.assertEqual(clients[-1].status, 101)
                clients[-1].text("welcome")
            with Client(self.viewer) as late:
                code, reason = late.close_reason(10)
                self.assertEqual(code, 1013)
                self.assertIn("too many", reason)
        finally:
            for client in clients:
                client.socket.close()

    def test_messages_that_are_too_large_or_invalid_close_only_their_own_connection(self):
        for spoil, code in [(lambda c: c.say_text("x" * 5000), 1009), (lambda c: c.say_text("{}"), 1008),
                            (lambda c: c.send_frame(2, b"abc"), 1008)]:
            with Client(self.viewer, key="bad") as client:
                client.text("welcome")
                spoil(client)
                self.assertIn(client.close_reason(10)[0], (code, 0))  # 0 if unread data interrupts the closing
        self.assertEqual(self.viewer.get("/")[0], 200)


class SlowLink(WithViewer):
    """The first pictures have about 8 KiB, and the link takes 32 KiB per second."""

    options = {"size": "320x240", "spp": 64}
    arguments = ("--max-depth", "1")

    def test_a_slow_link_gets_pictures_of_a_lower_quality_and_its_delay_does_not_grow(self):
        sent, delays, sizes, coarse, end = {}, [], [], [], time.monotonic() + 4
        with Tunnel(self.viewer, 32 << 10) as tunnel, Client(tunnel, key="far") as far:
            far.set("moving_scale", "1")

            def goes_on():  # a loaded machine takes longer
                now = time.monotonic()
                return now < end or (len(delays) < 16 and now < end + 60)

            def steer():
                while goes_on():
                    sent[far.input + 1] = time.monotonic()
                    far.steer(type="orbit", dx=0.003, dy=0)
                    time.sleep(0.03)

            hand = threading.Thread(target=steer)
            hand.start()
            while goes_on():
                header, data = far.picture()
                if header["kind"] == 1 and header["input"] in sent:
                    delays.append(time.monotonic() - sent[header["input"]])
                    sizes.append(header["width"])
                    coarse.append(coarseness(data))
            hand.join()
        third = len(delays) // 3
        self.assertGreater(third, 3)
        # Under load fewer pictures arrive, with a better quality.
        self.assertTrue(max(coarse) > 1.2 * AT_FIRST or min(sizes) < WIDTH, (coarse, sizes))
        self.assertLess(max(delays[-third:]), max(1.0, 1.5 * max(delays[:third])), delays)


class Paths(CliTest):
    def test_no_client_gets_a_file_path_however_the_scene_was_named(self):
        home = os.path.realpath(self.path("home of a user"))
        os.makedirs(os.path.join(home, "scene", "textures"))
        write(os.path.join(home, "red.png"), "no picture")
        write(os.path.join(home, "scene", "textures", "bad.png"), "no picture")
        lost = "".join(f"newmtl {name}\nmap_Kd {name}\n" for name in ["../red.png", "textures/bad.png", home + "/red.png", "gone/x.png"])
        write(os.path.join(home, "scene", "a.mtl"), "newmtl a\nKe 9 9 9\n" + lost)
        faces = "".join(f"usemtl {name}\nf 1 2 3\n" for name in ["a", "../red.png", "textures/bad.png", home + "/red.png", "gone/x.png"])
        write(os.path.join(home, "scene", "a.obj"), "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n" + faces)
        for folder, scene in [("scene", "a.obj"), ("", "scene/a.obj"), ("scene/textures", "../a.obj"), ("", home + "/scene/a.obj"),
                              ("", "./scene/../scene/a.obj")]:
            with self.subTest(scene=scene), Viewer("--allow-path", home, scene=scene, size="16x16", spp=1,
                                                   folder=os.path.join(home, folder)) as viewer, Client(viewer) as client:
                welcome = client.text("welcome")
                left_out = [value for _, label, value in welcome["about"] if label == "left out"]
                self.assertGreater(len(left_out), 1, welcome["about"])
                told = json.dumps([welcome, client.done()]) + viewer.get("/save?format=exr")[2].decode("latin-1")
                for secret in [home, "home of a user", os.path.dirname(home), "../a.obj"]:
                    self.assertNotIn(secret, told)
                self.assertTrue(any("textures/bad.png" in text for text in left_out), left_out)


WIDTH = 320
AT_FIRST = 1477  # coarseness of quality 80, with which pictures for a client begin


def coarseness(jpeg):
    """Returns the sum of a JPEG's first quantisation table. A larger sum means a lower quality."""
    at = jpeg.index(b"\xff\xdb")
    return sum(jpeg[at + 5 : at + 5 + 64])


if __name__ == "__main__":
    main()
