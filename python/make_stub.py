#!/usr/bin/env python3
"""Prints the type stub of the package: `make_stub.py PACKAGE`. The settings are those of the table, from PACKAGE/_core."""

import importlib
import inspect
import pathlib
import sys
import textwrap

TYPES = {"bool": "bool", "int": "_Int", "float": "_Float", "size": "_Size", "vector": "_Vector | str",
         "list": "_Text | Iterable[_Text]", "text": "_Text | _Float | _Vector"}

HEAD = '''# Made by python/make_stub.py from the table of settings.
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Literal, Protocol, SupportsFloat, SupportsIndex, TypeAlias, overload

import numpy
from numpy.typing import NDArray

from .errors import DeviceError as DeviceError, Error as Error, InputError as InputError
from .errors import InterruptedRender as InterruptedRender, LimitError as LimitError
from .errors import MemoryLimitError as MemoryLimitError, MissingFileError as MissingFileError, WriteError as WriteError

class _Array(Protocol): # arrays of NumPy, PyTorch and others
    def __array__(self) -> Any: ...

class _OnDevice(Protocol): # arrays such as CuPy's, which are converted only on request
    def __dlpack__(self) -> Any: ...

_Int: TypeAlias = int | SupportsIndex
_Float: TypeAlias = float | SupportsFloat
_Vector: TypeAlias = Sequence[_Float] | Sequence[Sequence[_Float]] | _Array
_Numbers: TypeAlias = _Vector | Sequence[Sequence[Sequence[_Float]]] | _OnDevice
_Size: TypeAlias = tuple[_Int, _Int] | Sequence[_Int] | _Array | str
_Text: TypeAlias = str | os.PathLike[str]
_Floats: TypeAlias = NDArray[numpy.float32]
_Picture: TypeAlias = Result | BatchResult | _Numbers
_Parts: TypeAlias = Mapping[str, Mapping[str, Any]]

__version__: str

def builtin_scenes() -> list[str]: ...
'''

# Names of settings' types that functions without settings have, too.
ALIASES = {"_Curve": "tone_map", "_Convention": "convention", "_Lens": "lens"}

# Types of members and functions by their names, where nothing in the package tells them.
MEMBERS = {"ids": "NDArray[numpy.uint32]", "layers": "dict[str, NDArray[Any]]", "info": "dict[str, Any]", "hash": "str",
           "samples": "int", "seconds": "float", "name": "str", "params": "Params", "frame": "int | None",
           "pose": "NDArray[numpy.float64]", "K": "NDArray[numpy.float64]", "bounds": "NDArray[numpy.float64]",
           "instance_names": "list[str]", "material_names": "list[str]", "arrays": "dict[str, Any]", "shape": "tuple[int, ...]", "__cuda_array_interface__": "dict[str, Any]"}
OF_BATCHES = {"color": "Any", "noisy": "Any", "albedo": "Any", "normal": "Any", "depth": "Any", "distance": "Any", "position": "Any", "ids": "Any",
              "info": "Any", "hash": "Any"}  # many pictures have lists
