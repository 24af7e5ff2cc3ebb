"""A real headless Chromium, driven over its DevTools protocol with only the standard library."""

import base64
import contextlib
import json
import os
import shutil
import socket
import subprocess
import tempfile
import time

from viewer_client import PATIENCE_S, WebSocket

CONTROL = 2  # a modifier
NAMES = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]


def find_chromium():
    """Returns Chromium's path, or None."""
    return next((path for path in map(shutil.which, NAMES) if path), None)


class Chromium:
    """One window, which keeps the errors of its console."""

    def __init__(self, width=1280, height=720):
        self.size, self.number, self.errors, self.events = (width, height), 0, [], []

    def __enter__(self):
        self.scratch = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.downloads = os.path.join(self.scratch.name, "downloads")
        os.mkdir(self.downloads)
        flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                 "--disable-extensions", "--disable-background-networking", "--disable-component-update",
                 "--disable-sync", "--hide-scrollbars", "--mute-audio", "--remote-debugging-port=0",
                 f"--user-data-dir={self.scratch.name}/profile", f"--window-size={self.size[0]},{self.size[1]}",
                 "about:blank"]
        self.process = subprocess.Popen([find_chromium(), *flags], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        env=dict(os.environ, HOME=self.scratch.name))
        port = int(self.wait(self.devtools_port).split()[0])
        page = next(target for target in self.wait(lambda: ask(port, "/json/list")) if target["type"] == "page")
        path = "/" + page["webSocketDebuggerUrl"].split("/", 3)[3]
        made = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
        self.socket = WebSocket(made, path, {"Host": f"127.0.0.1:{port}"})
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=self.size[0], height=self.size[1], deviceScaleFactor=1,
                  mobile=False)
        self.call("Emulation.setFocusEmulationEnabled", enabled=True)
        self.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=self.downloads)
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.socket.socket.close()
        self.scratch.cleanup()

    def devtools_port(self):
        path = os.path.join(self.scratch.name, "profile", "DevToolsActivePort")
        if not os.path.exists(path):
            return ""
        with open(path, encoding="ascii") as file:
            return file.read()

    def wait(self, wanted, patience=PATIENCE_S):
        """Waits for a value of wanted() that is not empty, and returns it."""
        end = time.monotonic() + patience
        while time.monotonic() < end:
            try:
                if value := wanted():
                    return value
            except (OSError, RuntimeError):
                pass  # the page or the browser does not exist yet
            time.sleep(0.03)
        raise TimeoutError("what was waited for did not come")

    def call(self, method, **parameters):
        self.number += 1
        self.socket.say(id=self.number, method=method, params=parameters)
        while True:
            message = json.loads(self.socket.receive_data()[1])
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.hear(message)

    def hear(self, event):
        method, of = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.errors.append(of["exceptionDetails"]["exception"].get("description", str(of)))
        elif method == "Runtime.consoleAPICalled" and of["type"] in ("error", "warning"):
            self.errors.append(str([argument.get("value") for argument in of["args"]]))
        elif method == "Log.entryAdded" and of["entry"]["level"] in ("error", "warning"):
            self.errors.append(f"{of['entry']['text']} {of['entry'].get('url', '')}")

    def go(self, address):
        self.call("Page.navigate", url=address)

    @contextlib.contextmanager
    def visit(self, address):
        """Exists within the block. Earlier errors do not count."""
        self.errors.clear()
        self.go(address)
        yield self
        self.leave()

    def leave(self):
        self.go("about:blank")

    def value(self, script):
        """Runs a script in the page and returns its value. A promise is awaited."""
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def until(self, script, patience=PATIENCE_S):
        return self.wait(lambda: self.value(script), patience)

    def key(self, code, key="", held_s=0.0, down=True, up=True, modifiers=0):
        event = {"code": code, "key": key or code, "modifiers": modifiers}
        if down:
            self.call("Input.dispatchKeyEvent", type="rawKeyDown", **event)
            time.sleep(held_s)
        if up:
            self.call("Input.dispatchKeyEvent", type="keyUp", **event)

    def mouse(self, kind, x, y, button="none", **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button,
                  buttons={"none": 0, "left": 1, "right": 2, "middle": 4}[button], **more)

    def drag(self, button, dx, dy, x=400, y=300):
        self.mouse("mousePressed", x, y, button, clickCount=1)
        for step in range(1, 6):
            self.mouse("mouseMoved", x + dx * step / 5, y + dy * step / 5, button)
            time.sleep(0.03)
        self.mouse("mouseReleased", x + dx, y + dy, button, clickCount=1)

    def click(self, x, y, count=1, modifiers=0):
        for number in range(1, count + 1):
            self.mouse("mousePressed", x, y, "left", clickCount=number, modifiers=modifiers)
            self.mouse("mouseReleased", x, y, "left", clickCount=number, modifiers=modifiers)

    def touch(self, kind, *points):
        self.call("Input.dispatchTouchEvent", type=kind,
                  touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])

    def clipboard(self):
        """Returns the element's text."""
        self.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        return self.value("navigator.clipboard.readText()")

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))


def ask(port, path):
    """Returns the browser's answer to an HTTP request, parsed as JSON."""
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as made:
        made.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n".encode())
        made.settimeout(5)
        data = b""
        while True:
            head, _, body = data.partition(b"\r\n\r\n")
            sizes = [line.split(b":")[1] for line in head.split(b"\r\n") if line.lower().startswith(b"content-length")]
            if sizes and len(body) >= int(sizes[0]):
                return json.loads(body)
            chunk = made.recv(65536)
            if not chunk:
                raise OSError("the browser said nothing")
            data += chunk
