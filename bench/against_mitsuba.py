#!/usr/bin/env python3
"""Times whole pictures against Mitsuba 3, in turns: `bench/against_mitsuba.py PERTEV [--device cuda] [-o MEASUREMENT.json]`.

Needs PyPI's mitsuba 3.9 (its variants llvm_ad_rgb, for which libLLVM must be there, and cuda_ad_rgb) and PERTEV_SCENES
(docs/scenes.md); a job whose scene is missing is left out. Five jobs: grey Sponza under a constant sky, Bitterli's Cornell box to two
depths, the Stanford bunny under a constant sky, and a corridor of 5,000 small lamps in direct light. Both renderers use 64 samples, a
box filter of one pixel and their own best sampler (Sobol here, multijitter there).

Rates are medians of samples a second, without reading, trees and Mitsuba's compiling. The error is relMSE, the mean of
(x - r)^2 / (r^2 + 0.01), over the best 98 % of pixels, at a quarter of the width and height, against the renderer's own picture of
thousands of samples; "times sooner" is the ratio of rates times the inverse ratio of errors. Means are those of the references.
"""

import argparse
import os
import pathlib
import statistics
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree

import numpy

import mitsuba as mi
from peer_jobs import run_pertev, seconds_of, write_grey_obj, write_measurement

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests/images"), str(ROOT / "tools")]
import make_corridor  # noqa: E402
from mitsuba_to_gltf import convert  # noqa: E402

SAMPLES = 64
COLUMNS = [("job", "job", None), ("pertev", "Pertev", "Msamples/s"), ("mitsuba", "Mitsuba", "Msamples/s"),
           ("times_the_samples", "times the samples", None), ("pertev_relmse", "Pertev relMSE", None),
           ("mitsuba_relmse", "Mitsuba relMSE", None), ("times_sooner", "times sooner to equal error", None),
           ("pertev_mean", "Pertev mean", None), ("mitsuba_mean", "Mitsuba mean", None)]


def diffuse(reflectance):
    inner = {"type": "diffuse", "reflectance": {"type": "rgb", "value": reflectance}}
    return {"type": "twosided", "inner": inner}


def split_obj(source, folder):
    """The faces of each material of an OBJ as an OBJ of its own; Mitsuba's reader gives all of a file one material."""
    vertices, faces, material = [], {}, ""
    for line in source.read_text().splitlines():
        word, _, rest = line.partition(" ")
        if word == "v":
            vertices.append(line)
        elif word == "usemtl":
            material = rest
        elif word == "f":
            corners = [int(corner.split("/")[0]) for corner in rest.split()]
            faces.setdefault(material, []).append([c if c > 0 else len(vertices) + 1 + c for c in corners])
    paths = {}
    for name, some in faces.items():
        paths[name] = folder / f"{source.stem}-{name}.obj"
        paths[name].write_text("\n".join(vertices + ["f " + " ".join(map(str, face)) for face in some]) + "\n")
    return paths


class Job:
    """One picture in both renderers. `depth` counts scatterings, `eye`, `target` and `fov` (vertical, degrees) are the camera's."""

    sky, roulette_depth = None, 5
    cpu_size, gpu_size = (640, 360), (1920, 1080)

    def __init__(self, scenes, folder, on_gpu):
        self.width, self.height = self.gpu_size if on_gpu else self.cpu_size
        self.file = folder / f"{self.stem}.obj"
        self.write(scenes)

    def render_flags(self):
        flags = ["render", self.file, "--filter", "box", "--max-depth", self.depth]
        flags += ["--eye=" + ",".join(map(str, self.eye)), "--target=" + ",".join(map(str, self.target)), "--fov", self.fov]
        return flags + (["--environment", ",".join(map(str, [self.sky] * 3))] if self.sky else [])

    def bsdfs(self):
        """Mitsuba's materials and emitters by the names of the OBJ's."""
        return {"grey": {"bsdf": diffuse(self.grey)}}

    def mitsuba(self, width, height):
        to_world = mi.ScalarTransform4f().look_at(list(self.eye), list(self.target), [0, 1, 0])
        scene = {"type": "scene", "integrator": {"type": "path", "max_depth": self.depth + 1, "rr_depth": self.roulette_depth},
                 "sensor": {"type": "perspective", "fov": self.fov, "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e5,
                            "to_world": to_world, "film": film(width, height), "sampler": {"type": "multijitter"}}}
        for name, path in split_obj(self.file, self.file.parent).items():
            scene[name] = {"type": "obj", "filename": str(path), "face_normals": True, **self.bsdfs()[name]}
        if self.sky:
            scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": self.sky}}
        return mi.load_dict(scene)


