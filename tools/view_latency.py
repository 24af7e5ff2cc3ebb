#!/usr/bin/env python3
"""How soon `pertev view` shows a requested picture: tools/view_latency.py PERTEV SCENE [-o MEASUREMENT.json] [-- flags of
pertev view], with a GPU by default.

Steers a viewer 60 times a second through a WebSocket on this machine, decodes each picture with libjpeg, as a browser
would, and acknowledges it then. For each encoder: milliseconds from an input to the first decoded picture that shows it
(by the number of the input that the picture's header has), and what of that is beyond the frame itself (its stages, as
the panel has them): medians and 95th percentiles. Before that, the JPEG of a still picture is held to its PNG. Exits 1
where colours differ or more than `--most` milliseconds (50) are beyond the frame, at the median.

With --rest nobody steers: seconds from the page's hello, and from a setting, to the first picture of each size."""

import argparse
import ctypes
import math
import os
import pathlib
import sys
import threading
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "robust"))
from cli_run import decode_png  # pylint: disable=wrong-import-position
from measurement import write_measurement  # pylint: disable=wrong-import-position
from viewer_client import Client, Viewer  # pylint: disable=wrong-import-position

# libjpeg's structures are read by it alone: their sizes, and where the one for errors is named (first), is all we need.
LIBRARIES = {"libjpeg.so.62": (62, 632), "libjpeg.so.8": (80, 656)}

COLUMNS = [("encoder", "--jpeg", None), ("packed_by", "packed by", None), ("size", "size of most pictures", None), ("inputs", "inputs", None),
           ("off", "JPEG off by, of 255", None), ("mean_off", "its mean by, of 255", None), ("pictures", "pictures here", "1/s"),
           ("rendered", "rendered", "1/s"), ("kib", "a picture", "KiB"), ("frame", "frame", "ms"), ("pack", "pack", "ms"), ("decode", "decode", "ms"),
           ("wait", "input to decoded picture", "ms"), ("wait_95", "95th percentile of it", "ms"), ("beyond", "beyond the frame", "ms"),
           ("beyond_95", "95th percentile beyond", "ms")]


class Jpeg:
    """libjpeg, from beside the program (as tools/make_portable.sh puts it) or from the system. A file that is none ends
    this program with libjpeg's message."""

    def __init__(self, program):
        for name, (version, size) in LIBRARIES.items():
            for place in [pathlib.Path(program).parent.parent / "lib" / name, name]:
                try:
                    self.library = ctypes.CDLL(str(place))
                except OSError:
                    continue
                self.version, self.size = version, size
                return
        sys.exit(f"none of {', '.join(LIBRARIES)} is here")

    def decode(self, data, width, height):
        """RGB bytes."""
        call, errors, info = self.library, ctypes.create_string_buffer(1024), ctypes.create_string_buffer(4096)
        call.jpeg_std_error.restype = ctypes.c_void_p
        ctypes.c_void_p.from_buffer(info).value = call.jpeg_std_error(errors)
        call.jpeg_CreateDecompress(info, self.version, ctypes.c_size_t(self.size))
        call.jpeg_mem_src(info, data, ctypes.c_ulong(len(data)))
        assert call.jpeg_read_header(info, 1) == 1
        assert call.jpeg_start_decompress(info) == 1
        pixels = ctypes.create_string_buffer(3 * width * height)
        start = ctypes.addressof(pixels)
        rows = (ctypes.c_void_p * height)(*[start + 3 * width * y for y in range(height)])
        done = 0
        while done < height:
            count = call.jpeg_read_scanlines(info, ctypes.byref(rows, done * ctypes.sizeof(ctypes.c_void_p)), height - done)
            assert count > 0, "fewer rows than the header says"
            done += count
        assert call.jpeg_finish_decompress(info) == 1, "more rows than the header says"
        call.jpeg_destroy_decompress(info)
        return pixels.raw


def rows_of(state):
    return {(group, label): value for group, label, value in state["rows"]}


def off_by(viewer, jpeg):
    """The largest mean absolute difference of a channel between the still picture's JPEG and its PNG, and the largest
    absolute mean difference; both on a scale of 255."""
    with Client(viewer) as client:
        header, data = client.picture(lambda h: h["kind"] == 1 and h["flags"] & 1)
        exact = decode_png(client.png())
        count = header["width"] * header["height"]
        assert count == len(exact), "the JPEG was made smaller"
        pixels = jpeg.decode(data, header["width"], header["height"])
        off = [[a - b[c] for a, b in zip(pixels[c::3], exact)] for c in range(3)]
        return max(sum(map(abs, channel)) / count for channel in off), max(abs(sum(channel)) / count for channel in off)


