"""A client of `pertev view` for tests, over plain sockets: HTTP, WebSocket, and the viewer as a process."""

import base64
import hashlib
import json
import os
import re
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import urllib.parse

from cli_run import PROGRAM

PATIENCE_S = 60
HEADER = struct.Struct("<BBHIIIHHHHII")


class Viewer:
    """A viewer of a small picture on its own port, which ends with the block."""

    def __init__(self, *arguments, scene="cornell-box", size="64x48", spp=4, device="cpu", desktop="", folder=None):
        """`desktop`: a folder with a desktop's programs; it may then open a browser. `size`: empty: the window's shape.
        `folder`: it runs there, not in one of its own."""
        self.device, self.desktop, self.folder = device, desktop, folder
        self.arguments = ["view", scene, *(["--size", size] if size else []), "--spp", str(spp), "--port", "0", "--device", device, *arguments]
        if not desktop:
            self.arguments.append("--no-browser")

    def __enter__(self):
        self.scratch = tempfile.TemporaryDirectory()
        environment = dict(os.environ, XDG_CACHE_HOME=self.scratch.name, TERM="xterm")
        if self.device == "cpu":
            environment["CUDA_VISIBLE_DEVICES"] = ""
        environment.pop("DISPLAY", None)
        environment.pop("WAYLAND_DISPLAY", None)
        if self.desktop:
            environment.update(DISPLAY=":0", PATH=f"{self.desktop}:{environment['PATH']}")
        self.process = subprocess.Popen([PROGRAM, *self.arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        env=environment, cwd=self.folder or self.scratch.name)
        self.address = ""
        while not self.address:
            line = self.process.stdout.readline().decode()
            if not line:
                raise RuntimeError(f"the viewer ended: {self.process.stderr.read().decode()}")
            found = re.search(r"http://\S+", line)
            self.address = found.group(0) if found else ""
        parts = urllib.parse.urlsplit(self.address)
        self.host, self.port = parts.hostname, parts.port
        self.token = urllib.parse.parse_qs(parts.query).get("token", [""])[0]
        self.cookie = ""
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
        self.scratch.cleanup()

    def end(self, how=signal.SIGINT):
        """Ends the viewer like Ctrl-C. Returns the status and the time that it took."""
        began = time.monotonic()
        self.process.send_signal(how)
        status = self.process.wait(PATIENCE_S)
        return status, time.monotonic() - began

    def resident_bytes(self):
        with open(f"/proc/{self.process.pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")

    def connect(self):
        made = socket.create_connection((self.host, self.port), PATIENCE_S)
        made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return made

    def own_headers(self):
        return {"Host": f"{self.host}:{self.port}", "Cookie": self.let_in()}

    def let_in(self):
        """Exchanges the token for the cookie and returns it."""
        if not self.cookie:
            status, headers, _ = self.get(f"/?token={self.token}", {"Host": f"{self.host}:{self.port}"})
            assert status == 200, status
            self.cookie = headers["set-cookie"].split(";")[0]
        return self.cookie

    def send_raw(self, data):
        """Returns the viewer's answer to these bytes until the connection closes."""
        with self.connect() as made:
            try:
                made.sendall(data)
                made.shutdown(socket.SHUT_WR)
                return read_all(made)
            except OSError:
                return b""

    def get(self, target, headers=None, method="GET"):
        """Returns status, headers by lower-case names, and body."""
        lines = [f"{method} {target} HTTP/1.1"]
        given = self.own_headers() if headers is None else headers
        lines += [f"{name}: {value}" for name, value in given.items()] + ["Connection: close", "", ""]
        with self.connect() as made:
            made.sendall("\r\n".join(lines).encode())
            answer = read_all(made)
        head, _, body = answer.partition(b"\r\n\r\n")
        first, *rest = head.decode().split("\r\n")
        found = {name.lower(): value.strip() for name, _, value in (line.partition(":") for line in rest)}
        return int(first.split()[1]), found, body


def read_all(made):
    data = b""
    while chunk := made.recv(65536):
        data += chunk
    return data


class Tunnel:
    """A relay between a page and the viewer, like ssh -L, on its own port. It can be disconnected, and its rate to the
    page can be limited. A Client accepts it instead of the viewer."""

    def __init__(self, viewer, bytes_per_second=0):
        self.viewer, self.ends, self.is_cut, self.bytes_per_second = viewer, [], False, bytes_per_second
        self.host = "127.0.0.1"
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.server.shutdown(socket.SHUT_RDWR)
        self.server.close()
        self.cut()

    def accept(self):
        try:
            while True:
                near, _ = self.server.accept()
                if self.is_cut:
                    near.close()
                    continue
                far = self.viewer.connect()
                self.ends += [near, far]
                for here, there in [(near, far), (far, near)]:
                    threading.Thread(target=self.pass_on, args=(here, there), daemon=True).start()
        except OSError:
            pass  # the socket was closed

    def pass_on(self, here, there):
        try:
            here.settimeout(None)
            is_slow = self.bytes_per_second > 0 and there in self.ends[::2]
            while chunk := here.recv(1024 if is_slow else 65536):
                if is_slow:
                    time.sleep(len(chunk) / self.bytes_per_second)
                there.sendall(chunk)
        except OSError:
            pass
        for end in (here, there):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def connect(self):
        return socket.create_connection((self.host, self.port), PATIENCE_S)

    def own_headers(self):
        return {"Host": f"{self.host}:{self.port}", "Cookie": self.viewer.let_in()}

    def cut(self):
        self.is_cut = True
        for end in self.ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def mend(self):
        self.is_cut = False


class Closed(Exception):
    """The other side closed the WebSocket, with a code and a reason."""


class WebSocket:
    """The client's side of a WebSocket."""

    def __init__(self, made, path, headers):
        self.socket, self.buffer = made, b""
        secret = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {path} HTTP/1.1", "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
                 f"Sec-WebSocket-Key: {secret}"]
        lines += [f"{name}: {value}" for name, value in headers.items()] + ["", ""]
        self.socket.sendall("\r\n".join(lines).encode())
        while b"\r\n\r\n" not in self.buffer:
            chunk = self.socket.recv(65536)
            if not chunk:
                break
            self.buffer += chunk
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else 0
        proof = base64.b64encode(hashlib.sha1((secret + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest())
        assert self.status != 101 or proof in head, head

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send_frame(self, opcode, data):
        head = bytes([0x80 | opcode])
        if len(data) < 126:
            head += bytes([0x80 | len(data)])
        elif len(data) < 65536:
            head += bytes([0x80 | 126]) + struct.pack(">H", len(data))
        else:
            head += bytes([0x80 | 127]) + struct.pack(">Q", len(data))
        mask = os.urandom(4)
        stretched = (mask * (len(data) // 4 + 1))[: len(data)]
        masked = (int.from_bytes(data, "big") ^ int.from_bytes(stretched, "big")).to_bytes(len(data), "big")
        self.socket.sendall(head + mask + masked)

    def say_text(self, text):
        self.send_frame(1, text.encode())

    def say(self, **message):
        self.say_text(json.dumps(message))

    def take(self, count):
        while len(self.buffer) < count:
            chunk = self.socket.recv(1 << 20)
            if not chunk:
                raise Closed(0, "without a word")
            self.buffer += chunk
        data, self.buffer = self.buffer[:count], self.buffer[count:]
        return data

    def receive_data(self, timeout=PATIENCE_S):
        """Returns kind and bytes of the next message. Kind 1 is text, 2 is binary."""
        self.socket.settimeout(timeout)
        while True:
            first, size = self.take(2)
            assert first & 0x80 and not size & 0x80, "one whole frame, not masked"
            if size == 126:
                size = struct.unpack(">H", self.take(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.take(8))[0]
            data, opcode = self.take(size), first & 15
            if opcode == 8:
                raise Closed(struct.unpack(">H", data[:2])[0] if data else 0, data[2:].decode())
            if opcode == 9:
                self.send_frame(10, data)
            elif opcode in (1, 2):
                return opcode, data


class Client(WebSocket):
    """A client of the viewer. It acknowledges pictures like a page unless that is turned off."""

    def __init__(self, viewer, key="test", says_hello=True, headers=None, acknowledges=True):
        self.acknowledges, self.input = acknowledges, 0
        given = dict(viewer.own_headers(), Origin=f"http://{viewer.host}:{viewer.port}") if headers is None else headers
        super().__init__(viewer.connect(), "/socket", given)
        if self.status == 101 and says_hello:
            self.say(type="hello", key=key)

    def steer(self, **message):
        """Sends an input and returns its number."""
        self.input += 1
        self.say(n=self.input, **message)
        return self.input

    def set(self, name, value):
        return self.steer(type="set", name=name, value=value)

    def receive(self, timeout=PATIENCE_S):
        """Returns the next message: a dictionary, or (header, bytes)."""
        kind, data = self.receive_data(timeout)
        if kind == 1:
            return json.loads(data)
        names = ["version", "kind", "flags", "frame", "input", "samples", "width", "height", "full_width",
                 "full_height", "offset", "total"]
        header = dict(zip(names, HEADER.unpack(data[:32])))
        if self.acknowledges:
            self.say(type="ack", frame=header["frame"], ms=1)
        return header, data[32:]

    def until(self, wanted, timeout=PATIENCE_S):
        """Returns the first message that `wanted` accepts."""
        end = time.monotonic() + timeout
        while True:
            message = self.receive(max(end - time.monotonic(), 0.01))
            if wanted(message):
                return message

    def text(self, kind, wanted=lambda message: True, timeout=PATIENCE_S):
        return self.until(lambda m: isinstance(m, dict) and m["type"] == kind and wanted(m), timeout)

    def picture(self, wanted=lambda header: True, timeout=PATIENCE_S):
        return self.until(lambda m: isinstance(m, tuple) and wanted(m[0]), timeout)

    def done(self, wanted=lambda state: True, timeout=PATIENCE_S):
        """Returns the state once all samples are complete."""
        return self.text("state", lambda s: s["phase"] == "done" and wanted(s), timeout)

    def png(self):
        """Returns the bytes of the still picture, joined from its pieces."""
        whole = b""
        while True:
            header, data = self.picture(lambda h: h["kind"] == 2)
            whole = data if header["offset"] == 0 else whole + data
            if len(whole) == header["total"]:
                return whole

    def close_reason(self, timeout=PATIENCE_S):
        """Waits until the other side closes."""
        try:
            self.until(lambda m: False, timeout)
        except Closed as closed:
            return closed.args
        except (ConnectionError, TimeoutError) as fault:
            return (0, str(fault))
