#!/usr/bin/env python3
"""Times whole pictures on the CPU against Cycles, in turns: `bench/against_cycles.py PERTEV [--pairs N]`.

Needs PyPI's bpy (Cycles 5; `pip install bpy`) and PERTEV_SCENES (docs/scenes.md). Three jobs, all with a box filter of one
pixel: S8 of `pertev bench render`, with its roulette and with that of `pertev render`, and Bitterli's Cornell box with the
depth of its file. Prints for each pair how many
samples a second, without reading and trees (Cycles: by the difference of two numbers of samples), and how fast to equal
error: samples a second times error of a picture of the same number of samples, where the error is the mean over pixels of
variance / (mean^2 + 0.01), from two pictures of other seeds.
"""

import argparse
import json
import math
import os
import pathlib
import statistics
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests/images"))
from mitsuba_to_gltf import convert  # noqa: E402

import bpy  # noqa: E402
import numpy  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

from peer_jobs import run_pertev, seconds_of, write_grey_obj  # noqa: E402


def exr_pixels(path):
    image = bpy.data.images.load(str(path))
    pixels = numpy.array(image.pixels[:], dtype=numpy.float64).reshape(-1, image.channels)[:, :3]
    bpy.data.images.remove(image)
    return pixels


def error_of(first, second):
    """relMSE of one of two pictures that differ in their seed alone."""
    a, b = exr_pixels(first), exr_pixels(second)
    return float(numpy.mean((a - b) ** 2 / 2 / (((a + b) / 2) ** 2 + 0.01)))


class Cycles:
    """A job in Blender's scene. Materials are plain diffuse or emission, as Pertev's."""

    def __init__(self, width, height, depth, threads):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.scene.world = bpy.data.worlds.new("world")
        self.scene.world.use_nodes = True
        render, cycles = self.scene.render, self.scene.cycles
        render.engine, cycles.device = "CYCLES", "CPU"
        render.threads_mode, render.threads = "FIXED", threads
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        render.use_persistent_data = True  # reading and building happen once and are not timed
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        cycles.max_bounces = cycles.diffuse_bounces = depth
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0

    def set_sky(self):
        """Radiance 1, as the length of a direction, so that Cycles does not see a constant: it samples that by no map."""
        tree, world = self.scene.world.node_tree, self.scene.world.cycles
        place, length = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
        length.operation = "LENGTH"
        tree.links.new(place.outputs["Generated"], length.inputs[0])
        tree.links.new(length.outputs["Value"], tree.nodes["Background"].inputs["Color"])
        world.sampling_method, world.sample_map_resolution = "MANUAL", 64

    def set_black(self):
        self.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 0, 0, 1)

    def surface(self, name, node_type, color, strength=None):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        shader, output = tree.nodes.new(node_type), tree.nodes.new("ShaderNodeOutputMaterial")
        shader.inputs["Color"].default_value = (*color, 1)
        if strength is not None:
            shader.inputs["Strength"].default_value = strength
        if strength is None:
            tree.links.new(shader.outputs[0], output.inputs["Surface"])
            return material
        face, mix = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(face.outputs["Backfacing"], mix.inputs[0])  # a lamp shines from its front
        tree.links.new(shader.outputs[0], mix.inputs[1])
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
        return material

    def set_camera(self, world_from_camera, vertical_fov):
        camera = bpy.data.cameras.new("camera")
        camera.sensor_fit, camera.angle_y, camera.angle = "VERTICAL", vertical_fov, vertical_fov
        camera.clip_start, camera.clip_end = 1e-3, 1e5
        thing = bpy.data.objects.new("camera", camera)
        thing.matrix_world = world_from_camera
        self.scene.collection.objects.link(thing)
        self.scene.camera = thing

    def seconds(self, samples, seed=0, path=None):
        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed
        self.scene.render.filepath = str(path or "")
        start = time.perf_counter()
        bpy.ops.render.render(write_still=path is not None)
        return time.perf_counter() - start


def look_at(eye, target):
    forward = (Vector(target) - Vector(eye)).normalized()
    right = forward.cross(Vector((0, 1, 0))).normalized()
    up = right.cross(forward)
    return Matrix([[right[i], up[i], -forward[i], eye[i]] for i in range(3)] + [[0, 0, 0, 1]])


