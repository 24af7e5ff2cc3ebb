#!/usr/bin/env python3
"""Renders four scenes with participating media by Pertev and by Mitsuba's volpath, and compares them by a z-test.

Both read the same files, which this script makes. Each renders every scene some times with independent samples; Welch's
test compares each channel of each pixel, Sidak corrected, and of the mean of the picture. The last column is Pertev's
variance by --integrator over that by --beside. Mitsuba comes from PyPI:

    tests/images/mitsuba_media.py build/bin/pertev [--runs 16] [--spp 64] [--size 32] [--integrator path] [--beside bidirectional] [--keep FOLDER]
        [-o MEASUREMENT.json]
"""

import argparse
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from late_import import LateImport  # noqa: E402
from measurement import write_measurement  # noqa: E402

numpy = LateImport("numpy")

TITLES = {"fog": "fog in a room", "cloud": "cloud", "milk": "milk in rough glass", "haze": "glass in haze"}

FILM = """<film type="hdrfilm"><integer name="width" value="$size"/><integer name="height" value="$size"/>
<rfilter type="box"/><string name="pixel_format" value="rgb"/></film><sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>"""


def sensor(origin, target, fov, medium=""):
    return f"""<sensor type="perspective"><float name="fov" value="{fov}"/><transform name="to_world"><lookat origin="{origin}" target="{target}" up="0,1,0"/></transform>{FILM}{medium}</sensor>"""


def quad(name, to_world, bsdf="", emitter=""):
    return f'<shape type="rectangle" id="{name}"><transform name="to_world">{to_world}</transform>{bsdf}{emitter}</shape>'


def diffuse(color):
    return f'<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="{color}"/></bsdf></bsdf>'


def medium(name, sigma_t, albedo, g, where=None):
    phase = f'<phase type="hg"><float name="g" value="{g}"/></phase>' if g else '<phase type="isotropic"/>'
    id_or_name = f'name="{where}"' if where else f'id="{name}"'
    rates = [float(x) for x in sigma_t.split(",")]
    sigma_t = ",".join(repr(x / max(rates)) for x in rates)  # Mitsuba's colours are at most 1
    return f'<medium type="homogeneous" {id_or_name}><float name="scale" value="{max(rates)}"/><rgb name="sigma_t" value="{sigma_t}"/><rgb name="albedo" value="{albedo}"/>{phase}</medium>'


def ball(center, radius, inner):
    return f'<shape type="ply"><string name="filename" value="ball.ply"/><boolean name="face_normals" value="true"/><transform name="to_world"><scale value="{radius}"/><translate value="{center}"/></transform>{inner}</shape>'


def cube(center, half, inner):
    return f'<shape type="cube"><transform name="to_world"><scale value="{half}"/><translate value="{center}"/></transform>{inner}</shape>'


NULL = '<bsdf type="null"/>'
LAMP = '<emitter type="area"><rgb name="radiance" value="{}"/></emitter>'
FLOOR = quad("floor", '<rotate x="1" angle="-90"/><scale value="4"/><translate y="-1"/>', diffuse("0.6,0.6,0.6"))


def glass(ior, alpha=0.0):
    if alpha:
        return f'<bsdf type="roughdielectric"><float name="int_ior" value="{ior}"/><float name="ext_ior" value="1"/><float name="alpha" value="{alpha}"/><string name="distribution" value="ggx"/></bsdf>'
    return f'<bsdf type="dielectric"><float name="int_ior" value="{ior}"/><float name="ext_ior" value="1"/></bsdf>'


def room(extra):
    """A Cornell box about the origin, of side 2."""
    return "".join([
        quad("floor", '<rotate x="1" angle="-90"/><translate y="-1"/>', diffuse("0.7,0.7,0.7")),
        quad("ceiling", '<rotate x="1" angle="90"/><translate y="1"/>', diffuse("0.7,0.7,0.7")),
        quad("back", '<translate z="-1"/>', diffuse("0.7,0.7,0.7")),
        quad("front", '<rotate y="1" angle="180"/><translate z="1"/>', diffuse("0.2,0.2,0.2")),
        quad("left", '<rotate y="1" angle="90"/><translate x="-1"/>', diffuse("0.6,0.1,0.1")),
        quad("right", '<rotate y="1" angle="-90"/><translate x="1"/>', diffuse("0.1,0.5,0.1")),
        quad("lamp", '<rotate x="1" angle="90"/><scale value="0.4"/><translate y="0.98"/>', emitter=LAMP.format("9,8,7")),
        extra])