SIGNATURES = {
    "merge": "(files: _Text | Iterable[_Text], *, output: _Text | Iterable[_Text] = (), partial: bool = False, "
             "tone_map: _Curve | None = None, exposure: _Float | str | None = None) -> Result",
    "read": "(path: _Text) -> _Floats",
    "read_cameras": "(path: _Text, *, size: _Size | None = None, "
                    "convention: _Convention | None = None) -> Cameras",
    "write": '(path: _Text, picture: _Picture, *, curve: _Curve = "srgb", exposure: _Float = 0.0) -> None',
    "tone_map": '(picture: _Picture, *, curve: _Curve = "agx", exposure: _Float = 0.0) -> NDArray[numpy.uint8]',
    "compare": "(picture: _Picture | _Text, reference: _Picture | _Text, *, blocks: _Int = 1) -> dict[str, float | bool]",
    "DeviceArray.__dlpack__": "(self, **how: Any) -> Any",
    "DeviceArray.__dlpack_device__": "(self) -> tuple[int, int]",
    "DeviceArray.numpy": "(self) -> NDArray[Any]",
    "BatchResult.picture": "(self, number: int = 0) -> Result",
    "BatchResult.__len__": "(self) -> int",
    "Cameras.__init__": "(self, poses: _Numbers, K: _Numbers | None = None, *, convention: _Convention | None = None, "
                        "intrinsics_size: _Size | None = None, "
                        "lens: _Lens | None = None, distortion: _Vector | str | None = None) -> None",
    "Cameras.__len__": "(self) -> int",
    "Cameras.__iter__": "(self) -> Iterator[Cameras]",
    "Cameras.__getitem__": "(self, part: slice | _Int | Sequence[int] | _Array) -> Cameras",
    "Params.__init__": "(self, scene: Scene) -> None",
    "Params.__getitem__": "(self, path: str) -> Any",
    "Params.__setitem__": "(self, path: str, value: Any) -> None",
    "Params.__iter__": "(self) -> Iterator[str]",
    "Params.__len__": "(self) -> int",
    "Scene.save": "(self, path: _Text) -> None",
    "Session.__iter__": "(self) -> Session",
    "Session.__next__": "(self) -> Result",
    "Session.reset": "(self) -> None",
    "Viewer.close": "(self) -> None",
    "Viewer.__enter__": "(self) -> Viewer",
    "Viewer.__exit__": "(self, kind: type[BaseException] | None, error: BaseException | None, "
                       "trace: TracebackType | None) -> None",
}
PARTS = ["meshes: _Parts | None = None,", "materials: _Parts | None = None,", "instances: _Parts | None = None,",
         "lights: _Parts | None = None,", "environment: Any = None,", "cameras: _Parts | None = None,",
         'name: str = "arrays",']
LAYERS = "layers: str | Iterable[str] = (),"
BATCH = ["seeds: _Int | Sequence[_Int] | _Array | _OnDevice | None = None,", "color: bool = True,", LAYERS]


def type_of(row):
    """The type of a setting's values. Choices are completed by editors; any text is accepted, since a loop over names has texts."""
    if row["choices"] and row["type"] in ("choice", "text"):
        number = " | _Int" if all(choice.isdecimal() for choice in row["choices"]) else ""
        return f"Literal[{', '.join(repr(choice) for choice in row['choices'])}] | str{number}"
    return TYPES.get(row["type"], "str")


def doc_of(thing, indent):
    return textwrap.indent(f'"""{inspect.getdoc(thing) or ""}"""', indent)


def takes_settings(name, first, returned, rows, thing):
    """A function whose last parameters are settings. Further overloads, whose `thing` is None, have no comments."""
    yield f"def {name}("
    yield from (f"    {line}" for line in first)
    for row in rows:
        if thing is not None:
            yield from textwrap.wrap(row["sentence"], 110, initial_indent="    # ", subsequent_indent="    # ")
        yield f"    {row['name']}: {type_of(row)} | None = None,"
    yield f") -> {returned}:"
    yield "    ..." if thing is None else doc_of(thing, "    ")
    yield ""


def renders(rows, thing):
    """render(), whose result depends on `cameras` and `on_device`."""
    one, many = "cameras: None = None,", "cameras: Cameras | _Text | _Numbers,"
    here, there, any_place = "on_device: Literal[False] = False,", "on_device: Literal[True],", "on_device: bool = False,"
    arrays, batch = "out: Mapping[str, Any] | _Array | None = None,", "out: BatchResult | None = None,"
    for cameras, place, out, returned in ((one, here, arrays, "Result"), (many, any_place, batch, "BatchResult"),
                                          (one, there, batch, "BatchResult")):
        yield "@overload"
        yield from takes_settings("render", ["scene: Scene | _Text,", "*,", cameras, *BATCH, "output: _Text | Iterable[_Text] = (),",
                                             "settings: _Text | None = None,", out, place], returned, rows,
                                  thing if returned == "Result" else None)


