"""Tests the package's type stub: it is valid Python and has each setting with its type."""

import ast
import pathlib
import sys
import unittest

import pertev
from pertev import _core

sys.argv.pop(1)
STUB = ast.parse((pathlib.Path(pertev.__file__).parent / "__init__.pyi").read_text(encoding="utf-8"))
DEFINED = {node.name: node for node in STUB.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def types_of(function):
    return {argument.arg: ast.unparse(argument.annotation) for argument in DEFINED[function].args.kwonlyargs}


class Stub(unittest.TestCase):
    def test_the_stub_has_all_settings(self):
        names = {row["name"] for row in _core.settings()}
        self.assertEqual(set(types_of("load")), names)
        self.assertEqual(set(types_of("render")), names | {row["name"] for row in _core.part_settings()} | {"layers", "output", "settings", "out", "cameras", "seeds", "color",
                                                     "on_device"})
        scene, session = (next(node for node in DEFINED[name].body if getattr(node, "name", "") == "__init__")
                          for name in ("Scene", "Session"))
        self.assertEqual(sorted(argument.arg for argument in scene.args.kwonlyargs),
                         sorted(names | {"meshes", "materials", "instances", "lights", "cameras", "name"}))
        of_frames = {row["name"] for row in _core.frame_settings()} - {"cameras", "stereo"} # their pictures are files
        self.assertEqual({argument.arg for argument in session.args.kwonlyargs}, names | of_frames | {"layers"})
        self.assertLessEqual({"frames", "turntable", "real_time", "fps", "restir"}, of_frames)
        self.assertNotIn("continue", of_frames)
        self.assertGreater(len(names), 60)
        self.assertEqual(names & {"frames", "continue", "real_time", "history", "restir"}, set())
        self.assertLessEqual({"time", "shutter", "spp", "lamp", "device"}, names)

    def test_the_stub_compiles(self):
        compile(STUB, "__init__.pyi", "exec") # this detects a duplicate parameter

    def test_settings_have_their_types(self):
        types = types_of("render")
        for name, expected in {"spp": "_Int | None", "transparent": "bool | None", "fov": "_Float | None",
                               "size": "_Size | None", "eye": "_Vector | str | None",
                               "ground": "Literal['on', 'off', 'auto'] | str | None", "png_bits": "Literal['8', '16'] | str | _Int | None"}.items():
            self.assertEqual(types[name], expected)
        self.assertIn("'bidirectional'", types["integrator"])

    def test_the_type_of_a_render_follows_from_its_cameras(self):
        overloads = [node for node in STUB.body if getattr(node, "name", "") == "render"]
        found = [(ast.unparse(node.returns), *(ast.unparse(argument.annotation) for argument in node.args.kwonlyargs if argument.arg in ("cameras", "on_device")))
                 for node in overloads]
        self.assertEqual(found, [("Result", "None", "Literal[False]"), ("BatchResult", "Cameras | _Text | _Numbers", "bool"), ("BatchResult", "None", "Literal[True]")])

    def test_classes_have_their_members(self):
        for kind in (pertev.Result, pertev.Scene, pertev.Params, pertev.Session, pertev.Viewer, pertev.BatchResult,
                     pertev.DeviceArray):
            of_stub = {node.name for node in DEFINED[kind.__name__].body if isinstance(node, ast.FunctionDef)}
            own = {name for base in kind.__mro__ if base.__module__.startswith("pertev") for name in vars(base)}
            self.assertEqual({name for name in of_stub if not name.startswith("_")},
                             {name for name in own if not name.startswith("_")}, kind.__name__)

    def test_the_stub_has_all_names(self):
        imported = {alias.asname for node in STUB.body if isinstance(node, ast.ImportFrom) for alias in node.names}
        self.assertLessEqual(set(pertev.__all__), imported | set(DEFINED))


if __name__ == "__main__":
    unittest.main()
