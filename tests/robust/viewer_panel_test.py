#!/usr/bin/env python3
"""The panel of `pertev view` in a real headless Chromium: its groups, a phone's window, two windows, and a viewer that
has ended. Skipped without Chromium."""

import contextlib
import http.server
import json
import sys
import threading
import unittest

from chromium import Chromium, find_chromium
from cli_run import main
from viewer_client import Client, Viewer

if find_chromium() is None:
    print("skipped: no Chromium is here")
    sys.exit(77)


BROWSER = Chromium()  # shared by all tests, because its start takes long
READY = "document.body.dataset.phase == 'done' && document.body.dataset.steers == 'true'"


def setUpModule():  # pylint: disable=invalid-name
    BROWSER.__enter__()


def tearDownModule():  # pylint: disable=invalid-name
    BROWSER.__exit__()


def window(page, width, height, ratio=1):
    page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=ratio, mobile=False)


def shown(page, selector):
    """Returns whether the element is visible."""
    return page.value(f"(() => {{ const e = document.querySelector({json.dumps(selector)}); "
                      "return e.checkVisibility() && e.getBoundingClientRect().height > 0; })()")


class Panel(unittest.TestCase):
    def setUp(self):
        window(BROWSER, 1280, 720)

    def test_settings_precede_readings_and_groups_stay_folded_after_a_reload(self):
        with Viewer(spp=1) as viewer, BROWSER.visit(viewer.address) as page:
            page.until(READY + " && document.querySelectorAll('#readings details').length > 1")
            names = page.value("[...document.querySelectorAll('#panel details')].map((d) => d.dataset.group)")
            for before, after in [("Light", "Scene"), ("Camera", "Camera path"), ("Scene", "Now"), ("Now", "Stages")]:
                self.assertLess(names.index(before), names.index(after), names)
            self.assertTrue(shown(page, "#setting-max_depth"))
            self.assertFalse(shown(page, "#setting-restir"))
            for group in ("Light", "Frames"):
                page.value(f"document.querySelector('#settings details[data-group={group}] summary').click()")
            self.assertFalse(shown(page, "#setting-max_depth"))
            self.assertTrue(shown(page, "#setting-restir"))
            page.go(viewer.address)
            page.until(READY + " && document.querySelectorAll('#readings details').length > 1")
            self.assertFalse(shown(page, "#setting-max_depth"))
            self.assertTrue(shown(page, "#setting-restir"))
            for group in ("Light", "Frames"):
                page.value(f"document.querySelector('#settings details[data-group={group}] summary').click()")
            self.assertEqual(page.errors, [])

    def test_on_a_phone_the_panel_is_closed_at_first_and_opens_by_a_button(self):
        with Viewer(size="", spp=1) as viewer, BROWSER.visit("about:blank") as page:
            window(page, 390, 844, 2)
            page.go(viewer.address)
            page.until(READY)
            page.value("localStorage.clear()")
            page.go(viewer.address)
            page.until(READY + " && document.body.dataset.flags.includes('--size')")
            self.assertTrue(shown(page, "#panel-open"))
            self.assertFalse(shown(page, "#panel"))
            page.call("Emulation.setTouchEmulationEnabled", enabled=True)
            for opens in (True, False):
                spot = page.value(f"(() => {{ const r = document.querySelector('#panel-{'open' if opens else 'close'}')"
                                  ".getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2, r.width]; })()")
                self.assertGreater(spot[2], 30)  # large enough for a finger
                page.click(spot[0], spot[1])
                page.until(f"document.querySelector('#panel').hidden == {json.dumps(not opens)}")
                if opens:
                    over = page.value("document.querySelector('#panel').getBoundingClientRect().right - innerWidth")
                    self.assertLessEqual(over, 0)
                    page.go(viewer.address)
                    page.until(READY)
                    self.assertTrue(shown(page, "#panel"))  # the page remembers this
            page.call("Emulation.setTouchEmulationEnabled", enabled=False)
            size = page.value("document.body.dataset.flags.match(/--size (\\d+)x(\\d+)/).slice(1).map(Number)")
            self.assertAlmostEqual(size[0] / size[1], 390 / 844, 2)
            self.assertLessEqual(size[0] * size[1], 1280 * 720)
            window(page, 600, 300)  # the phone is rotated
            page.until("document.body.dataset.flags.includes('--size 600x300') && document.body.dataset.phase == 'done'")
            page.value("localStorage.clear()")
            self.assertEqual(page.errors, [])