def properties_of(kind, types=MEMBERS):
    for name, value in vars(kind).items():
        if (not name.startswith("_") or name in types) and not callable(value):
            yield "@property"
            yield f"def {name}(self) -> {types.get(name, '_Floats')}:"
            yield doc_of(value, "    ")


def class_of(name, kind, bases, *members):
    yield f"class {name}{bases}:"
    yield doc_of(kind, "    ")
    for lines in members:
        yield from (textwrap.indent(line, "    ") for line in lines)
    for signature, text in SIGNATURES.items():
        if signature.startswith(name + "."):
            yield f"    def {signature.removeprefix(name + '.')}{text}: ..."
    yield ""


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    sys.path.insert(0, str(folder.parent))
    package = importlib.import_module(folder.name)
    core = importlib.import_module(f"{folder.name}._core")
    rows = core.settings()
    all_rows = list(importlib.import_module(f"{folder.name}._settings").OF_FRAMES.values())
    of_parts = rows + core.part_settings()
    scene, session, viewer = package.Scene, package.Session, package.Viewer
    types = {row["name"]: type_of(row) for row in rows}
    lines = [HEAD, *(f"{alias}: TypeAlias = {types[name]}" for alias, name in ALIASES.items()), ""]
    lines += class_of("Result", core.Result, "", properties_of(core.Result))
    lines += class_of("DeviceArray", core.DeviceArray, "", properties_of(core.DeviceArray))
    lines += class_of("BatchResult", core.BatchResult, "", properties_of(core.BatchResult, {**MEMBERS, **OF_BATCHES}))
    lines += class_of("Cameras", package.Cameras, "", ["poses: Any", "K: Any", "settings: dict[str, Any]", "names: list[str] | None", "size: str | None"])
    lines += class_of("Params", package.Params, "(Mapping[str, Any])")
    others = [row for row in rows if row["name"] != "environment"] # environment may be an array, too
    made_of = takes_settings("__init__", ["self,", "source: _Text | None = None,", "*,", *PARTS], "None", others, scene)
    lines += class_of("Scene", scene, "", properties_of(core.Scene), properties_of(scene), made_of)
    lines += class_of("Session", session, "", properties_of(core.Session),
                      takes_settings("__init__", ["self,", "scene: Scene | _Text,", "*,", LAYERS], "None", all_rows, session),
                      takes_settings("set", ["self,", "*,"], "None", all_rows, session.set))
    lines += class_of("Viewer", viewer, "", ["url: str"])
    lines += takes_settings("load", ["scene: _Text,", "*,"], "Scene", rows, package.load)
    lines += renders(of_parts, package.render)
    lines += takes_settings("render_chunks", ["scene: Scene | _Text,", "cameras: Cameras | _Text | _Numbers,", "*,",
                                              "chunk: _Int | None = None,", *BATCH, "settings: _Text | None = None,"],
                            "Iterator[BatchResult]", rows, package.render_chunks)
    lines += takes_settings("scene", ["name: str,", "*,"], "Scene", rows, package.scene)
    viewed = [row for row in all_rows if row["is_viewed"]]
    lines += takes_settings("view", ["scene: Scene | _Text,", "*,", "port: int = 0,", "host: str | None = None,", "token_file: _Text | None = None,",
                                     'jpeg: Literal["auto", "cpu"] | None = None,', "browser: bool = False,"], "Viewer", viewed, package.view)
    for name in ("merge", "read", "read_cameras", "write", "tone_map", "compare"):
        lines += [f"def {name}{SIGNATURES[name]}:", doc_of(getattr(package, name), "    "), ""]
    print("\n".join(lines))


if __name__ == "__main__":
    main()