class Steered:
    """Times and sizes of the pictures that arrive while a person steers for some seconds."""

    def __init__(self, viewer, jpeg, seconds):
        self.waits, self.frame_ms, self.pack_ms, self.decode_ms = [], [], [], []
        self.bytes, self.sizes, self.pictures, self.encoder, self.rate = [], {}, 0, "", []
        with Client(viewer, acknowledges=False) as client:
            client.picture(lambda h: h["kind"] == 1)
            client.acknowledges = False
            sent, going = {}, True

            def steer():
                k = 0
                while going:
                    sent[client.input + 1] = time.monotonic()
                    client.steer(type="look", dx=0.003 if k // 120 % 2 == 0 else -0.003, dy=0)
                    k += 1
                    time.sleep(1 / 60)

            hand = threading.Thread(target=steer)
            hand.start()
            try:
                self.watch(client, jpeg, sent, seconds)
            finally:
                going = False
                hand.join()

    def watch(self, client, jpeg, sent, seconds):
        begin, shown = time.monotonic(), 0
        while time.monotonic() < begin + seconds + 1:
            message = client.receive()
            is_warm = time.monotonic() > begin + 1
            if isinstance(message, dict):
                if message["type"] == "state" and message["phase"] == "moving" and is_warm:
                    self.take_state(rows_of(message))
                continue
            header, data = message
            started = time.monotonic()
            if header["kind"] == 1:
                jpeg.decode(data, header["width"], header["height"])
            now = time.monotonic()
            client.say(type="ack", frame=header["frame"], ms=1e3 * (now - started))
            if header["kind"] == 1 and is_warm:
                self.waits += [1e3 * (now - sent[n]) for n in range(shown + 1, header["input"] + 1) if n in sent]
                self.decode_ms.append(1e3 * (now - started))
                self.bytes.append(len(data))
                self.pictures += 1
                size = header["width"], header["height"]
                self.sizes[size] = self.sizes.get(size, 0) + 1
            shown = max(shown, header["input"])

    def take_state(self, rows):
        stages = {label: value for (group, label), value in rows.items() if group == "Stages"}
        self.encoder = stages.pop("packed by", self.encoder)
        self.pack_ms.append(float(stages.pop("pack").split()[0]))
        self.frame_ms.append(sum(float(value.split()[0]) for value in stages.values()))
        if ("Frames", "rendered") in rows:
            self.rate.append(float(rows["Frames", "rendered"].split()[0]))


def seconds_to_sizes(client, shape, number=0):
    """Seconds from now until the first picture of each size that shows the input `number`, up to the whole picture."""
    start, seconds = time.monotonic(), {}
    while shape not in seconds:
        message = client.receive()
        if isinstance(message, tuple) and message[0]["kind"] == 1 and message[0]["input"] >= number:
            seconds.setdefault(f"{message[0]['width']}x{message[0]['height']}", time.monotonic() - start)
    return seconds


def measure_rest(given, flags):
    """Writes a row for the page's hello and one for a setting, with a column for each size."""
    with Viewer(*flags, scene=given.scene, size=given.size, spp=64, device=given.device) as viewer, Client(viewer) as client:
        hello = seconds_to_sizes(client, given.size)
        setting = seconds_to_sizes(client, given.size, client.set("max_depth", 4))
    sizes = sorted(hello.keys() | setting.keys(), key=lambda size: int(size.split("x")[0]))
    rows = [[since, *(float(f"{of[size]:.2g}") if size in of else None for size in sizes)] for since, of in (("the page's hello", hello), ("a setting", setting))]
    print(*sizes, sep="\t")
    for row in rows:
        print(*row, sep="\t")
    if given.output:
        columns = [("since", "since", None), *((size, size, "s") for size in sizes)]
        write_measurement(given.output, given.pertev, "The viewer at rest", columns, rows, given.device, os.cpu_count(), table="sizes")


def share(values, part):
    return sorted(values)[min(int(part * len(values)), len(values) - 1)] if values else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("pertev")
    parser.add_argument("scene")
    parser.add_argument("--device", default="cuda")
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--most", type=float, default=50, help="milliseconds beyond the frame, at the median")
    parser.add_argument("-o", "--output", metavar="MEASUREMENT.json")
    parser.add_argument("--rest", action="store_true", help="measure a picture at rest")
    own = sys.argv[1:]
    more = own[own.index("--") + 1 :] if "--" in own else []
    given = parser.parse_args(own[: len(own) - len(more) - 1] if "--" in own else own)
    if os.path.exists(given.scene):  # the viewer runs in a folder of its own
        given.scene = os.path.abspath(given.scene)
    if given.rest:
        measure_rest(given, more)
        return
    jpeg, is_good, rows = Jpeg(os.path.abspath(given.pertev)), True, []
    for encoder in ["auto", "cpu"] if given.device != "cpu" else ["cpu"]:
        flags = ["--jpeg", encoder, *more]
        with Viewer("--jpeg", encoder, size="320x180", spp=64, device=given.device) as viewer:
            mean, shift = off_by(viewer, jpeg)
        with Viewer(*flags, scene=given.scene, size=given.size, spp=100000, device=given.device) as viewer:
            made = Steered(viewer, jpeg, given.seconds)
        frame = share(made.frame_ms, 0.5)
        beyond = [wait - frame for wait in made.waits]
        row = [encoder, made.encoder, "x".join(map(str, max(made.sizes, key=made.sizes.get))), len(beyond), mean, shift, made.pictures / given.seconds,
               share(made.rate, 0.5), share(made.bytes, 0.5) / 1024, frame, share(made.pack_ms, 0.5), share(made.decode_ms, 0.5),
               share(made.waits, 0.5), share(made.waits, 0.95), share(beyond, 0.5), share(beyond, 0.95)]
        rows.append([cell if not isinstance(cell, float) else None if math.isnan(cell) else float(f"{cell:.4g}") for cell in row])
        print("\n".join(f"{title}: {cell}{' ' * bool(unit)}{unit or ''}" for (_, title, unit), cell in zip(COLUMNS, rows[-1])), flush=True)
        is_good = is_good and mean < 5 and shift < 1 and share(beyond, 0.5) <= given.most
    if given.output:
        write_measurement(given.output, given.pertev, "The viewer, steered", COLUMNS, rows, given.device, os.cpu_count(), table="latency")
    sys.exit(0 if is_good else 1)


if __name__ == "__main__":
    main()