class TwoWindows(unittest.TestCase):
    def test_a_client_that_may_not_steer_gets_the_reason_and_control_can_be_handed_over(self):
        with Viewer(spp=1) as viewer, BROWSER.visit(viewer.address) as first, Chromium() as second:
            window(first, 1280, 720)
            first.until(READY)
            self.assertFalse(shown(first, "#control"))
            second.go(viewer.address)
            second.until("document.body.dataset.steers == 'false' && document.body.dataset.samples")
            self.assertTrue(shown(second, "#control"))
            second.drag("left", 100, 0)
            second.until("document.querySelector('#notice').textContent.includes('cannot orbit the view')")
            first.until("document.querySelector('#control-text').textContent.includes('would like to orbit the view')")
            second.key("Digit2", "2")
            first.until("document.querySelector('#control-text').textContent.includes('Max depth')")
            before = first.value("document.body.dataset.flags")
            first.value("[...document.querySelectorAll('#control button')].find((b) => b.textContent == 'hand over').click()")
            second.until("document.body.dataset.steers == 'true'")
            second.drag("left", 100, 0)
            second.until(f"document.body.dataset.flags != {json.dumps(before)}")
            self.assertFalse(shown(second, "#control"))
            self.assertEqual(first.errors + second.errors, [])


class Frame(unittest.TestCase):
    """The viewer in a frame of another site's page, as notebooks show it: localhost is another site than 127.0.0.1."""

    def setUp(self):
        window(BROWSER, 1280, 720)

    @contextlib.contextmanager
    def notebook(self, address):
        """The browser, which shows a page with a frame of this address."""
        text = f'<!DOCTYPE html><link rel="icon" href="data:,"><iframe src="{address}"></iframe>'.encode()

        class Notebook(http.server.BaseHTTPRequestHandler):
            def do_GET(self):  # pylint: disable=invalid-name
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(text)

            def log_message(self, *_):  # pylint: disable=arguments-differ
                pass

        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Notebook) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            try:
                with BROWSER.visit(f"http://localhost:{server.server_port}/") as page:
                    yield page
            finally:
                server.shutdown()

    def test_a_frame_shows_the_viewer_only_if_a_flag_lets_it(self):
        with Viewer("--embed", spp=1) as viewer, self.notebook(viewer.address) as page, Client(viewer) as client:
            client.text("people", lambda message: len(message["people"]) == 2)  # the frame's page has joined
            self.assertEqual(page.errors, [])
        with Viewer(spp=1) as viewer, self.notebook(viewer.address) as page, Client(viewer) as client:
            page.wait(lambda: page.value("true") and page.errors)
            self.assertIn("frame-ancestors", " ".join(page.errors))
            self.assertEqual(len(client.text("people")["people"]), 1)


class Ended(unittest.TestCase):
    def test_the_page_does_not_reconnect_to_a_viewer_that_has_ended(self):
        with Viewer(spp=1) as viewer, BROWSER.visit(viewer.address) as page:
            page.until(READY)
            self.assertEqual(viewer.end()[0], 0)
            page.until("document.body.dataset.gone == 'ended'")
            text = page.value("document.querySelector('#gone').innerText")
            self.assertIn("pertev view cornell-box", text)
            self.assertNotIn("comes back", text)
            self.assertFalse(shown(page, "#gone-again"))
            self.assertEqual(page.errors, [])  # the page makes no attempt

    def test_the_page_stops_reconnecting_to_a_killed_viewer_and_shows_how_to_start_one(self):
        with Viewer(spp=1) as viewer, BROWSER.visit(viewer.address) as page:
            page.until(READY)
            # The page waits for half a minute in total between its attempts, here an eighth of that.
            page.value("(() => { const later = setTimeout; window.setTimeout = (call, ms) => later(call, ms / 8); })()")
            viewer.process.kill()  # without a message
            page.until("document.body.dataset.gone == 'trying'")
            page.until("document.body.dataset.gone == 'lost'")
            text = page.value("document.querySelector('#gone').innerText")
            self.assertIn("pertev view cornell-box", text)
            self.assertNotIn("comes back", text)
            self.assertTrue(shown(page, "#gone-again"))


if __name__ == "__main__":
    main()