class Sponza(Job):
    name, stem, grey, depth, sky, roulette_depth = "grey Sponza, 8 bounces", "sponza", 0.7, 8, 1.0, 2
    eye, target, fov = (-110, 18, -2), (60, 32, -4), 60

    def write(self, scenes):
        self.scene = scenes / "crytek-sponza/sponza.obj"
        write_grey_obj(self.scene, self.file, self.grey)

    def render_flags(self):
        return ["bench", "render", "--job", "S8", "--scene", self.scene]  # its roulette: by throughput, from the second vertex on


class Bunny(Job):
    name, stem, grey, depth, sky = "bunny, depth 8", "bunny", 0.5, 7, 1.0
    eye, target, fov = (-0.017, 0.14, 0.33), (-0.017, 0.108, 0), 35

    def write(self, scenes):
        write_grey_obj(scenes / "stanford/bunny.obj", self.file, self.grey)


class Corridor(Job):
    name, stem, depth = "corridor of 5,000 lamps, direct light", "corridor", 1
    eye, target, fov = (0, 1.6, 29.5), (0, 1.5, 0), 60

    def write(self, scenes):
        make_corridor.write(self.file)

    def bsdfs(self):
        emitter = {"type": "area", "radiance": {"type": "rgb", "value": float(make_corridor.EMISSION)}}
        return {"wall": {"bsdf": diffuse(make_corridor.REFLECTANCE)}, "lamp": {"bsdf": diffuse(0.0), "emitter": emitter}}


class CornellBox(Job):
    name, stem, depth = "Cornell box, depth 8", "cornell-box", 7
    cpu_size, gpu_size = (512, 512), (1024, 1024)

    def write(self, scenes):
        self.xml = scenes / "bitterli/cornell-box/scene_mitsuba3.xml"
        self.file = self.file.with_suffix(".gltf")
        self.file.write_text(convert(self.xml)[0])

    def render_flags(self):
        return ["render", self.file, "--filter", "box", "--max-depth", self.depth]

    def mitsuba(self, width, height):
        """The file with the job's depth, film and sampler."""
        tree = ElementTree.parse(self.xml)
        scene = tree.getroot()
        integrator, sensor = scene.find("integrator"), scene.find("sensor")
        for parent, child in ((scene, integrator), (sensor, sensor.find("film")), (sensor, sensor.find("sampler"))):
            parent.remove(child)
        path = ElementTree.SubElement(scene, "integrator", type="path")
        ElementTree.SubElement(path, "integer", name="max_depth", value=str(self.depth + 1))
        ElementTree.SubElement(sensor, "sampler", type="multijitter")
        new = ElementTree.SubElement(sensor, "film", type="hdrfilm")
        for name, value in (("width", width), ("height", height)):
            ElementTree.SubElement(new, "integer", name=name, value=str(value))
        ElementTree.SubElement(new, "string", name="component_format", value="float32")
        ElementTree.SubElement(new, "string", name="pixel_format", value="rgb")
        ElementTree.SubElement(new, "rfilter", type="box")
        written = self.file.with_suffix(f".{width}.xml")
        tree.write(written)
        return mi.load_file(str(written))


class DeepCornellBox(CornellBox):
    name, stem, depth = "Cornell box, depth 65", "cornell-box-65", 64


def film(width, height):
    return {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb",
            "component_format": "float32"}


