"""Tests scenes of arrays: their pictures have the bytes of a file with the same contents, and errors name the argument."""

import pathlib
import pickle
import sys
import tempfile
import unittest

import numpy

import pertev

from device_argument import DEVICE
from other_python import needs

sys.argv.pop(1)
SMALL = {"size": (24, 16), "spp": 2, "device": DEVICE}
VERTICES = numpy.float32([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)])
FACES = numpy.int64([(0, 2, 1), (0, 3, 2)])
UV = numpy.float32([(0, 0), (1, 0), (1, 1), (0, 1)])


def parts(**changes):
    made = {"meshes": {"floor": {"vertices": VERTICES, "faces": FACES, "uv": UV}},
            "materials": {"red": {"base_color": (0.8, 0.1, 0.1), "kind": "diffuse"}},
            "instances": {"floor": {"mesh": "floor", "material": "red"}},
            "lights": {"lamp": {"kind": "point", "position": (0, 1, 0), "intensity": (2, 2, 2)}},
            "cameras": {"front": {"eye": (0, 1, 3), "target": (0, 0, 0), "fov": 40}}}
    made.update(changes)
    return made


class Arrays(unittest.TestCase):
    def test_a_scene_of_arrays_has_the_bytes_of_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "a.mtl").write_text("newmtl red\nKd 0.8 0.1 0.1\n")
            file = pathlib.Path(folder) / "a.obj"
            file.write_text("mtllib a.mtl\nusemtl red\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in VERTICES) +
                            "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES))
            view = {"eye": (0, 1, 3), "target": (0, 0, 0), "environment": (1, 1, 1), "layers": ["albedo"]}
            of_arrays = pertev.Scene(meshes={"a": {"vertices": VERTICES, "faces": FACES}},
                                     materials={"red": {"base_color": (0.8, 0.1, 0.1), "kind": "diffuse"}},
                                     instances={"a": {"mesh": "a", "material": "red"}})
            a, b = (pertev.render(scene, **SMALL, **view) for scene in (of_arrays, file))
            self.assertTrue((a.albedo == b.albedo).all())
            self.assertEqual(a.hash, b.hash)

    def test_all_parts_of_a_scene_are_rendered(self):
        scene = pertev.Scene(**parts())
        picture = pertev.render(scene, **SMALL, camera="front", layers=["ids", "depth"])
        self.assertGreater(picture.color.max(), 0)
        self.assertTrue((picture.ids[10, 12] != picture.ids[0, 0]).any())
        self.assertEqual(picture.info["instances"], {"0": "floor"})
        self.assertEqual(picture.info["scene"], "arrays")
        self.assertIn("cameras/front/fov", scene.params)

    def test_arrays_are_copied(self):
        vertices = VERTICES.copy()
        scene = pertev.Scene(**parts(meshes={"floor": {"vertices": vertices, "faces": FACES}}))
        before = pertev.render(scene, **SMALL).hash
        vertices[:] = 0
        self.assertEqual(pertev.render(scene, **SMALL, environment=(0, 0, 0), seed=0).hash,
                         pertev.render(pertev.Scene(**parts(meshes={"floor": {"vertices": VERTICES, "faces": FACES}})),
                                       **SMALL, environment=(0, 0, 0)).hash)
        self.assertEqual(pertev.render(scene, **SMALL).hash, before)

    def test_arrays_may_have_any_layout_and_type(self):
        expected = pertev.render(pertev.Scene(**parts()), **SMALL).hash
        read_only = VERTICES.copy()
        read_only.flags.writeable = False
        for vertices, faces in ((VERTICES.astype(numpy.float64), FACES.astype(numpy.uint16)),
                                (numpy.asfortranarray(VERTICES), FACES.astype(numpy.int32)),
                                (VERTICES.astype(numpy.float16), FACES.tolist()), (read_only, FACES),
                                (VERTICES.astype(">f4"), FACES.astype(">i8")), (VERTICES.astype(numpy.longdouble), FACES.astype(">u2")),
                                (VERTICES.tolist(), FACES), (numpy.repeat(VERTICES, 2, 0)[::2], FACES)):
            mesh = {"vertices": vertices, "faces": faces, "uv": UV}
            self.assertEqual(pertev.render(pertev.Scene(**parts(meshes={"floor": mesh})), **SMALL).hash, expected)

    def test_dlpack_objects_are_read(self):
        class Box: # the object has no other array interface
            def __init__(self, array):
                self.array = array

            def __dlpack__(self, **options):
                return self.array.__dlpack__(**options)

            def __dlpack_device__(self):
                return self.array.__dlpack_device__()

        expected = pertev.render(pertev.Scene(**parts()), **SMALL)
        mesh = {"vertices": Box(VERTICES), "faces": Box(FACES), "uv": Box(UV)}
        self.assertEqual(pertev.render(pertev.Scene(**parts(meshes={"floor": mesh})), **SMALL).hash, expected.hash)
        self.assertTrue(numpy.shares_memory(numpy.from_dlpack(expected.color), expected.color))

    @needs("torch")
    def test_torch_tensors_are_read(self):
        import torch
        expected = pertev.render(pertev.Scene(**parts()), **SMALL)
        mesh = {"vertices": torch.from_numpy(VERTICES), "faces": torch.from_numpy(FACES), "uv": torch.from_numpy(UV)}
        self.assertEqual(pertev.render(pertev.Scene(**parts(meshes={"floor": mesh})), **SMALL).hash, expected.hash)
        color = torch.from_dlpack(expected.color)
        color[0, 0, 0] = 7
        self.assertEqual(expected.color[0, 0, 0], 7) # the memory is shared

    def test_textures_are_arrays(self):
        image = numpy.zeros((2, 2, 3), numpy.uint8)
        image[0, 0] = (255, 0, 0) # at (u, v) = (0, 0)
        pictures = {}
        for name, texture in {"bytes": image, "floats": image.astype(numpy.float32) / 255, "grey": image[..., 0]}.items():
            material = {"red": {"kind": "diffuse", "base_color": (1, 1, 1), "base_color_texture": texture}}
            pictures[name] = pertev.render(pertev.Scene(**parts(materials=material)), **SMALL, layers="albedo").albedo
        self.assertTrue((pictures["bytes"] == pictures["floats"]).all()) # 0 and 255 are the same in sRGB
        self.assertGreater(pictures["bytes"][..., 0].max(), 0.5)
        self.assertEqual(pictures["bytes"][..., 1].max(), 0)
        self.assertTrue((pictures["grey"][..., 0] == pictures["grey"][..., 1]).all())

    def test_the_albedo_of_a_conductor_is_not_that_of_its_texture(self):
        albedo = []
        for texture in ({}, {"base_color_texture": numpy.zeros((2, 2, 3), numpy.uint8)}):
            scene = pertev.Scene(**parts(materials={"red": {"kind": "conductor", "base_color": (1, 1, 1), **texture}}))
            albedo.append(pertev.render(scene, **SMALL, layers=["albedo"]).albedo)
        self.assertTrue((albedo[0] == albedo[1]).all())
        self.assertGreater(albedo[1].max(), 0.9)

    def test_an_environment_is_an_array(self):
        image = numpy.zeros((8, 16, 3), numpy.float32)
        image[:4] = 1
        scene = pertev.Scene(**parts(lights=None, environment=image))
        picture = pertev.render(scene, **SMALL)
        self.assertGreater(picture.color.mean(), 0.1)
        file = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "sky.exr"
        pertev.write(file, image)
        of_file = pertev.Scene(**parts(lights=None, environment=file))
        self.assertEqual(pertev.render(of_file, **SMALL).hash, picture.hash)
        uniform = pertev.Scene(**parts(lights=None, environment=(0.5, 0.5, 0.5)))
        self.assertEqual(pertev.render(uniform, **SMALL).hash,
                         pertev.render(pertev.Scene(**parts(lights=None)), **SMALL, environment=(0.5, 0.5, 0.5)).hash)

    def test_a_far_scene_keeps_its_digits(self):
        """Transforms are read in double, so a distant scene has the picture of one at the origin."""
        def at(x):
            moved = numpy.eye(4)
            moved[0, 3] = x
            return pertev.Scene(**parts(instances={"floor": {"mesh": "floor", "material": "red", "transform": moved}},
                                        lights={"lamp": {"position": (x, 1, 0)}},
                                        cameras={"front": {"eye": (x, 1, 3), "target": (x, 0, 0)}}))
        near, far = (pertev.render(at(x), **SMALL, layers="depth").depth for x in (0, 2.0**30))
        self.assertTrue(numpy.allclose(near, far, rtol=1e-5))

    def test_the_hash_depends_on_the_contents(self):
        def hash_of(**changes):
            return pertev.render(pertev.Scene(**parts(**changes)), **SMALL).info["scene_hash"]
        first = hash_of()
        self.assertEqual(first, hash_of())
        others = [hash_of(materials={"red": {"base_color": (0.8, 0.1, 0.2), "kind": "diffuse"}}),
                  hash_of(meshes={"floor": {"vertices": VERTICES * 2, "faces": FACES, "uv": UV}}),
                  hash_of(lights={"lamp": {"kind": "point", "position": (0, 1, 0), "intensity": (3, 2, 2)}})]
        self.assertEqual(len({first, *others}), 4)

    def test_errors_name_the_wrong_argument(self):
        mesh = {"vertices": VERTICES, "faces": FACES}
        wrong = {
            "meshes/floor/vertices": parts(meshes={"floor": {**mesh, "vertices": VERTICES[:, :2]}}),
            "meshes/floor/faces": parts(meshes={"floor": {**mesh, "faces": FACES + 2}}),
            "meshes/floor/normals": parts(meshes={"floor": {**mesh, "normals": VERTICES[:2]}}),
            "meshes/floor/uvs": parts(meshes={"floor": {**mesh, "uvs": UV}}),
            "materials/red/roughness": parts(materials={"red": {"roughness": (1, 1)}}),
            "materials/red/kind": parts(materials={"red": {"kind": "velvet"}}),
            "materials/red/double_sided": parts(materials={"red": {"double_sided": 1}}),
            "instances/floor/mesh": parts(instances={"floor": {"mesh": "none"}}),
            "instances/floor/transform": parts(instances={"floor": {"mesh": "floor", "transform": numpy.eye(3)}}),
            "lights/lamp/position": parts(lights={"lamp": {"position": "here"}}),
            "cameras/front/target": parts(cameras={"front": {"eye": (0, 0, 0), "target": (0, 0, 0)}}),
            "cameras/front/aperture_blades": parts(cameras={"front": {"eye": (0, 0, 1), "target": (0, 0, 0), "aperture_blades": 2}}),
            "environment": parts(environment=numpy.full((4, 8, 3), -1.0)),
            "meshes": parts(meshes=[mesh])}
        with self.assertRaisesRegex(pertev.InputError, r"\(height, width, 3\)"):
            pertev.Scene(**parts(environment=numpy.ones((4, 8, 4))))
        with self.assertRaisesRegex(pertev.InputError, "<U1"):
            pertev.Scene(**parts(meshes={"floor": {**mesh, "vertices": numpy.full((4, 3), "a")}}))
        wrong_types = parts(meshes={"floor": {**mesh, "faces": FACES.astype(numpy.float32)}})
        for name, arguments in [*wrong.items(), ("meshes/floor/faces", wrong_types)]:
            with self.subTest(name):
                with self.assertRaises(pertev.InputError) as caught:
                    pertev.Scene(**arguments)
                self.assertEqual(caught.exception.setting, name)

    def test_a_scene_without_meshes_or_with_a_file_and_arrays_is_refused(self):
        with self.assertRaises(TypeError):
            pertev.Scene(meshes={})
        with self.assertRaises(TypeError):
            pertev.Scene("cornell-box", meshes={}, instances={})
        with self.assertRaises(pertev.Error):
            pertev.render(pertev.Scene(meshes={}, instances={}))

    def test_a_scene_of_arrays_has_params(self):
        scene = pertev.Scene(**parts())
        pertev.render(scene, **SMALL)
        scene.params["materials/red/base_color"] = (0.1, 0.8, 0.1)
        fresh = pertev.Scene(**parts(materials={"red": {"base_color": (0.1, 0.8, 0.1), "kind": "diffuse"}}))
        self.assertEqual(pertev.render(scene, **SMALL).hash, pertev.render(fresh, **SMALL).hash)

    def test_a_scene_of_arrays_is_not_pickled(self):
        with self.assertRaises(TypeError):
            pickle.dumps(pertev.Scene(**parts()))


if __name__ == "__main__":
    unittest.main()
