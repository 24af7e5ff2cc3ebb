"""Renders a turntable: pictures from all sides of a scene, whose box fills the view.

    python examples/turntable.py scene.glb out --frames 48

Prints the line that makes a video of them by ffmpeg.
"""

import argparse
import pathlib

import numpy
import pertev

from poses import look_at, size_of

FOV = 35  # the full vertical angle of view, degrees


def orbit(bounds, count, aspect, elevation):
    """Returns poses around a box, whose sphere touches the edges of the view, `elevation` degrees above the horizon."""
    centre, radius = bounds.mean(axis=0), 0.5 * numpy.linalg.norm(numpy.diff(bounds, axis=0))
    half = numpy.radians(FOV) / 2
    distance = radius / numpy.sin(min(half, numpy.arctan(aspect * numpy.tan(half))))
    up = numpy.radians(elevation)
    return numpy.array([look_at(centre + distance * numpy.array([numpy.cos(up) * numpy.sin(angle), numpy.sin(up),
                                                                  numpy.cos(up) * numpy.cos(angle)]), centre)
                        for angle in numpy.arange(count) * 2 * numpy.pi / count])


def stops_of(color):
    """Returns the exposure, in stops, at which half of the pixels that are not black are darker than middle grey."""
    luminance = color[..., :3] @ numpy.array([0.2126, 0.7152, 0.0722], numpy.float32)
    return float(numpy.log2(0.18 / max(numpy.median(luminance[luminance > 0]), 1e-6)))


def main():
    parser = argparse.ArgumentParser(description="Renders a turntable.")
    parser.add_argument("scene", help="a file, or the name of a built-in scene")
    parser.add_argument("folder")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--size", type=size_of, default=(640, 480), metavar="WIDTHxHEIGHT")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    parser.add_argument("--elevation", type=float, default=20, help="degrees above the horizon")
    parser.add_argument("--fps", type=float, default=24)
    given = parser.parse_args()
    folder = pathlib.Path(given.folder)
    folder.mkdir(parents=True, exist_ok=True)
    scene = pertev.load(given.scene)
    poses = orbit(scene.bounds, given.frames, given.size[0] / given.size[1], given.elevation)
    number, stops = 0, None
    for part in pertev.render_chunks(scene, poses, size=given.size, spp=given.spp, fov=FOV):
        for color in numpy.asarray(part.color):
            stops = stops_of(color) if stops is None else stops  # one exposure, so that the video does not flicker
            pertev.write(folder / f"frame-{number:04}.png", color, curve="agx", exposure=stops)
            number += 1
    print(f"{number} pictures; a video: ffmpeg -framerate {given.fps:g} -i {folder}/frame-%04d.png -pix_fmt yuv420p "
          f"{folder}/turntable.mp4")


if __name__ == "__main__":
    main()
