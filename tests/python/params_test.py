"""Tests scene.params: a changed scene has the bytes of a file with these values, and only changed parts are updated."""

import base64
import json
import pathlib
import pickle
import struct
import sys
import tempfile
import time
import unittest

import numpy

import pertev

from device_argument import DEVICE

sys.argv.pop(1)
SMALL = {"size": (24, 16), "spp": 2, "device": DEVICE}


def gltf(roughness=0.5, emission=(3, 3, 3), matrix=None, lamp=5.0, fov=0.8, base=(0.8, 0.4, 0.2)):
    """A floor, a pair of triangles with its own mesh, an emissive triangle, a light and a camera."""
    floor = [(-2, 0, -2), (2, 0, -2), (2, 0, 2), (-2, 0, 2)]
    thing = [(-0.5, 0, 0), (0.5, 0, 0), (0, 1, 0.2)]
    glow = [(-1, 2, -1), (1, 2, -1), (0, 2, 1)]
    data = b"".join(struct.pack("<3f", *p) for p in floor + thing + glow)
    indices = struct.pack("<6H", 0, 2, 1, 0, 3, 2) + struct.pack("<3H", 0, 1, 2)
    spans = [(0, 4, floor), (48, 3, thing), (84, 3, glow)]
    views = [{"buffer": 0, "byteOffset": at, "byteLength": 12 * count} for at, count, _ in spans]
    views += [{"buffer": 0, "byteOffset": 120, "byteLength": 12}, {"buffer": 0, "byteOffset": 132, "byteLength": 6}]
    accessors = [{"bufferView": i, "componentType": 5126, "count": count, "type": "VEC3",
                  "min": [min(p[k] for p in points) for k in range(3)], "max": [max(p[k] for p in points) for k in range(3)]}
                 for i, (_, count, points) in enumerate(spans)]
    accessors += [{"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
                  {"bufferView": 4, "componentType": 5123, "count": 3, "type": "SCALAR"}]
    def mesh(name, of, faces, material):
        return {"name": name, "primitives": [{"attributes": {"POSITION": of}, "indices": faces, "material": material}]}
    thing_node = {"name": "thing", "mesh": 1}
    if matrix is not None:
        thing_node["matrix"] = [float(x) for x in numpy.asarray(matrix).T.ravel()]
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3, 4]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"name": "lamp", "type": "point", "intensity": lamp}]}},
        "nodes": [{"name": "floor", "mesh": 0}, thing_node, {"name": "glow", "mesh": 2},
                  {"name": "lamp", "translation": [0.5, 1.5, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
                  {"name": "front", "camera": 0, "translation": [0, 0.7, 3]}],
        "cameras": [{"name": "front", "type": "perspective", "perspective": {"yfov": fov, "znear": 0.1}}],
        "meshes": [mesh("floor", 0, 3, 0), mesh("thing", 1, 4, 0), mesh("glow", 2, 4, 1)],
        "materials": [{"name": "gold", "doubleSided": True,
                       "pbrMetallicRoughness": {"baseColorFactor": [*base, 1], "roughnessFactor": roughness,
                                                "metallicFactor": 0.5}},
                      {"name": "glow", "doubleSided": True, "emissiveFactor": [min(x, 1) for x in emission],
                       "extensions": {}, "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1]}}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": 138, "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(data + indices).decode()}]}


def hills(n=400):
    """A mesh of 2 (n - 1)^2 triangles."""
    x, y = numpy.meshgrid(numpy.arange(n), numpy.arange(n))
    vertices = numpy.stack([x.ravel(), numpy.sin(x * y).ravel(), y.ravel()], 1).astype(numpy.float32)
    at = (y[:-1, :-1] * n + x[:-1, :-1]).ravel()
    return {"vertices": vertices, "faces": numpy.concatenate([numpy.stack([at, at + n, at + 1], 1), numpy.stack([at + 1, at + n, at + n + 1], 1)])}


MOVED = [[0.8, 0, 0.6, 0.3], [0, 1, 0, 0.5], [-0.6, 0, 0.8, 0.25], [0, 0, 0, 1]]
FAR = [[1, 0, 0, 40], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
CHANGES = [("materials/gold/roughness", 0.25, {"roughness": 0.25}),
           ("materials/gold/base_color", (0.1, 0.9, 0.3), {"base": (0.1, 0.9, 0.3)}),
           ("materials/glow/emission", (0.5, 0.25, 1), {"emission": (0.5, 0.25, 1)}),
           ("instances/thing/transform", MOVED, {"matrix": MOVED}),
           ("instances/thing/transform", FAR, {"matrix": FAR}), # the scene's centre moves, too
           ("lights/lamp/intensity", (2, 2, 2), {"lamp": 2.0})]


class Params(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def file(self, name="a.gltf", **values):
        path = pathlib.Path(self.folder.name) / name
        path.write_text(json.dumps(gltf(**values)))
        return path

    def test_parameters_have_paths(self):
        scene = pertev.load(self.file())
        paths = list(scene.params)
        for path, _, _ in CHANGES:
            self.assertIn(path, paths)
        self.assertEqual(len(paths), len(scene.params))
        self.assertEqual(len(paths), len(set(paths)))
        self.assertTrue(all(scene.params[path] is not None for path in paths))

    def test_values_are_those_of_the_file(self):
        params = pertev.load(self.file(roughness=0.25, matrix=MOVED)).params
        self.assertEqual(params["materials/gold/roughness"], 0.25)
        self.assertTrue((params["instances/thing/transform"] == numpy.float32(MOVED)).all())
        self.assertTrue((params["lights/lamp/intensity"] == 5).all())
        self.assertAlmostEqual(params["cameras/front/fov"], numpy.degrees(0.8), 4)
        self.assertTrue((params["cameras/front/transform"][:3, 3] == numpy.float32((0, 0.7, 3))).all())

    def test_a_changed_scene_has_the_bytes_of_a_file_with_these_values(self):
        for path, value, values in CHANGES:
            for first in (False, True): # changes before the first picture, or between two
                with self.subTest(path=path, first=first):
                    scene = pertev.load(self.file())
                    before = None if first else pertev.render(scene, **SMALL)
                    scene.params[path] = value
                    changed = pertev.render(scene, **SMALL)
                    fresh = pertev.render(self.file("b.gltf", **values), **SMALL)
                    self.assertEqual(changed.hash, fresh.hash)
                    if before is not None:
                        self.assertNotEqual(changed.hash, before.hash)
                        self.assertNotEqual(changed.info["scene_hash"], before.info["scene_hash"])
                    self.assertTrue(numpy.allclose(scene.params[path], value))

    def test_several_changes_can_be_reverted(self):
        scene = pertev.load(self.file())
        first = pertev.render(scene, **SMALL).hash
        old = {path: scene.params[path] for path, _, _ in CHANGES}
        for path, value, _ in CHANGES:
            scene.params[path] = value
            pertev.render(scene, **SMALL)
        changes = {}
        for _, _, values in CHANGES:
            changes.update(values)
        self.assertEqual(pertev.render(scene, **SMALL).hash, pertev.render(self.file("b.gltf", **changes), **SMALL).hash)
        for path, value in old.items():
            scene.params[path] = value
        self.assertEqual(pertev.render(scene, **SMALL).hash, first)

    def test_changes_outlive_a_scene_that_is_opened_again(self):
        scene = pertev.load(self.file())
        scene.params["materials/gold/roughness"] = 0.25
        for values in ({"environment": (1, 1, 1)}, {"integrator": "radiosity", "patch_size": 0.5}, {}):
            self.assertEqual(pertev.render(scene, **SMALL, **values).hash,
                             pertev.render(self.file("b.gltf", roughness=0.25), **SMALL, **values).hash)

    def test_an_emitter_can_be_switched_off_and_on(self):
        scene = pertev.load(self.file())
        lit = pertev.render(scene, **SMALL).hash
        scene.params["materials/glow/emission"] = (0, 0, 0)
        self.assertEqual(pertev.render(scene, **SMALL).hash, pertev.render(self.file("b.gltf", emission=(0, 0, 0)), **SMALL).hash)
        scene.params["materials/glow/emission"] = (1, 1, 1)
        self.assertEqual(pertev.render(scene, **SMALL).hash, lit)

    def test_the_environment_can_be_changed(self):
        picture = numpy.zeros((8, 16, 3), numpy.float32)
        picture[:4, :6] = (4, 2, 1)
        sky = pathlib.Path(self.folder.name) / "sky.exr"
        pertev.write(sky, picture)
        scene = pertev.load(self.file(), environment=sky)
        self.assertEqual((scene.params["environment/scale"].tolist(), scene.params["environment/rotation"]), ([1, 1, 1], 0))
        pertev.render(scene, **SMALL)
        for values in ({"environment_scale": 2.5}, {"environment_rotation": 75}, {"environment_scale": 0.5, "environment_rotation": 200}):
            scene.params["environment/scale"] = numpy.full(3, values.get("environment_scale", 1))
            scene.params["environment/rotation"] = values.get("environment_rotation", 0)
            changed = pertev.render(scene, **SMALL)
            fresh = pertev.render(self.file(), environment=sky, **SMALL, **values)
            self.assertEqual(changed.hash, fresh.hash)
        self.assertEqual(changed.info["load_seconds"], pertev.render(scene, **SMALL, seed=2).info["load_seconds"])
        uniform = pertev.load(self.file(), environment=(1, 1, 1))
        pertev.render(uniform, **SMALL)
        uniform.params["environment/scale"] = (0.25, 0.5, 1)
        self.assertEqual(pertev.render(uniform, **SMALL).hash, pertev.render(self.file(), environment=(0.25, 0.5, 1), **SMALL).hash)
        self.assertNotIn("environment/scale", pertev.load(self.file()).params)
        with self.assertRaises(pertev.InputError) as caught:
            uniform.params["environment/scale"] = (-1, 0, 0)
        self.assertEqual(caught.exception.setting, "environment/scale")

    def test_cameras_can_be_changed(self):
        scene = pertev.load(self.file())
        pertev.render(scene, **SMALL)
        scene.params["cameras/front/fov"] = 60
        scene.params["cameras/front/transform"] = [[1, 0, 0, 0.5], [0, 1, 0, 0.7], [0, 0, 1, 2], [0, 0, 0, 1]]
        seen = {"eye": (0.5, 0.7, 2), "target": (0.5, 0.7, 0), "fov": 60}
        self.assertEqual(pertev.render(scene, **SMALL).hash, pertev.render(scene, **SMALL, **seen).hash)
        lens = {"aperture": 0.2, "aperture_blades": 5, "aperture_rotation": 20, "aperture_ratio": 1.5, "focus": 2}
        expected = pertev.render(scene, **SMALL, **seen, **lens).hash
        for name, value in lens.items():
            self.assertNotEqual(pertev.render(scene, **SMALL).hash, expected, name)
            scene.params[f"cameras/front/{name}"] = value
        self.assertEqual(pertev.render(scene, **SMALL).hash, expected)

    def test_lights_turn(self):
        scene = pertev.load(self.file())
        scene.params["lights/lamp/position"] = (1, 2, 3)
        self.assertTrue((scene.params["lights/lamp/position"] == (1, 2, 3)).all())
        pertev.render(scene, **SMALL)
        self.assertTrue((scene.params["lights/lamp/transform"][:3, 3] == (1, 2, 3)).all())

    def test_lights_turn_with_their_cone_their_table_and_their_picture(self):
        turned = numpy.array([[0, 1, 0, 0.25], [0, 0, 1, 1.5], [1, 0, 0, 0.5], [0, 0, 0, 1.0]])
        mirrored = turned @ numpy.diag((-1, 1, 1, 1))
        ies = pathlib.Path(self.folder.name) / "lamp.ies"
        ies.write_text("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 4 1 2 0 0 0\n1 1 50\n0 45 90\n0 90 180 360\n"
                       "9 5 1\n9 3 0\n9 0 2\n9 5 1\n")
        picture = pathlib.Path(self.folder.name) / "slide.hdr"
        picture.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n" + bytes([90, 9, 9, 130, 9, 90, 9, 130, 9, 9, 90, 130]))

        def room(name, kind, matrix):
            path = pathlib.Path(self.folder.name) / name
            numbers = " ".join(str(x) for x in matrix.ravel())
            inside = '<texture type="bitmap" name="irradiance"><string name="filename" value="slide.hdr"/></texture>' if kind == "projector" else ""
            path.write_text('<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="80"/></sensor>'
                            '<shape type="sphere"><float name="radius" value="4"/><boolean name="flip_normals" value="true"/></shape>'
                            f'<emitter type="{kind}" id="lamp"><transform name="to_world"><matrix value="{numbers}"/></transform>{inside}</emitter></scene>')
            return str(path)

        for kind, settings in (("spot", {}), ("projector", {}), ("spot", {"ies": f"lamp={ies}"})):
            for matrix in (turned, mirrored):
                with self.subTest(kind=kind, settings=settings, mirrored=matrix is mirrored):
                    scene = pertev.load(room("a.xml", kind, numpy.eye(4)), **settings)
                    right = pertev.load(room("b.xml", kind, matrix), **settings)
                    before, expected = pertev.render(scene, **SMALL), pertev.render(right, **SMALL)
                    scene.params["lights/lamp/transform"] = right.params["lights/lamp/transform"]
                    self.assertEqual(pertev.render(scene, **SMALL).hash, expected.hash)
                    self.assertNotEqual(expected.hash, before.hash)
                    # It shines along -z of its transform, which is +z of Mitsuba's.
                    numpy.testing.assert_allclose(scene.params["lights/lamp/transform"][:3, 2], -matrix[:3, 2], atol=1e-6)
                    numpy.testing.assert_allclose(scene.params["lights/lamp/direction"], matrix[:3, 2], atol=1e-6)
        scene = pertev.load(room("a.xml", "projector", numpy.eye(4)))
        scene.params["lights/lamp/direction"] = (0, 1, 0) # along its up, which another one replaces
        self.assertGreater(pertev.render(scene, **SMALL).color.max(), 0)
        self.assertTrue((scene.params["lights/lamp/direction"] == (0, 1, 0)).all())

    def test_unknown_paths_are_refused(self):
        params = pertev.load(self.file()).params
        with self.assertRaisesRegex(KeyError, "materials/gold/roughness"):
            params["materials/gold/roughnes"]
        for wrong in ("materials/gold/qwerty", "materials/silver/roughness", "qwerty"):
            with self.assertRaisesRegex(KeyError, f"there is no '{wrong}'\"$"):
                params[wrong]
        with self.assertRaises(KeyError):
            params["materials/gold"] = 1
        self.assertNotIn("lights/lamp/direction", params)

    def test_errors_of_wrong_values_name_the_path_and_change_nothing(self):
        scene = pertev.load(self.file())
        before = pertev.render(scene, **SMALL).hash
        for path, value in (("materials/gold/roughness", 2), ("materials/gold/roughness", (1, 1)),
                            ("materials/gold/roughness", float("nan")), ("materials/gold/roughness", "rough"),
                            ("materials/gold/base_color", 1), ("instances/thing/transform", numpy.zeros((4, 4))),
                            ("instances/thing/transform", numpy.diag((1, 1, 0, 1))), ("lights/lamp/intensity", (-1, 0, 0)),
                            ("instances/thing/transform", numpy.eye(3)), ("cameras/front/fov", 0),
                            ("cameras/front/aperture_blades", 2), ("cameras/front/aperture_blades", 4.5)):
            with self.subTest(path=path, value=value):
                with self.assertRaises(pertev.InputError) as caught:
                    scene.params[path] = value
                self.assertEqual(caught.exception.setting, path)
        self.assertEqual(pertev.render(scene, **SMALL).hash, before)

    def test_movable_instances_have_the_bytes_of_a_fresh_scene(self):
        for movable in ("thing", ["th?ng", "glow"], ["*"]):
            for matrix in (MOVED, FAR):
                with self.subTest(movable=movable, matrix=matrix):
                    scene = pertev.load(self.file(), movable=movable)
                    before = pertev.render(scene, **SMALL)
                    scene.params["instances/thing/transform"] = matrix
                    changed = pertev.render(scene, **SMALL)
                    fresh = pertev.render(pertev.load(self.file("b.gltf", matrix=matrix), movable=movable), **SMALL)
                    self.assertEqual(changed.hash, fresh.hash)
                    self.assertNotEqual(changed.hash, before.hash)
                    self.assertEqual(changed.info["settings"]["settings"]["movable"], [movable] if movable == "thing" else movable)
                    scene.params["instances/thing/transform"] = numpy.eye(4)
                    self.assertEqual(pertev.render(scene, **SMALL).hash, before.hash)
        with self.assertRaises(pertev.InputError) as caught:
            pertev.load(self.file(), movable=["thing", "thin"])
        self.assertEqual((caught.exception.setting, caught.exception.value), ("movable", "thin"))

    @unittest.skipUnless(DEVICE == "cpu", "devices of one kind")
    def test_movable_instances_move_on_all_devices(self):
        hashes = []
        for device in ("cpu", "cpu,cpu"):
            scene = pertev.load(self.file(), movable="thing", device=device)
            pertev.render(scene, size=(24, 16), spp=2)
            scene.params["instances/thing/transform"] = MOVED
            hashes.append(pertev.render(scene, size=(24, 16), spp=2).hash)
        self.assertEqual(hashes[0], hashes[1])

    def test_a_movable_instance_rebuilds_no_tree_but_the_tlas(self):
        seconds = {}
        robot = {"vertices": [[0, 3, 0], [4, 3, 0], [0, 3, 4]], "faces": [[0, 1, 2]]}
        for movable in ((), ["robot"]):
            begun = time.perf_counter()
            scene = pertev.Scene(meshes={"hills": hills(), "robot": robot}, materials={"a": {}}, environment=(1, 1, 1), no_bvh_cache=True,
                                 instances={"hills": {"mesh": "hills", "material": "a"}, "robot": {"mesh": "robot"}}, movable=movable)
            pertev.render(scene, **SMALL)
            opening, times = time.perf_counter() - begun, []
            for step in range(1, 6):
                begun = time.perf_counter()
                matrix = numpy.eye(4)
                matrix[:3, 3] = step, 0, step
                scene.params["instances/robot/transform"] = matrix
                pertev.render(scene, **SMALL)
                times.append(time.perf_counter() - begun)
            seconds[bool(movable)] = min(times)
            print(f"movable {movable}: opened in {opening:.3f} s, moved in {min(times):.4f} s")
        self.assertLess(seconds[True], 0.4 * seconds[False])
        self.assertLess(seconds[True], 0.1 * opening)

    def test_a_changed_material_rebuilds_no_tree(self):
        """In a scene of many triangles a changed roughness takes less than a tenth of the time to open it."""
        begun = time.perf_counter()
        scene = pertev.Scene(meshes={"hills": hills()}, materials={"a": {}},
                             instances={"hills": {"mesh": "hills", "material": "a"}}, environment=(1, 1, 1), no_bvh_cache=True)
        pertev.render(scene, **SMALL)
        opening = time.perf_counter() - begun
        times = []
        for roughness in (0.2, 0.4, 0.6):
            begun = time.perf_counter()
            scene.params["materials/a/roughness"] = roughness
            pertev.render(scene, **SMALL)
            times.append(time.perf_counter() - begun)
        self.assertLess(min(times), 0.1 * opening)

    def test_pickled_scenes_keep_their_changes(self):
        scene = pertev.load(self.file(), spp=3)
        scene.params["materials/gold/roughness"] = 0.25
        scene.params["instances/thing/transform"] = MOVED
        again = pickle.loads(pickle.dumps(scene))
        self.assertEqual(pertev.render(again, size=(24, 16)).hash, pertev.render(scene, size=(24, 16)).hash)


if __name__ == "__main__":
    unittest.main()
