#!/usr/bin/env python3
"""`pertev view` for a program: who has access, and which pictures arrive."""

import json
import os
import pathlib
import random
import re
import shlex
import signal
import socket
import tempfile
import time
import unittest

from cli_run import SANITIZED, CliTest, main, read_exr, write
from viewer_client import Client, Viewer

LONG = os.environ.get("PERTEV_LONG_TESTS", "0") not in ("", "0")
SOURCES = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FUZZED = 1_000_000 if LONG else 10_000


class WithViewer(unittest.TestCase):
    """One viewer for all tests of a class."""

    arguments = ()
    options = {}

    @classmethod
    def setUpClass(cls):
        cls.viewer = Viewer(*cls.arguments, **cls.options)
        cls.viewer.__enter__()

    @classmethod
    def tearDownClass(cls):
        ended, said = cls.viewer.process.poll(), cls.viewer.process
        status, _ = cls.viewer.end() if ended is None else (ended, 0)
        errors = said.stderr.read().decode()
        cls.viewer.__exit__()
        assert status == 0, (status, errors)
        assert "Sanitizer" not in errors and "runtime error" not in errors, errors


class Access(WithViewer):
    def get(self, target, **changes):
        headers = {**self.viewer.own_headers(), **changes}
        return self.viewer.get(target, {name: value for name, value in headers.items() if value is not None})

    def test_the_printed_address_sets_an_http_only_cookie(self):
        status, headers, body = self.get(f"/?token={self.viewer.token}", Cookie=None)
        self.assertEqual(status, 200)
        self.assertIn(b"<canvas", body)
        self.assertRegex(headers["set-cookie"], r"^pertev-[0-9a-f]{8}=[0-9a-f]{32}; Path=/; HttpOnly; SameSite=Strict$")
        self.assertNotIn(self.viewer.token, headers["set-cookie"])

    def test_only_a_flag_lets_pages_of_others_show_the_viewer_in_a_frame(self):
        headers = self.get("/")[1]
        self.assertEqual(headers["x-frame-options"], "DENY")
        self.assertIn("frame-ancestors 'none'", headers["content-security-policy"])
        with Viewer("--embed") as viewer:
            headers = viewer.get(f"/?token={viewer.token}", {"Host": f"127.0.0.1:{viewer.port}"})[1]
            self.assertTrue(headers["set-cookie"].endswith("; HttpOnly; SameSite=None; Secure; Partitioned"))
            self.assertNotIn("x-frame-options", headers)
            self.assertNotIn("frame-ancestors", headers["content-security-policy"])
            self.assertEqual(viewer.get("/", {"Host": f"127.0.0.1:{viewer.port}"})[0], 403)

    def test_all_files_of_the_page_need_the_cookie_and_have_their_type(self):
        kinds = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
        files = [file for file in pathlib.Path(SOURCES, "apps/viewer/page").iterdir() if file.suffix in kinds]
        for file in files:
            path, kind = "/" if file.suffix == ".html" else f"/{file.name}", kinds[file.suffix]
            status, headers, body = self.get(path)
            self.assertEqual((status, headers["content-type"].split(";")[0]), (200, kind), path)
            self.assertGreater(len(body), 100)
            self.assertEqual(headers["x-content-type-options"], "nosniff")
            policy = headers["content-security-policy"]
            self.assertIn("default-src 'none'", policy)
            self.assertNotIn("unsafe", policy)
        page = self.get("/")[2].decode()
        self.assertNotRegex(page, r"<script(?![^>]* src=)", "no script stands in the page itself")
        self.assertNotRegex(page, r"\son\w+=|style=|https?://")

    def test_requests_without_the_right_cookie_are_refused(self):
        wrong = self.viewer.let_in()[:-1] + "x"
        for target in ["/", "/main.js", "/save?format=png", "/socket", "/nothing", "/?token=", "/?token=00",
                       f"/main.js?token={self.viewer.token}", f"/?token={self.viewer.token}&token={self.viewer.token}"]:
            for cookie in [None, wrong, "pertev-00000000=" + self.viewer.let_in().split("=")[1]]:
                status, headers, body = self.get(target, Cookie=cookie)
                self.assertEqual(status, 403, target)
                self.assertNotIn("set-cookie", headers)
                self.assertLess(len(body), 200)

    def test_a_given_token_opens_the_page_and_is_not_printed(self):
        with tempfile.TemporaryDirectory() as folder:
            token = os.path.join(folder, "token")
            write(token, "0123456789abcdef-_XY\n")
            with Viewer("--token-file", token) as viewer:
                self.assertEqual(viewer.token, "")
                self.assertEqual(viewer.get("/?token=", {"Host": f"127.0.0.1:{viewer.port}"})[0], 403)
                viewer.token = "0123456789abcdef-_XY"
                self.assertEqual(viewer.get("/")[0], 200)

    def test_only_local_host_names_are_accepted(self):
        port = self.viewer.port
        for host in ["localhost", "localhost:1", f"127.0.0.1:{port}", "[::1]:99", "LocalHost:8080"]:
            self.assertEqual(self.get("/", Host=host)[0], 200, host)
        for host in ["evil.com", f"evil.com:{port}", "localhost.evil.com", "127.0.0.2", "", "localhost:x"]:
            self.assertEqual(self.get("/", Host=host)[0], 403, host)
        twice = self.viewer.send_raw(b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.com\r\n\r\n")
        self.assertIn(b" 400 ", twice.split(b"\r\n")[0])

    def test_a_page_of_another_origin_is_refused_and_a_web_socket_must_show_its_origin(self):
        own = f"http://127.0.0.1:{self.viewer.port}"
        self.assertEqual(self.get("/", Origin=own)[0], 200)
        for origin in ["http://evil.com", "null", own + "1", own.replace("127.0.0.1", "localhost")]:
            self.assertEqual(self.get("/", Origin=origin)[0], 403, origin)
        headers = self.viewer.own_headers()
        for origin in [None, "http://evil.com", "null"]:
            given = dict(headers, Origin=origin) if origin else headers
            with Client(self.viewer, headers=given) as client:
                self.assertEqual(client.status, 403, origin)
        with Client(self.viewer, headers={"Host": headers["Host"], "Origin": own}) as client:
            self.assertEqual(client.status, 403)
        with Client(self.viewer) as client:
            self.assertEqual(client.status, 101)

    def test_other_methods_bodies_paths_and_sizes_are_refused(self):
        for method in ["POST", "PUT", "DELETE", "HEAD", "OPTIONS", "NONSENSE"]:
            self.assertIn(self.viewer.get("/", method=method)[0], (400, 405), method)
        for path in ["/../etc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd", "/main.js/", "/cli_run.py", "/jsconfig.json",
                     "/save", "/save?format=jpg", "/save?format=../x"]:
            self.assertEqual(self.get(path)[0], 404, path)
        self.assertEqual(self.get("/" + "a" * 2000)[0], 400)
        self.assertEqual(self.get("/", Long="a" * 9000)[0], 413)
        body = self.viewer.send_raw(b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999\r\n\r\n" + b"a" * 99999)
        self.assertTrue(body == b"" or b" 413 " in body.split(b"\r\n")[0], body[:100])

    def test_two_viewers_do_not_share_their_cookies(self):
        with Viewer(size="16x16", spp=1) as other:
            self.assertNotEqual(other.let_in().split("=")[0], self.viewer.let_in().split("=")[0])
            self.assertEqual(other.get("/", self.viewer.own_headers())[0], 403)
            both = dict(other.own_headers(), Cookie=f"{self.viewer.let_in()}; {other.let_in()}")
            self.assertEqual(other.get("/", both)[0], 200)


class Fuzzed(WithViewer):
    def test_malformed_requests_and_messages_get_an_answer_or_a_closed_connection(self):
        """Half of them are requests and half messages. They are valid ones with faults, so that many are parsed far."""
        chance = random.Random(7)

        def spoil(data):
            data = bytearray(data)
            for _ in range(chance.randrange(4)):
                at = chance.randrange(len(data))
                how = chance.randrange(4)
                if how == 0:
                    data[at] = chance.randrange(256)
                elif how == 1:
                    del data[at : at + chance.randrange(8)]
                elif how == 2:
                    data[at:at] = bytes(chance.randrange(256) for _ in range(chance.randrange(8)))
                else:
                    data[at:at] = data[: chance.randrange(len(data) + 1)]
                data = data or bytearray(b" ")
            return bytes(data)

        headers = "".join(f"{name}: {value}\r\n" for name, value in self.viewer.own_headers().items())
        requests = [f"GET {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n".encode()
                    for path in ["/", "/icon.svg", "/save?format=gif", f"/?token={self.viewer.token}"]]
        requests.append(f"GET /socket HTTP/1.1\r\n{headers}Origin: http://127.0.0.1:{self.viewer.port}\r\nUpgrade: websocket"
                        "\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
                        "AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n\x81\x80aaaa".encode())
        messages = ['{"type":"orbit","n":1,"dx":0.1,"dy":0.1}', '{"type":"set","n":2,"name":"exposure","value":1}',
                    '{"type":"move","n":1,"right":1,"up":0,"forward":0,"ms":10,"pace":"fast"}',
                    '{"type":"pick","n":3,"x":0.5,"y":0.5,"use":"orbit"}',
                    '{"type":"play","n":4,"on":true,"loops":false,"speed":2}', '{"type":"time","n":5,"at":1}',
                    '{"type":"key","n":6,"at":2}', '{"type":"unkey","n":7,"index":0}', '{"type":"follow","n":8}',
                    '{"type":"ack","frame":1,"ms":1}',
                    '{"type":"set","n":2,"name":"traversal","value":"packet"}', '{"type":"hand","to":1}', '{"type":"meter","n":3}',
                    '{"type":"look","n":9,"dx":0.1,"dy":-0.1}', '{"type":"pan","n":10,"dx":0.1,"dy":0.1}',
                    '{"type":"zoom","n":11,"steps":1}', '{"type":"speed","n":12,"steps":-1}', '{"type":"home","n":13}',
                    '{"type":"camera","n":14,"index":0}', '{"type":"rate","hz":60}', '{"type":"ask"}',
                    '{"type":"shape","width":640,"height":480}',
                    '{"type":"hello","key":"again"}']
        with open(os.path.join(SOURCES, "apps", "viewer", "client_message.cpp"), encoding="utf-8") as file:
            kinds = set(re.findall(r'{"(\w+)", MessageKind::', file.read()))
        self.assertEqual({json.loads(message)["type"] for message in messages}, kinds)  # for each of them
        client, before = None, 0
        for number in range(FUZZED // 2):
            self.viewer.send_raw(spoil(chance.choice(requests)))
            if client is None:
                client = Client(self.viewer, key="fuzz", acknowledges=False)
                self.assertEqual(client.status, 101)
            try:
                client.send_frame(chance.choice([1, 1, 1, 1, 1, 2, 9, 10, 3, 8]), spoil(chance.choice(messages).encode()))
                if number % 16 == 0:
                    raise ConnectionError  # the connection closes without a message
            except OSError:
                client.socket.close()
                client = None
            if number == FUZZED // 20:
                before = self.viewer.resident_bytes()
            self.assertIsNone(self.viewer.process.poll())
        if client:
            client.socket.close()
        self.assertEqual(self.viewer.get("/")[0], 200)
        if not SANITIZED:  # it keeps freed memory
            self.assertLess(self.viewer.resident_bytes() - before, 48 << 20)


class Pictures(CliTest):
    def rendered(self, *arguments, spp=4):
        metered = [] if "--exposure" in arguments else ["--exposure", "auto"]
        done = self.render(*metered, *arguments, size="64x48", spp=spp, output=self.path("picture.png"))
        with open(self.path("picture.png"), "rb") as file:
            return done["hash"], file.read()

    def test_the_still_picture_equals_that_of_render(self):
        with Viewer() as viewer, Client(viewer) as client:
            png = client.png()
            state = client.done()
            self.assertEqual((state["hash"], png), self.rendered())
            self.assertEqual((state["values"]["max_depth"], state["values"]["moving_depth"]), (16, 4))
            # After flying, too, the displayed flags reproduce the bytes.
            client.steer(type="look", dx=0.1, dy=-0.05)
            client.steer(type="orbit", dx=-0.2, dy=0.1)
            client.steer(type="pan", dx=0.02, dy=0.1)
            client.steer(type="zoom", steps=-2)
            last = client.steer(type="move", right=1, up=0.5, forward=-1, ms=100, pace="fast")
            header, _ = client.picture(lambda h: h["input"] == last and h["flags"] & 1)
            self.assertEqual(header["samples"], 4)
            flags = client.done(lambda s: s["samples"] == 4)
            words = flags["flags"].replace("'", "").split()
            self.assertEqual(flags["hash"], self.rendered(*words)[0])
            self.assertNotEqual(flags["hash"], self.rendered()[0])
            # And no structure or traversal changes it.
            for name, value in [("structure", "octree"), ("traversal", "while-while"), ("rta", "off"), ("structure", "sbvh")]:
                client.set(name, value)
                state = client.done(lambda s, n=name, v=value: s["values"][n] == v)
                self.assertEqual(state["hash"], flags["hash"], (name, value))

    def test_settings_change_the_picture_as_flags_do(self):
        with Viewer() as viewer, Client(viewer) as client:
            client.done()
            client.set("integrator", "distributed")
            state = client.done(lambda s: s["values"]["integrator"] == "distributed")
            self.assertEqual(state["hash"], self.rendered("--integrator", "distributed", spp=state["spp"])[0])
            client.set("layer", "motion")
            self.assertIn("distributed", client.text("notice")["text"])
            client.set("integrator", "whitted")
            self.assertIn("emitters", client.text("notice")["text"])
            client.set("integrator", "path")
            for name, value, flag in [("max_depth", 1, "--max-depth"), ("integrator", "direct", "--integrator"),
                                      ("spp", 7, "--spp")]:
                client.set(name, value)
                state = client.done(lambda s, n=name, v=value: s["values"][n] == v)
                arguments = [flag, str(value)] if name != "spp" else []
                kept = ["--max-depth", "1"] if name != "max_depth" else []
                kept += ["--integrator", "direct"] if name == "spp" else []
                self.assertEqual(state["hash"], self.rendered(*kept, *arguments, spp=state["spp"])[0], name)
            # The displayed flags alone reproduce the picture.
            words = shlex.split(dict(row[1:] for row in state["rows"])["flags for this picture"])
            again = self.succeed("render", "cornell-box", "-o", "again.png", "--device", "cpu", "--json", *words)
            self.assertEqual(again.events("done")[0]["hash"], state["hash"])
            client.set("spp", -1)
            self.assertIn("whole number", client.text("notice")["text"])
            for tone_map in ["srgb", "aces"]:
                last = client.set("tone_map", tone_map)
                header, png = client.picture(lambda h, n=last: h["input"] == n and h["kind"] == 2)
                self.assertEqual(header["total"], len(png))
                self.assertEqual(png, self.rendered("--max-depth", "1", "--integrator", "direct", "--tone-map", tone_map, spp=7)[1])

    def test_the_viewer_shows_each_layer_and_then_the_picture_again(self):
        with Viewer() as viewer, Client(viewer) as client:
            whole = client.done()
            seen = set()
            for layer in ["albedo", "normal", "depth", "instances", "triangles", "materials", "heat: nodes",
                          "heat: triangles", "motion", "deviation"]:
                last = client.set("layer", layer)
                header, data = client.picture(lambda h, n=last: h["input"] == n and h["kind"] == 2)
                self.assertEqual((header["width"], header["height"]), (64, 48))
                seen.add(data)
            self.assertEqual(len(seen), 10)
            client.set("layer", "picture")
            self.assertEqual(client.done(lambda s: s["values"]["layer"] == "picture")["hash"], whole["hash"])

    def test_exposure_adapts_to_the_view_and_the_still_picture_is_exposed_as_by_render(self):
        def stops(state):
            return next(value for _, label, value in state["rows"] if label == "exposed by")

        with Viewer() as viewer, Client(viewer) as client:
            home = client.done()
            # Moves up to the emitter, so that the view shows little besides a wall.
            last = client.steer(type="move", right=0, up=0.5, forward=1, ms=250, pace="fast")
            for _ in range(30):
                last = client.steer(type="look", dx=0.001, dy=0.012)
                client.picture(lambda h, n=last: h["input"] >= n)
            png = client.png()
            state = client.done(lambda s: s["input"] >= last)
            self.assertNotEqual(stops(state), stops(home))
            words = state["flags"].replace("'", "").split()
            self.assertEqual((state["hash"], png), self.rendered(*words))
            client.set("exposure", -1.5)
            less = client.done(lambda s: s["values"]["exposure"] == -1.5)
            self.assertAlmostEqual(float(stops(less).split()[0]), float(stops(state).split()[0]) - 1.5, 5)
            client.set("exposed", "fixed")
            fixed = client.done(lambda s: s["values"]["exposed"] == "fixed")
            self.assertEqual(stops(fixed), stops(less))
            self.assertAlmostEqual(fixed["values"]["exposure"], float(stops(less).split()[0]), 2)
            back = client.done(lambda s, n=client.steer(type="home"): s["input"] >= n)
            self.assertEqual(stops(back), stops(fixed))
            client.set("exposed", "auto")
            self.assertEqual(stops(client.done(lambda s: s["values"]["exposed"] == "auto")), stops(home))
        with Viewer("--exposure", "1") as viewer, Client(viewer) as client:
            state = client.done()
            self.assertEqual((stops(state), state["values"]["exposed"]), ("+1.00 stops", "fixed"))

    def test_restir_and_its_resolution_can_change_and_do_not_affect_the_still_picture(self):
        with Viewer("--restir", "di", "--restir-history", "7", "--resolution-scale", "0.5") as viewer, Client(viewer) as client:
            home = client.done()
            self.assertEqual([home["values"][name] for name in ("restir", "restir_history", "resolution_scale")], ["di", 7, 0.5])
            self.assertEqual(home["hash"], self.rendered()[0])
            client.set("mode", "real time")
            for restir, scale in [("gi", 0.5), ("off", 0.25), ("di", 1)]:
                client.set("restir", restir)
                last = client.set("resolution_scale", scale)
                client.picture(lambda h, n=last: h["input"] >= n)
                state = client.done(lambda s, n=last: s["input"] >= n)
                self.assertEqual([state["values"][name] for name in ("restir", "resolution_scale")], [restir, scale])
                self.assertIn("reconstruction", [label for _, label, _ in state["rows"]])
            client.set("denoiser", "off")
            client.set("mode", "reference")
            self.assertEqual(client.done(lambda s: s["values"]["mode"] == "reference" and s["hash"])["hash"], home["hash"])
            client.set("resolution_scale", 0.05)
            self.assertIn("Light resolution", client.text("notice")["text"])

    def test_saved_files_equal_those_of_render(self):
        with Viewer() as viewer:
            status, headers, png = viewer.get("/save?format=png")  # no client needs to watch
            self.assertEqual(status, 200)
            self.assertIn("attachment", headers["content-disposition"])
            self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
            with Client(viewer) as client:
                state = client.done()
            self.assertEqual(viewer.get("/save?format=png")[2], self.rendered()[1])
            with open(self.path("saved.exr"), "wb") as file:
                file.write(viewer.get("/save?format=exr")[2])
            info = self.info("saved.exr")
            self.assertEqual(info["hash"], state["hash"])

    def test_render_reproduces_a_saved_exr_from_its_settings(self):
        with Viewer("--seed", "7", "--restir", "di", "--exposure", "1.5", "--environment", "0.1,0.2,0.3") as viewer, \
                Client(viewer) as client:
            client.done()
            changes = [("max_depth", 2), ("spp", 3), ("tone_map", "aces"), ("integrator", "direct"), ("fov", 50), ("aperture", 0.01)]
            for moves in [False, True]:
                last = client.steer(type="orbit", dx=-0.2, dy=0.1) if moves else 0
                for name, value in changes if moves else []:
                    last = client.set(name, value)
                state = client.done(lambda s, n=last: s["input"] >= n and s["hash"])
                with open(self.path("saved.exr"), "wb") as file:
                    file.write(viewer.get("/save?format=exr")[2])
                write(self.path("s.json"), self.succeed("info", "saved.exr", "--settings").stdout)
                self.succeed("render", "cornell-box", "-o", "again.exr", "-o", "again.png", "--settings", "s.json", "--device", "cpu")
                saved, again = self.info("saved.exr"), self.info("again.exr")
                self.assertEqual(saved["hash"], state["hash"])
                for name in ["hash", "pertev.hash", "pertev.spp", "pertev.integrator", "pertev.max_depth", "pertev.seed", "pertev.eye",
                             "pertev.fov", "pertev.tone_map", "pertev.exposure", "pertev.environment", "pertev.scene_hash"]:
                    self.assertEqual(saved[name], again[name], name)
                self.assertIn("seed", saved["pertev.by_caller"].split())

    def test_the_object_at_a_pixel_is_reported_by_name(self):
        with Viewer() as viewer, Client(viewer) as client:
            client.steer(type="pick", x=0.5, y=0.95, use="show")
            rows = {label: value for _, label, value in client.text("picked")["rows"]}
            self.assertIn("floor", rows["instance"])
            self.assertIn("white", rows["material"])
            self.assertEqual(rows["normal"], "0, 1, 0")
            client.done()
            client.steer(type="pick", x=0.5, y=0.95, use="show")
            light = {label: value for _, label, value in client.text("picked")["rows"]}["light"]
            with open(self.path("saved.exr"), "wb") as file:
                file.write(viewer.get("/save?format=exr")[2])
            width, height, channels = read_exr(self.path("saved.exr"))
            at = (int(0.95 * height), int(0.5 * width))
            self.assertEqual(light, ", ".join(f"{channels[c][at[0]][at[1]]:.3g}" for c in "RGB"))
            client.set("aperture", 0.01)
            client.steer(type="pick", x=0.5, y=0.95, use="focus")
            self.assertIn("in focus", client.text("notice")["text"])
            self.assertIn("--aperture 0.01", client.done(lambda s: "--aperture" in s["flags"])["flags"])

    def test_the_first_picture_is_small_and_comes_before_a_full_size_sample(self):
        with Viewer(size="2560x1440", spp=64) as viewer, Client(viewer) as client:
            header, _ = client.picture()
            self.assertLess(header["width"], 2560)
            self.assertEqual((header["full_width"], header["full_height"]), (2560, 1440))
            # The machine's speed is still unknown, but the first step is shown soon.
            began = time.monotonic()
            last = client.steer(type="orbit", dx=0.01, dy=0)
            client.picture(lambda h: h["input"] >= last)
            self.assertLess(time.monotonic() - began, 3 if SANITIZED else 1.5)

    def test_pictures_of_a_moving_camera_are_small_and_carry_their_input_number(self):
        with Viewer(size="640x480", spp=1000) as viewer, Client(viewer) as client:
            client.picture()
            for _ in range(12):
                began = time.monotonic()
                number = client.steer(type="orbit", dx=0.01, dy=0)
                header, data = client.picture(lambda h, n=number: h["input"] >= n)
                self.assertEqual(data[:2] + data[-2:], b"\xff\xd8\xff\xd9")
                self.assertEqual((header["full_width"], header["full_height"]), (640, 480))
            waited = time.monotonic() - began
            self.assertLess(waited, 2)
            self.assertTrue(header["width"] < 640 or waited < 0.25, (header, waited))  # a fast machine keeps the frame rate at full size
            rates = set()
            for _ in range(20):  # a late state belongs to a picture at rest, which has no frame rate
                if rates or header["width"] == 640:
                    break
                number = client.steer(type="orbit", dx=0.01, dy=0)
                rows = client.text("state", lambda s, n=number: s["input"] >= n)["rows"]
                rates = {row[2] for row in rows if row[:2] == ["Frames", "frame rate of automatic size"]}
            if header["width"] < 640:
                self.assertEqual(rates, {"8 per second"})
            # Input comes faster than pictures: these come all the same, five a second where the machine has a moment for
            # it, and none is far behind.
            for _ in range(10):
                shown, end = [], time.monotonic() + 1
                while time.monotonic() < end:
                    number = client.steer(type="orbit", dx=0.002, dy=0)
                    try:
                        while True:
                            message = client.receive(1 / 60)
                            if isinstance(message, tuple):
                                shown.append(number - message[0]["input"])
                    except TimeoutError:
                        pass
                if len(shown) >= 6:
                    break
            self.assertGreater(len(shown), 2 if SANITIZED else 5)
            self.assertLess(sorted(shown)[len(shown) // 2], 40)


class Ends(CliTest):
    def test_view_opens_the_browser_on_a_desktop_unless_a_flag_forbids_it(self):
        opened = self.path("opened")
        write(self.path("xdg-open"), f'#!/bin/sh\nprintf "%s" "$*" > {opened}.part && mv {opened}.part {opened}\n')
        os.chmod(self.path("xdg-open"), 0o755)
        for told, opens in [(["--no-browser"], False), ([], True)]:
            with Viewer(*told, size="16x16", spp=1, desktop=os.path.dirname(opened)) as viewer:
                end = time.monotonic() + (20 if opens else 0.3)
                while not os.path.exists(opened) and time.monotonic() < end:
                    time.sleep(0.02)
                self.assertEqual(os.path.exists(opened), opens)
                if opens:
                    with open(opened, encoding="utf-8") as file:
                        self.assertEqual(file.read(), viewer.address)
                self.assertEqual(viewer.end()[0], 0)

    def test_an_interrupt_ends_the_viewer_within_a_second_with_status_0(self):
        for how, size, flags, depth in [(signal.SIGINT, "64x48", ["--max-depth", "7"], 7),
                                        (signal.SIGTERM, "1600x1200", ["--max-depth", "7", "--moving-depth", "3"], 3)]:
            with Viewer(*flags, size=size, spp=100000) as viewer, Client(viewer) as client:
                client.picture()
                self.assertEqual(client.text("state")["values"]["moving_depth"], depth)
                status, seconds = viewer.end(how)
                self.assertEqual(status, 0)
                self.assertLess(seconds, 1.5)  # a second, and more on a loaded machine
                self.assertIn(client.close_reason(5)[0], (0, 1001))

    def test_a_used_port_and_an_invalid_host_are_refused(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.refuse(2, "view", "cornell-box", "--size", "16x16", "--port", port, "--device", "cpu",
                        says=["--port", str(port)])
        for host in ["0.0.0.0", "::"]:
            self.refuse(2, "view", "cornell-box", "--host", host, says=["--host", "browsers"])
        self.refuse(2, "view", "cornell-box", "--port", "70000", says=["--port"])
        self.refuse(2, "view", "nowhere.obj", says=["nowhere.obj"])
        self.refuse(3, "view", "cornell-box", "--size", "65501x1", "--device", "cpu", says=["--size"])
        self.refuse(2, "view", "cornell-box", "-o", "x.png", says=["-o"])

    def test_view_takes_all_flags_of_render_except_the_documented_ones(self):
        def flags_of(verb):
            return set(re.findall(r"(?m)^  (?:-\w,)?(--[a-z][a-z-]+)", self.succeed(verb, "--help", "all").stdout))

        with open(os.path.join(SOURCES, "docs", "viewer.md"), encoding="utf-8") as file:
            sentence = re.search(r"every flag of `pertev render` except(.*?);", file.read(), re.S).group(1)
        self.assertEqual(flags_of("render") - flags_of("view") - {"--output"}, set(re.findall(r"`(--[a-z-]+)`", sentence)))

    def test_a_warning_explains_what_listening_on_another_host_means(self):
        with Viewer("--host", "127.0.0.2", size="16x16", spp=1) as viewer:
            self.assertEqual(viewer.host, "127.0.0.2")
            self.assertEqual(viewer.get("/")[0], 200)
            self.assertEqual(viewer.end()[0], 0)
            self.assertIn("not encrypted", viewer.process.stderr.read().decode())


if __name__ == "__main__":
    main()
