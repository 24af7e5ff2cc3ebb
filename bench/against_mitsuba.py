#!/usr/bin/env python3
"""Times whole pictures against Mitsuba 3, in turns: `bench/against_mitsuba.py PERTEV [--device cuda] [-o MEASUREMENT.json]`.

Needs PyPI's mitsuba 3.9 (its variants llvm_ad_rgb, for which libLLVM must be there, and cuda_ad_rgb) and PERTEV_SCENES
(docs/scenes.md); a job whose scene is missing is left out. Jobs: grey Sponza under a constant sky, by two roulettes, Bitterli's Cornell
box to two depths, the Stanford bunny under a constant sky, a corridor with 5,000 small emitters in direct light, Bitterli's
veach-ajar, 40 material balls and GlamVelvetSofa. Both renderers use 64 samples, a box filter of one pixel and their own best sampler (Sobol here, multijitter there).

Rates are medians of samples a second, without reading, trees and Mitsuba's compiling. The error is relMSE over the best 98 % of pixels
(`pertev compare`), at a quarter of the width and height, against the renderer's own picture of thousands of samples; "times sooner" is
the ratio of rates times the inverse ratio of errors. Means are those of the references.
"""

import ctypes
import pathlib
import time
import xml.etree.ElementTree as ElementTree

from contest import SceneFile, main
from late_import import LateImport

mi = LateImport("mitsuba")


def diffuse(reflectance):
    return {"type": "twosided", "inner": {"type": "diffuse", "reflectance": {"type": "rgb", "value": float(reflectance)}}}


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


def scene_of_file(job, width, height):
    """The job's file with its depth, film and sampler."""
    tree = ElementTree.parse(job.xml)
    scene = tree.getroot()
    integrator, sensor = scene.find("integrator"), scene.find("sensor")
    for parent, child in ((scene, integrator), (sensor, sensor.find("film")), (sensor, sensor.find("sampler"))):
        parent.remove(child)
    path = ElementTree.SubElement(scene, "integrator", type="path")
    ElementTree.SubElement(path, "integer", name="max_depth", value=str(job.depth + 1))
    ElementTree.SubElement(sensor, "sampler", type="multijitter")
    new = ElementTree.SubElement(sensor, "film", type="hdrfilm")
    for name, value in (("width", width), ("height", height)):
        ElementTree.SubElement(new, "integer", name=name, value=str(value))
    ElementTree.SubElement(new, "string", name="component_format", value="float32")
    ElementTree.SubElement(new, "string", name="pixel_format", value="rgb")
    ElementTree.SubElement(new, "rfilter", type="box")
    for name in scene.iterfind(".//string[@name='filename']"):
        name.set("value", str(job.xml.parent / name.get("value")))
    written = job.folder / f"{job.stem}.{width}.xml"
    tree.write(written)
    return mi.load_file(str(written))


def hold_to_avx2(core):
    """Has Dr.Jit compile for Haswell's eight lanes, by jit_llvm_set_target(processor, features, lanes) of its core, which Python does not
    show. Embree then gets eight rays at a time, and uses AVX-512 internally."""
    ctypes.CDLL(str(core))._Z19jit_llvm_set_targetPKcS0_j(b"haswell", b"+avx2,+fma,+f16c", 8)


class Mitsuba:
    name = "Mitsuba"

    def __init__(self, arguments):
        mi.set_variant("cuda_ad_rgb" if arguments.device == "cuda" else "llvm_ad_rgb")
        if arguments.device == "cpu":
            import drjit
            drjit.set_thread_count(arguments.threads)
            if arguments.lanes == 8:
                hold_to_avx2(pathlib.Path(drjit.__file__).parent / "libdrjit-core.so")

    @staticmethod
    def what():
        return f"Mitsuba {mi.__version__}, {mi.variant()}, multijitter"

    @staticmethod
    def prepare(job, width, height):
        if isinstance(job, SceneFile):
            return scene_of_file(job, width, height)
        film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"}
        to_world = mi.ScalarTransform4f().look_at(list(job.eye), list(job.target), [0, 1, 0])
        scene = {"type": "scene", "integrator": {"type": "path", "max_depth": job.depth + 1, "rr_depth": job.roulette_depth},
                 "sensor": {"type": "perspective", "fov": job.fov, "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e5,
                            "to_world": to_world, "film": film, "sampler": {"type": "multijitter"}}}
        for name, path in split_obj(job.file, job.file.parent).items():
            reflectance, emission = job.materials[name]
            scene[name] = {"type": "obj", "filename": str(path), "face_normals": True, "bsdf": diffuse(reflectance)}
            if emission:
                scene[name]["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": float(emission)}}
        if job.sky:
            scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": job.sky}}
        return mi.load_dict(scene)

    @staticmethod
    def render(scene, samples, seed, path):
        """Pictures of many samples are made in parts, since Mitsuba holds all samples of a call in memory."""
        parts, pixels, start = max(1, samples // 256), 0, time.perf_counter()
        for part in range(parts):
            made = mi.render(scene, spp=samples // parts, seed=seed + part).numpy()  # waits for the picture
            pixels = pixels + made / parts
        seconds = time.perf_counter() - start
        if path:
            mi.Bitmap(mi.TensorXf(pixels)).write(str(path))
        return made.shape[0] * made.shape[1] * samples / seconds


if __name__ == "__main__":
    main(__doc__.splitlines()[0], Mitsuba, ["cpu", "cuda"])
