#!/usr/bin/env python3
"""Batches of small pictures beside Newton's camera sensor: `bench/against_newton.py PERTEV [--device cuda] [-o FILE.json]`.

Needs PyPI's newton 1.8 with warp-lang, and PERTEV_SCENES (docs/scenes.md). The scenes are grey Sponza at 128x128 and one mesh of 100
thousand triangles at 64x64, by cameras that turn and step aside as those of `pertev bench cameras` do. Jobs: depth, normals and ids at
pixel centres; there, also colour in one direct light with its shadow, here with one sample of the sky and its shadow. Newton's
arithmetic is fast and approximate, its light one direction. Rates are medians of pictures a second, without reading, trees and compiling, and Newton's are those of its fastest render order.
"""

import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

from contest import SPONZA, write_grey_obj
from late_import import LateImport
from measurement import write_measurement

np, wp, newton, sensors = (LateImport(name) for name in ("numpy", "warp", "newton", "newton.sensors"))
MESH = {"eye": (0, 0.5, 2.6), "target": (0, 0, 0), "fov_y_deg": 60}
TITLES = {"centres": "depth, normals and ids at pixel centres", "direct": "and one direct sample with its shadow"}


def triangles_of(obj):
    vertices, indices = [], []
    for line in obj.read_text().splitlines():
        word, _, rest = line.partition(" ")
        if word == "v":
            vertices.append([float(x) for x in rest.split()[:3]])
        elif word == "f":
            corners = [int(corner) for corner in rest.split()]
            corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
            for second, third in zip(corners[1:], corners[2:]):
                indices += [corners[0], second, third]
    return np.array(vertices, np.float32), np.array(indices, np.int32)


def write_mesh(obj, rows=224):
    """Writes a sphere with waves: 2 * rows^2 triangles."""
    v, u = (a.ravel() for a in np.meshgrid(np.arange(rows + 1) / rows * math.pi, np.arange(rows + 1) / rows * 2 * math.pi, indexing="ij"))
    radius = 1 + 0.1 * np.sin(v) * np.sin(7 * u) * np.sin(9 * v)
    points = radius[:, None] * np.stack([np.sin(v) * np.cos(u), np.cos(v), -np.sin(v) * np.sin(u)], 1)
    corner = (np.arange(rows)[:, None] * (rows + 1) + np.arange(rows) + 1).ravel()
    below = corner + rows + 1
    faces = np.concatenate([np.stack(face, 1) for face in ((corner, below, below + 1), (corner, below + 1, corner + 1))])
    obj.write_text("".join([*("v %.6f %.6f %.6f\n" % tuple(p) for p in points), *("f %d %d %d\n" % tuple(f) for f in faces)]))


def transforms_of(view, count, size):
    """Positions and quaternions of the cameras of `pertev bench cameras`."""
    eye, target = np.array(view["eye"], float), np.array(view["target"], float)
    z = (eye - target) / np.linalg.norm(eye - target)
    x = np.cross([0, 1, 0], z)
    x /= np.linalg.norm(x)
    base = np.stack([x, np.cross(z, x), z], 1)
    result = []
    for k in range(count):
        yaw = math.pi / 3 * (k * 0.6180339887 % 1 - 0.5)
        aside = 0.04 * size * np.array([k * 0.7548776662 % 1 - 0.5, k * 0.5698402910 % 1 - 0.5, 0])
        c, s = math.cos(yaw), math.sin(yaw)
        turned = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ base
        q = wp.quat_from_matrix(wp.mat33(*turned.astype(np.float32).flatten()))
        result.append([*(eye + turned @ aside), *q])
    return np.array(result, np.float32)


def rate_of(run, pictures, device, runs):
    run()  # compiles
    seconds = []
    for _ in range(runs):
        wp.synchronize_device(device)
        start = time.perf_counter()
        run()
        wp.synchronize_device(device)
        seconds.append(time.perf_counter() - start)
    return pictures / statistics.median(seconds)