SCENES = {
    # fog around the camera in a room, with a glass ball that holds none
    "fog": medium("fog", "0.5,0.7,1.1", "0.9,0.8,0.7", 0.4)
    + sensor("0,0,0.95", "0,0,-1", 80, '<ref name="medium" id="fog"/>')
    + room(ball("0.3,-0.5,-0.2", 0.4, glass(1.5) + '<ref name="exterior" id="fog"/>')),
    # a cloud with a clear boundary, lit by a point light and an emitter
    "cloud": sensor("0,0.6,5", "0,0,0", 40) + FLOOR
    + ball("0,0,0", 0.9, NULL + medium("", "2.5,1.5,3.5", "0.95,0.9,0.5", 0.6, "interior"))
    + '<emitter type="point"><point name="position" value="2,2.5,1"/><rgb name="intensity" value="9,9,9"/></emitter>'
    + quad("lamp", '<rotate x="1" angle="90"/><scale value="0.6"/><translate x="-1.5" y="2.5"/>', emitter=LAMP.format("6,5,4")),
    # milk in rough glass under a sky
    "milk": sensor("0,0.6,5", "0,0,0", 40) + FLOOR
    + ball("0,0,0", 0.9, glass(1.33, 0.3) + medium("", "4,5,6", "0.98,0.95,0.85", 0.0, "interior"))
    + '<emitter type="constant"><rgb name="radiance" value="0.8,0.9,1"/></emitter>',
    # glass in a haze with a clear boundary, and a hollow in it
    "haze": medium("haze", "0.8,0.4,0.3", "0.9,0.95,0.6", -0.3)
    + sensor("0,0.8,6", "0,-0.1,0", 40) + FLOOR
    + cube("0,0,0", "1.6,0.9,1.2", NULL + '<ref name="interior" id="haze"/>')
    + ball("-0.6,0,0", 0.5, glass(1.5) + '<ref name="exterior" id="haze"/>')
    + ball("0.7,0,0.2", 0.45, NULL + '<ref name="exterior" id="haze"/>')
    + quad("lamp", '<rotate x="1" angle="90"/><scale value="0.8"/><translate y="2.5"/>', emitter=LAMP.format("8,8,8")),
}


def write_ball(path, turns=24):
    """A closed ball of radius 1."""
    rows = turns // 2
    points, triangles = [(0.0, 1.0, 0.0)], []
    for row in range(1, rows):
        for turn in range(turns):
            theta, phi = math.pi * row / rows, 2 * math.pi * turn / turns
            points.append((math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)))
    points.append((0.0, -1.0, 0.0))
    at = lambda row, turn: 0 if row == 0 else len(points) - 1 if row == rows else 1 + (row - 1) * turns + turn % turns
    for row in range(rows):
        for turn in range(turns):
            a, b, c, d = at(row, turn), at(row, turn + 1), at(row + 1, turn), at(row + 1, turn + 1)
            if row > 0:
                triangles.append((a, b, c))
            if row < rows - 1:
                triangles.append((b, d, c))
    text = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    text += "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points) + "".join(f"3 {a} {b} {c}\n" for a, b, c in triangles)
    path.write_text(text)


def write_scene(path, body, depth, size, spp):
    integrator = f'<integrator type="volpath"><integer name="max_depth" value="{depth + 1}"/><integer name="rr_depth" value="1000"/></integrator>'
    text = f'<scene version="3.0.0">{integrator}{body}</scene>'
    path.write_text(text.replace("$size", str(size)).replace("$spp", str(spp)))


