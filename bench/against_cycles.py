#!/usr/bin/env python3
"""Times whole pictures on the CPU against Cycles, in turns: `bench/against_cycles.py PERTEV [--runs N] [-o MEASUREMENT.json]`.

Needs PyPI's bpy (Cycles 5; `pip install bpy`) and PERTEV_SCENES (docs/scenes.md). Jobs, rates, errors and means are those of
bench/against_mitsuba.py. Reading and trees are not timed, in Cycles by the difference of two numbers of samples.
"""

import json
import math
import time

from contest import CornellBox, main
from late_import import LateImport

bpy, mathutils = LateImport("bpy"), LateImport("mathutils")  # bpy brings mathutils


class Scene:
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

    @staticmethod
    def surface(color, strength=None):
        """Diffuse, or with a strength an emitter."""
        material = bpy.data.materials.new("surface")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse" if strength is None else "ShaderNodeEmission")
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        shader.inputs["Color"].default_value = (*color, 1)
        if strength is None:
            tree.links.new(shader.outputs[0], output.inputs["Surface"])
            return material
        shader.inputs["Strength"].default_value = strength
        face, mix = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(face.outputs["Backfacing"], mix.inputs[0])  # an emitter emits from its front
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

    def seconds(self, samples, seed, path=None):
        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed
        self.scene.render.filepath = str(path or "")
        start = time.perf_counter()
        bpy.ops.render.render(write_still=path is not None)
        return time.perf_counter() - start


def look_at(eye, target):
    forward = (mathutils.Vector(target) - mathutils.Vector(eye)).normalized()
    right = forward.cross(mathutils.Vector((0, 1, 0))).normalized()
    up = right.cross(forward)
    return mathutils.Matrix([[right[i], up[i], -forward[i], eye[i]] for i in range(3)] + [[0, 0, 0, 1]])


def read_obj(scene, job):
    bpy.ops.wm.obj_import(filepath=str(job.file), forward_axis="NEGATIVE_Z", up_axis="Y")
    made = {name: scene.surface([reflectance] * 3) if not emission else scene.surface([1] * 3, emission)
            for name, (reflectance, emission) in job.materials.items()}
    for thing in bpy.data.objects:
        if thing.type == "MESH":
            thing.matrix_world = mathutils.Matrix()  # the file's own axes
            thing.data.shade_flat()
            for slot in thing.material_slots:
                slot.material = made[slot.material.name.partition(".")[0]]
    scene.set_camera(look_at(job.eye, job.target), math.radians(job.fov))


def read_gltf(scene, job):
    bpy.ops.import_scene.gltf(filepath=str(job.file))
    for index, material in enumerate(json.loads(job.file.read_text())["materials"]):
        strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
        if any(material.get("emissiveFactor", [0])):
            new = scene.surface(material["emissiveFactor"], strength)
        else:
            new = scene.surface(material["pbrMetallicRoughness"].get("baseColorFactor", [1, 1, 1])[:3])
        bpy.data.materials[f"Material_{index}"].user_remap(new)  # the importer's name for one without
    camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA")
    camera.data.sensor_fit = "VERTICAL"
    scene.scene.camera = camera


class Cycles:
    name = "Cycles"

    def __init__(self, arguments):
        self.threads = arguments.threads

    @staticmethod
    def what():
        return f"Cycles {bpy.app.version_string}"

    def prepare(self, job, width, height):
        scene = Scene(width, height, job.depth, self.threads)
        scene.set_sky() if job.sky else scene.set_black()
        read_gltf(scene, job) if isinstance(job, CornellBox) else read_obj(scene, job)
        scene.seconds(1, 0)  # reads and builds
        return scene

    @staticmethod
    def render(scene, samples, seed, path):
        """Writes a picture of so many samples, or times as many between a quarter and five quarters of them."""
        if path:
            return scene.seconds(samples, seed, path)
        few, many = scene.seconds(samples // 4, seed), scene.seconds(samples + samples // 4, seed)
        render = scene.scene.render
        return render.resolution_x * render.resolution_y * samples / (many - few)


if __name__ == "__main__":
    main(__doc__.splitlines()[0], Cycles, ["cpu"])