def measure_newton(obj, view, side, pictures, device, runs):
    vertices, indices = triangles_of(obj)
    builder = newton.ModelBuilder(up_axis=newton.Axis.Y)
    mesh = newton.Mesh(vertices, indices, compute_inertia=False, color=(0.7, 0.7, 0.7))
    builder.add_shape_mesh(-1, mesh=mesh)
    model = builder.finalize(device=device)
    state, sensor = model.state(), sensors.SensorCamera(model)
    sensor.create_default_light(enable_shadows=True)
    rays = sensors.SensorCamera.compute_camera_rays_pinhole(side, side, camera_fov=math.radians(view["fov_y_deg"]), device=device)
    size = float(np.linalg.norm(vertices.max(0) - vertices.min(0)))
    transforms = wp.array(transforms_of(view, pictures, size), dtype=wp.transformf, device=device)
    worlds = wp.zeros(pictures, dtype=wp.int32, device=device)
    layers = {
        "forward_depth_image": sensor.allocate_image_depth_forward(pictures, side, side),
        "normal_image": sensor.allocate_image_normal(pictures, side, side),
        "shape_index_image": sensor.allocate_image_shape_index(pictures, side, side),
    }
    color = sensor.allocate_image_color(pictures, side, side)
    rates = {"centres": {}, "direct": {}}
    for order in sensors.SensorCamera.RenderOrder:
        config = sensors.SensorCamera.RenderConfig(enable_shadows=True, enable_backface_culling=False, max_distance=1e6, render_order=order)
        for job, images in (("centres", layers), ("direct", {"color_image": color, **layers})):
            rates[job][order.name.lower()] = rate_of(
                lambda config=config, images=images: sensor.update(state, transforms, rays, world_indices=worlds, render_config=config, **images),
                pictures, device, runs)
    seen = layers["forward_depth_image"].numpy() > 0
    return rates, float(seen.mean())


def measure_pertev(program, obj, view, side, pictures, device, runs):
    camera = ["--eye=" + ",".join(map(str, view["eye"])), "--target=" + ",".join(map(str, view["target"]))]
    camera += ["--fov", str(view["fov_y_deg"]), "--environment", "1,1,1", "--size", f"{side}x{side}"]
    flags = [*camera, "--pictures", str(pictures), "--runs", str(runs), "--device", device, "--json"]
    lines = subprocess.run([program, "bench", "cameras", str(obj), *flags], check=True, capture_output=True, text=True).stdout
    events = [json.loads(line) for line in lines.splitlines()]
    return {row["job"]: row["pictures_per_second"] for row in events if row.get("event") == "cameras"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pertev", type=pathlib.Path)
    parser.add_argument("--device", default="cpu", choices=["cpu", "cuda"])
    parser.add_argument("--pictures", type=int, help="4096 in CUDA, 16 on the CPU")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("-o", "--output", type=pathlib.Path)
    args = parser.parse_args()
    pictures = args.pictures or (4096 if args.device == "cuda" else 16)
    device = "cuda:0" if args.device == "cuda" else "cpu"
    rows, notes = [], [f"Newton {newton.__version__}, Warp {wp.__version__}; batches of {pictures} pictures, medians of {args.runs} runs. Newton's light comes from "
                       "one direction, Pertev's from a constant sky."]
    with tempfile.TemporaryDirectory() as folder:
        sponza, mesh = pathlib.Path(folder) / "sponza.obj", pathlib.Path(folder) / "mesh.obj"
        write_grey_obj(pathlib.Path(os.environ["PERTEV_SCENES"]) / SPONZA["file"], sponza, 0.7)
        write_mesh(mesh)
        for name, obj, view, side in (("grey Sponza", sponza, SPONZA, 128), ("100 thousand triangles", mesh, MESH, 64)):
            theirs, seen = measure_newton(obj, view, side, pictures, device, args.runs)
            ours = measure_pertev(args.pertev.resolve(), obj, view, side, pictures, args.device, args.runs)
            notes.append(f"{100 * seen:.0f} % of Newton's pixels hit {name}.")
            for job, by_order in theirs.items():
                best, order = max((rate, order) for order, rate in by_order.items())
                rows.append([f"{name}, {side}x{side}", TITLES[job], round(ours[job]), round(best), float(f"{ours[job] / best:.4g}"), order])
                print(*rows[-1], sep=", ")
    if args.output:
        columns = [("scene", "scene", None), ("layers", "layers", None), ("pertev", "Pertev", "pictures/s"), ("newton", "Newton", "pictures/s"),
                   ("ratio", "ratio", None), ("order", "Newton's render order", None)]
        write_measurement(args.output, args.pertev.resolve(), "Against Newton's camera sensor", columns, rows, args.device, os.cpu_count(), notes, "batches")


if __name__ == "__main__":
    main()
