#!/usr/bin/env python3
"""Writes the sky that the figures of tools/measure.py are measured under, as an EXR file of 256 x 128 pixels:
  python3 tools/make_sky.py sky.exr

The sky is blue above and pale at the horizon, and a broad warm sun stands at the upper left front. A white surface
under it sends about 1.5 W/(sr m2). Up to November 2026 it was the sky that a scene without light got."""

import math
import struct
import sys

WIDTH, HEIGHT = 256, 128
ZENITH, HORIZON, GROUND = (0.32, 0.46, 0.72), (0.84, 0.89, 0.95), (0.30, 0.28, 0.26)
SUN_COLOUR = (1.0, 0.92, 0.78)
SUN = (-0.45, 0.72, 0.53)


def sky(x: float, y: float, z: float) -> list[float]:
    """The radiance from a unit direction, W/(sr m2)."""
    up = max(y, 0.0)
    towards, share = (ZENITH, up * (2 - up)) if y >= 0 else (GROUND, min(-8 * y, 1.0))
    size = math.hypot(*SUN)
    lobe = max((x * SUN[0] + y * SUN[1] + z * SUN[2]) / size, 0.0) ** 64
    return [h + share * (t - h) + 32 * lobe * s for h, t, s in zip(HORIZON, towards, SUN_COLOUR)]


def rows():
    for row in range(HEIGHT):
        theta = math.pi * (row + 0.5) / HEIGHT
        line = []
        for column in range(WIDTH):
            phi = 2 * math.pi * ((column + 0.5) / WIDTH - 0.5)
            line.append(sky(math.sin(theta) * math.sin(phi), math.cos(theta), -math.sin(theta) * math.cos(phi)))
        yield line


def attribute(name: str, kind: str, value: bytes) -> bytes:
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def exr(lines: list) -> bytes:
    """An EXR file of 32-bit floats, not compressed: a header, where each line is, the lines channel by channel."""
    channels = b"".join(name + b"\0" + struct.pack("<iIii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    header = struct.pack("<2i", 20000630, 2) + b"".join((
        attribute("channels", "chlist", channels), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    blocks = []
    for row, line in enumerate(lines):
        data = b"".join(struct.pack(f"<{WIDTH}f", *(pixel[c] for pixel in line)) for c in (2, 1, 0))
        blocks.append(struct.pack("<2i", row, len(data)) + data)
    first = len(header) + 8 * HEIGHT
    offsets = struct.pack(f"<{HEIGHT}Q", *(first + row * len(blocks[0]) for row in range(HEIGHT)))
    return header + offsets + b"".join(blocks)


def main() -> int:
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    with open(sys.argv[1], "wb") as file:
        file.write(exr(list(rows())))
    return 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main())
