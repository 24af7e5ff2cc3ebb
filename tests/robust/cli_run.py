"""Runs the program for the tests of its command line, in an empty folder and with a separate cache."""

import json
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
from read_exr import read_exr  # noqa: E402,F401

# Sanitized programs are slow and reserve terabytes of addresses.
SANITIZED = "--sanitized" in sys.argv
PROGRAM = os.path.abspath(next((argument for argument in sys.argv[1:] if not argument.startswith("-")), "build/bin/pertev"))
# Scripts with `--device NAME` render on that device (cli_integrators), the others on the CPU.
DEVICE = sys.argv[sys.argv.index("--device") + 1] if "--device" in sys.argv[:-1] else "cpu"
TONED = (".png", ".jpg", ".jpeg")
UNMETERED = ["--exposure", "0"]  # metering an exposure takes thirty times as long as one of these small pictures

PATIENCE_S = 300  # allows for a loaded machine; separate tests measure speed


def limit_addresses(gibibytes):
    """Limits memory (preexec_fn), so that an excessive allocation fails instead of filling the machine."""

    def limit():
        if not SANITIZED:
            resource.setrlimit(resource.RLIMIT_AS, (gibibytes << 30, gibibytes << 30))

    return limit


def document(name):
    with open(os.path.join(os.path.dirname(__file__), "../../docs", name), encoding="utf-8") as file:
        return file.read()


def metadata_keys():
    """Returns the keys pertev.NAME that documents list: those of settings, and those of a table in conventions.md."""
    table = document("conventions.md").partition("The metadata of an EXR have a key `pertev.NAME`")[2].partition("\n\nMattes")[0]
    names = {name for row in table.split("\n") if row.startswith("| `") for name in re.findall(r"`(\w+)`", row.split("|")[1])}
    settings = {flag.replace("-", "_") for flag in re.findall(r"^\| `--([a-z0-9-]+)`", document("settings.md"), re.MULTILINE)}
    assert len(names) > 20 and len(settings) > 100
    return {f"pertev.{name}" for name in names | settings}


KEYS = json.loads(document("json_keys.json"))
METADATA_KEYS = metadata_keys()


def refuse_unlisted_keys(line):
    """Tests that documents list every key of an event, and of the metadata in it. Other attributes of an EXR belong to the file."""
    unlisted = {key for key in line if key not in KEYS[line["event"]] and not key.startswith("cryptomatte/")} - METADATA_KEYS - {"event"}
    if line["event"] == "info" and "channels" in line:
        unlisted -= {"pixelAspectRatio", "screenWindowWidth"}
    if unlisted:
        raise ValueError(f"docs/ do not list {sorted(unlisted)} of {line['event']}")


class Outcome:
    def __init__(self, arguments, status, stdout, stderr):
        self.arguments, self.status = arguments, status
        self.stdout, self.stderr = stdout.decode("utf-8", "replace"), stderr.decode("utf-8", "replace")

    def events(self, kind=None):
        """Returns the JSON lines of stdout, all or those of one kind. Other output is an error."""
        lines = [json.loads(line, parse_constant=refuse_constant) for line in self.stdout.split("\n") if line]
        for line in lines:
            if "event" in line:
                refuse_unlisted_keys(line)
        return lines if kind is None else [line for line in lines if line["event"] == kind]

    def error(self):
        """Returns the error message: the text of stdout's last JSON object, or all of stderr."""
        if "--json" not in self.arguments:
            return self.stderr
        last = (self.events() or [{}])[-1]
        return last["text"] if last.get("event") == "error" and last["status"] == self.status else ""

    def __str__(self):
        return f"pertev {' '.join(self.arguments)}\nstatus {self.status}\n{self.stdout}{self.stderr}"


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON")


class CliTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = os.path.join(scratch.name, "work")
        os.mkdir(self.folder)
        self.environment = dict(os.environ, XDG_CACHE_HOME=os.path.join(scratch.name, "cache"), TERM="xterm")
        if DEVICE == "cpu":
            self.environment["CUDA_VISIBLE_DEVICES"] = ""

    def path(self, name):
        return os.path.join(self.folder, name)

    def files(self):
        return sorted(os.listdir(self.folder))

    def run_pertev(self, *arguments, **options):
        options = {"cwd": self.folder, "env": self.environment, "stdin": subprocess.DEVNULL, "timeout": PATIENCE_S,
                   "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
        arguments = [str(argument) for argument in arguments]
        done = subprocess.run([PROGRAM, *arguments], check=False, **options)
        outcome = Outcome(arguments, done.returncode, done.stdout or b"", done.stderr or b"")
        for finding in ["Sanitizer", "runtime error"]:
            self.assertNotIn(finding, outcome.stderr, outcome)
        return outcome

    def succeed(self, *arguments, **options):
        outcome = self.run_pertev(*arguments, **options)
        self.assertEqual(outcome.status, 0, outcome)
        return outcome

    def remarks(self, *arguments, about=None, **options):
        """Returns the notices and warnings of a successful command as JSON: all, or those about the setting `about`."""
        events = self.succeed(*arguments, "--json", **options).events()
        return [event for event in events if event["event"] in ("notice", "warning")
                and (about is None or about == event.get("setting") or about in event.get("settings", {}))]

    def refuse(self, status, *arguments, says=(), **options):
        """Tests that a command ends with this status, prints each of `says` (with --json in an object), and does not
        change the folder."""
        before = self.files()
        outcome = self.run_pertev(*arguments, **options)
        self.assertEqual(outcome.status, status, outcome)
        for text in says:
            self.assertIn(text, outcome.error(), outcome)
        self.assertNotIn("internal error of pertev", outcome.error(), outcome)
        self.assertNotEqual(outcome.error().strip(), "", outcome)
        if "--json" in outcome.arguments:
            self.assertEqual(outcome.stderr, "", outcome)
        self.assertEqual(self.files(), before, outcome)
        return outcome

    def stderr_on_a_terminal(self, arguments):
        """Returns the text that the program writes to a terminal as stderr. The program must succeed."""
        leader, follower = pty.openpty()
        listener, said = listen_to(leader)
        outcome = self.run_pertev(*arguments, stderr=follower)
        os.close(follower)
        listener.join()
        self.assertEqual(outcome.status, 0, outcome)
        return b"".join(said).decode()

    def wait_while(self, program, is_listening):
        """Waits until the running program handles Ctrl-C, has received one, or has ended."""
        while program.poll() is None:
            with open(f"/proc/{program.pid}/status", encoding="ascii") as file:
                caught = int(re.search(r"SigCgt:\s*([0-9a-f]+)", file.read()).group(1), 16)
            if bool(caught & 1 << (signal.SIGINT - 1)) != is_listening:
                return
            time.sleep(0.01)

    def render(self, *arguments, scene="cornell-box", size="16x16", spp=1, output="picture.png"):
        """Renders a small picture on DEVICE, without metering unless `arguments` set an exposure. Returns the last event."""
        fixed = UNMETERED if output.lower().endswith(TONED) and "--exposure" not in arguments else []
        outcome = self.succeed("render", scene, "-o", output, "--size", size, "--spp", spp, "--device", DEVICE, "--json",
                               *fixed, *arguments)
        return outcome.events("done")[0]

    def info(self, name):
        return self.succeed("info", name, "--json").events("info")[0]


def listen_to(leader):
    """Reads the output of a terminal (the leader of a pty, which it closes) until all writers have closed it. Returns
    a thread to join, and the pieces read so far."""
    said = []

    def listen():
        try:
            while chunk := os.read(leader, 65536):
                said.append(chunk)
        except OSError:
            pass  # on Linux the other side is closed
        os.close(leader)

    listener = threading.Thread(target=listen)
    listener.start()
    return listener, said


def as_flag(value):
    """Returns a value of info's JSON in a flag's form: a vector's numbers are separated by commas."""
    return ",".join(str(number) for number in value) if isinstance(value, list) else str(value)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


# A floor of 2 by 2 m at y = 0 around the origin.
FLOOR = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n"


def gltf_with_cameras():
    """Two cameras in front of a square: "wide" is 2:1, "tall" 1:2."""
    def camera(name, aspect):
        return {"name": name, "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1, "aspectRatio": aspect}}

    positions = "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"  # (-1,-1,0) (1,-1,0) (0,1,0)
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]}, {"camera": 1, "translation": [0, 0, 8]}],
        "cameras": [camera("wide", 2.0), camera("tall", 0.5)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0],
                       "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + positions}]})


def read_png(path):
    """Reads a PNG file and returns the result of decode_png."""
    with open(path, "rb") as file:
        return decode_png(file.read())


def decode_png(data):
    """Returns [(r, g, b) of each pixel], row by row, of an RGB picture of 8 or 16 bits."""
    packed, at = b"", 8
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height, depth, colours = struct.unpack_from(">IIBB", data, at + 8)
            assert depth in (8, 16) and colours == 2, "RGB"
        packed += data[at + 8 : at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    each = 3 * depth // 8  # bytes of a pixel
    raw, pixels, above = zlib.decompress(packed), [], bytearray(each * width)
    for y in range(height):
        start = y * (each * width + 1)
        kind, row = raw[start], bytearray(raw[start + 1 : start + 1 + each * width])
        for i in range(each * width):
            left, corner = (row[i - each], above[i - each]) if i >= each else (0, 0)
            guess = left + above[i] - corner
            paeth = min((left, above[i], corner), key=lambda value: abs(guess - value))
            row[i] = (row[i] + [0, left, above[i], (left + above[i]) // 2, paeth][kind]) & 255
        values = struct.unpack(f">{3 * width}{'B' if depth == 8 else 'H'}", row)
        pixels += [values[i : i + 3] for i in range(0, 3 * width, 3)]
        above = row
    return pixels


def main():
    """Runs the tests of the calling file. The program's path, --sanitized and --device are read here; the other arguments go to unittest."""
    ours = {"--sanitized", "--device", *([DEVICE] if "--device" in sys.argv else [])}
    rest = [argument for argument in sys.argv[1:] if argument not in ours and os.path.abspath(argument) != PROGRAM]
    unittest.main(argv=[sys.argv[0], *rest])