def by_mitsuba(path, runs):
    import mitsuba
    mitsuba.set_variant("scalar_rgb")
    scene = mitsuba.load_file(str(path))
    return [numpy.array(mitsuba.render(scene, seed=1000 + run), dtype=float)[:, :, :3] for run in range(runs)]


def by_pertev(program, path, runs, more):
    import OpenEXR
    pictures = []
    for run in range(runs):
        out = path.parent / f"{path.stem}-{run}.exr"
        subprocess.run([program, "render", path, "-o", out, "--seed", str(run), "--sampler", "independent", "--no-bvh-cache", "--device", "cpu",
                        "--strict", "-q", *more], check=True)
        channels = OpenEXR.File(str(out)).channels()
        pictures.append(numpy.array(channels["RGB"].pixels, dtype=float) if "RGB" in channels else
                        numpy.stack([channels[c].pixels for c in "RGB"], axis=-1).astype(float))
    return pictures


def p_values(a, b):
    """Two-sided p-values by Welch's test, with the normal distribution in place of Student's where runs are many."""
    from math import erfc
    a, b = numpy.array(a), numpy.array(b)
    variance = a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b)
    z = (a.mean(axis=0) - b.mean(axis=0)) / numpy.sqrt(variance + (1e-4 * b.mean(axis=0)) ** 2 + 1e-30)
    return z, numpy.vectorize(lambda x: erfc(abs(x) / math.sqrt(2)))(z)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--size", type=int, default=32)
    parser.add_argument("--depth", type=int, default=16)
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--integrator", default="path")
    parser.add_argument("--beside", default="bidirectional")
    parser.add_argument("--keep")
    parser.add_argument("-o", dest="output")
    options = parser.parse_args()
    failed, rows = False, []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(options.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        write_ball(folder / "ball.ply")
        print("| scene | mean of Pertev | of Mitsuba | z of the mean (R, G, B) | largest z of a block | p, Sidak | ratio of variances |")
        print("|---|---|---|---|---|---|---|")
        for name in options.scenes.split(","):
            path = folder / f"{name}.xml"
            write_scene(path, SCENES[name], options.depth, options.size, options.spp)
            ours = by_pertev(options.program, path, options.runs, ["--integrator", options.integrator])
            theirs = by_mitsuba(path, options.runs)
            others = by_pertev(options.program, path, options.runs, ["--integrator", options.beside])
            ratio = numpy.var(ours, axis=0, ddof=1).mean() / numpy.var(others, axis=0, ddof=1).mean()
            blocks = lambda pictures: [p.reshape(options.size // 4, 4, options.size // 4, 4, 3).mean(axis=(1, 3)) for p in pictures]
            z_block, p_block = p_values(blocks(ours), blocks(theirs))
            z_mean, _ = p_values([p.mean(axis=(0, 1)) for p in ours], [p.mean(axis=(0, 1)) for p in theirs])
            p = 1 - (1 - p_block.min()) ** p_block.size
            means = [" ".join(f"{x:.4f}" for x in numpy.mean(p, axis=(0, 1, 2))) for p in (ours, theirs)]
            print(f"| {name} | {means[0]} | {means[1]} | {' '.join(f'{z:+.2f}' for z in z_mean)} | {abs(z_block).max():.2f} | {p:.3f} | {ratio:.2f} |", flush=True)
            rows.append([TITLES[name], ", ".join(f"{z:.2f}" for z in z_mean), round(float(abs(z_block).max()), 2), round(float(ratio), 2)])
            failed = failed or p < 1e-3 or abs(z_mean).max() > 4
    if options.output:
        columns = [("scene", "scene", None), ("z_of_the_mean", "z of the mean", None), ("largest_z", "largest z", None),
                   ("ratio", f"variance over {options.beside}'s", None)]
        notes = [f"{options.runs} pictures of {options.size}x{options.size}, {options.spp} samples; z of the mean of red, green and blue, and the "
                 "largest of any block of 4x4 pixels. Variances are at equal samples."]
        write_measurement(options.output, options.program, f"Media against Mitsuba's volpath, and by {options.beside}", columns, rows, "cpu", None, notes)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