class Sponza:
    name, width, height, samples = "S8", 640, 360, 16

    def __init__(self, scenes, folder, threads):
        self.file = scenes / "crytek-sponza/sponza.obj"
        self.cycles = Cycles(self.width, self.height, 8, threads)
        self.cycles.set_sky()
        bpy.ops.wm.obj_import(filepath=str(self.file), forward_axis="NEGATIVE_Z", up_axis="Y")
        grey = self.cycles.surface("grey", "ShaderNodeBsdfDiffuse", (0.7, 0.7, 0.7))
        for thing in bpy.data.objects:
            if thing.type != "MESH":
                continue
            thing.matrix_world = Matrix()  # the file's own axes
            thing.data.shade_flat()
            thing.data.materials.clear()
            thing.data.materials.append(grey)
        self.cycles.set_camera(look_at((-110, 18, -2), (60, 32, -4)), math.radians(60))

    def arguments(self, path):
        return ["bench", "render", "--job", "S8", "--scene", self.file, "-o", path]


class SponzaByDefault(Sponza):
    """Sponza as a file for `pertev render`, whose paths end by the default Russian roulette."""

    name = "S8 by the roulette of render"

    def __init__(self, scenes, folder, threads):
        super().__init__(scenes, folder, threads)
        write_grey_obj(self.file, pathlib.Path(folder, "grey.obj"), 0.7)
        self.file = pathlib.Path(folder, "grey.obj")

    def arguments(self, path):
        return ["render", self.file, "-o", path, "--filter", "box", "--max-depth", 8, "--environment", "1,1,1",
                "--eye=-110,18,-2", "--target=60,32,-4", "--fov", 60]


class CornellBox:
    name, width, height, samples = "cornell-box", 512, 512, 16

    def __init__(self, scenes, folder, threads):
        text, _, _ = convert(scenes / "bitterli/cornell-box/scene_mitsuba3.xml")
        self.file = pathlib.Path(folder, "box.gltf")
        self.file.write_text(text)
        self.cycles = Cycles(self.width, self.height, 64, threads)
        self.cycles.set_black()
        bpy.ops.import_scene.gltf(filepath=str(self.file))
        for index, material in enumerate(json.loads(text)["materials"]):
            strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
            if any(material.get("emissiveFactor", [0])):
                new = self.cycles.surface("lamp", "ShaderNodeEmission", material["emissiveFactor"], strength)
            else:
                color = material["pbrMetallicRoughness"].get("baseColorFactor", [1, 1, 1])[:3]
                new = self.cycles.surface("wall", "ShaderNodeBsdfDiffuse", color)
            bpy.data.materials[f"Material_{index}"].user_remap(new)  # the importer's name for one without
        camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA")
        camera.data.sensor_fit = "VERTICAL"
        self.cycles.scene.camera = camera

    def arguments(self, path):
        return ["render", self.file, "-o", path, "--filter", "box", "--max-depth", 64]


def pertev(program, job, threads, samples, seed, path):
    """Seconds of rendering alone."""
    return seconds_of(run_pertev(program, [*job.arguments(path), "--spp", samples, "--seed", seed, "--size",
                                           f"{job.width}x{job.height}", "--device", "cpu", "--threads", threads]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pertev")
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    scenes = pathlib.Path(os.environ["PERTEV_SCENES"])
    with tempfile.TemporaryDirectory() as folder:
        for make in (Sponza, SponzaByDefault, CornellBox):
            job = make(scenes, folder, arguments.threads)
            ours = [pathlib.Path(folder, f"ours-{seed}.exr") for seed in (1, 2)]
            theirs = [pathlib.Path(folder, f"theirs-{seed}.exr") for seed in (1, 2)]
            pixels, ratios = job.width * job.height, []
            job.cycles.seconds(1)  # reads and builds
            for _ in range(arguments.pairs):
                seconds = pertev(arguments.pertev, job, arguments.threads, job.samples, 1, ours[0])
                few, many = job.cycles.seconds(job.samples // 4), job.cycles.seconds(job.samples + job.samples // 4)
                rate, rival = pixels * job.samples / seconds, pixels * job.samples / (many - few)
                ratios.append(rate / rival)
                print(f"{job.name}: {rate * 1e-6:.3f} Msamples/s, Cycles {rival * 1e-6:.3f}, {ratios[-1]:.2f} times",
                      flush=True)
            for seed in (1, 2):
                pertev(arguments.pertev, job, arguments.threads, job.samples, seed, ours[seed - 1])
                job.cycles.seconds(job.samples, seed, theirs[seed - 1])
            error, rival = error_of(*ours), error_of(*theirs)
            means = [exr_pixels(path).mean(axis=0).round(5).tolist() for path in (ours[0], theirs[0])]
            ratio = statistics.median(ratios)
            print(f"{job.name}: {ratio:.2f} times the samples a second; relMSE {error:.4e}, Cycles {rival:.4e}; "
                  f"{ratio * rival / error:.2f} times as fast to equal error; means {means[0]}, {means[1]}", flush=True)


if __name__ == "__main__":
    main()