class Contest:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder

    def pertev(self, job, width, height, samples, seed):
        """The picture, and samples a second."""
        target = self.folder / "pertev.exr"
        event = run_pertev(self.arguments.pertev, [
            *job.render_flags(), "-o", target, "--size", f"{width}x{height}", "--spp", samples, "--seed", seed, "--device",
            self.arguments.device, *(["--threads", self.arguments.threads] if self.arguments.device == "cpu" else [])])
        pixels = mi.Bitmap(str(target)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
        return numpy.array(pixels, dtype=numpy.float64), width * height * samples / seconds_of(event)

    def mitsuba(self, scene, samples, seed):
        start = time.perf_counter()
        pixels = numpy.array(mi.render(scene, spp=samples, seed=seed), dtype=numpy.float64)  # waits for the picture
        return pixels, pixels.shape[0] * pixels.shape[1] * samples / (time.perf_counter() - start)

    def references(self, job, scene, width, height):
        """Both renderers' pictures of thousands of samples; kept in --work, so that a second run need not make them."""
        pictures = []
        for who in ("pertev", "mitsuba"):
            kept = self.folder / f"{job.stem}-{who}-{width}x{height}-{self.arguments.reference}.npy"
            if not kept.exists():
                if who == "pertev":
                    picture = self.pertev(job, width, height, self.arguments.reference, 1000)[0]
                else:  # in parts, since Mitsuba holds all samples of a call in memory
                    parts = max(1, self.arguments.reference // 256)
                    picture = sum(self.mitsuba(scene, 256, 1000 + part)[0] for part in range(parts)) / parts
                numpy.save(kept, picture)
            pictures.append(numpy.load(kept))
        return pictures

    def run(self, job):
        """A row of the table."""
        scene = job.mitsuba(job.width, job.height)
        self.mitsuba(scene, SAMPLES, 0)  # compiles
        rates = []
        for seed in range(1, self.arguments.runs + 1):
            rates.append((self.pertev(job, job.width, job.height, SAMPLES, seed)[1], self.mitsuba(scene, SAMPLES, seed)[1]))
            print(f"{job.name}: {rates[-1][0] * 1e-6:.3f} Msamples/s, Mitsuba {rates[-1][1] * 1e-6:.3f}", flush=True)
        ours, theirs = (statistics.median(column) for column in zip(*rates))
        width, height = job.width // 4, job.height // 4
        scene = job.mitsuba(width, height)
        references = self.references(job, scene, width, height)
        errors = [0.0, 0.0]
        for seed in range(1, 5):
            pictures = self.pertev(job, width, height, SAMPLES, seed)[0], self.mitsuba(scene, SAMPLES, seed)[0]
            errors = [e + best_error(p, r) / 4 for e, p, r in zip(errors, pictures, references)]
        means = [reference.mean() for reference in references]
        if abs(means[0] / means[1] - 1) > 0.005:
            print(f"{job.name}: the means {means[0]:.5f} and {means[1]:.5f} differ by more than 0.5 %", file=sys.stderr)
        sooner = ours / theirs * errors[1] / errors[0]
        row = [job.name, *(float(f"{value:.4g}") for value in (ours * 1e-6, theirs * 1e-6, ours / theirs, *errors, sooner)),
               *(float(f"{mean:.5g}") for mean in means)]
        print(*row, sep=", ", flush=True)
        return row


def best_error(picture, reference):
    """relMSE over the 98 % of pixels where it is least."""
    errors = ((picture - reference) ** 2 / (reference**2 + 0.01)).mean(axis=2).ravel()
    errors.sort()
    return float(errors[: int(0.98 * errors.size)].mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pertev")
    parser.add_argument("--device", choices=["cpu", "cuda"], default="cpu")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--runs", type=int, default=5, help="runs of each renderer, in turns (5)")
    parser.add_argument("--reference", type=int, default=4096, help="samples of the references (4096)")
    parser.add_argument("--jobs", nargs="+", metavar="STEM", help="only these: sponza, cornell-box, cornell-box-65, bunny, corridor")
    parser.add_argument("--work", type=pathlib.Path, help="a folder in which references are kept")
    parser.add_argument("-o", "--output", type=pathlib.Path)
    arguments = parser.parse_args()
    on_gpu = arguments.device == "cuda"
    mi.set_variant("cuda_ad_rgb" if on_gpu else "llvm_ad_rgb")
    if not on_gpu:
        import drjit
        drjit.set_thread_count(arguments.threads)
    scenes = pathlib.Path(os.environ["PERTEV_SCENES"])
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.work or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        rows = []
        for kind in (Sponza, CornellBox, DeepCornellBox, Bunny, Corridor):
            if arguments.jobs and kind.stem not in arguments.jobs:
                continue
            try:
                job = kind(scenes, folder, on_gpu)
            except FileNotFoundError as missing:
                print(f"{kind.name}: left out, {missing.filename} is missing", file=sys.stderr)
                continue
            rows.append(Contest(arguments, folder).run(job))
    if arguments.output:
        notes = [f"Mitsuba {mi.__version__}, {mi.variant()}, multijitter; {SAMPLES} samples, box filter; medians of {arguments.runs} "
                 f"runs in turns; references of {arguments.reference} samples."]
        write_measurement(arguments.output, arguments.pertev, "Against Mitsuba 3", arguments.threads, on_gpu, notes, COLUMNS, rows)


if __name__ == "__main__":
    main()
