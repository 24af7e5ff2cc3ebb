"""Reads EXR files that pertev wrote, with Python's library alone."""

import itertools
import struct
import zlib


def read_exr(path):
    """Returns {channel: [[value of each column] of each row]} and the size of an EXR that pertev wrote (scanlines, ZIP)."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == struct.pack("<II", 20000630, 2), "one part of lines"
    at, header = 8, {}
    while data[at]:
        name_end = data.index(0, at)
        kind_end = data.index(0, name_end + 1)
        size = struct.unpack_from("<i", data, kind_end + 1)[0]
        header[data[at:name_end].decode()] = data[kind_end + 5 : kind_end + 5 + size]
        at = kind_end + 5 + size
    assert header["compression"] == b"\3", "ZIP"
    low_x, low_y, high_x, high_y = struct.unpack("<4i", header["dataWindow"])
    width, height = high_x - low_x + 1, high_y - low_y + 1
    channels, rest = [], header["channels"]
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        channels.append((name.decode(), {0: "I", 1: "e", 2: "f"}[struct.unpack_from("<i", rest)[0]]))
        rest = rest[16:]
    rows = {name: [None] * height for name, _ in channels}
    blocks = (height + 15) // 16
    for offset in struct.unpack_from(f"<{blocks}Q", data, at + 1):
        first, size = struct.unpack_from("<2i", data, offset)
        lines = min(16, height - (first - low_y))
        block = data[offset + 8 : offset + 8 + size]
        if size < sum(struct.calcsize(code) for _, code in channels) * width * lines:
            block = unpack_zip(zlib.decompress(block))
        position = 0
        for line in range(first - low_y, first - low_y + lines):
            for name, code in channels:
                rows[name][line] = struct.unpack_from(f"<{width}{code}", block, position)
                position += struct.calcsize(code) * width
    return width, height, rows


def unpack_zip(packed):
    """Inverts OpenEXR's differences between bytes, then its split into even and odd bytes."""
    values = bytes(itertools.accumulate(packed, lambda last, byte: last + byte - 128 & 255))
    half, out = (len(values) + 1) // 2, bytearray(len(values))
    out[0::2], out[1::2] = values[:half], values[half:]
    return bytes(out)
