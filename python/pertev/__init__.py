"""Pertev: a path tracer on CPUs and GPUs whose pictures have the same bytes everywhere.

    import pertev
    picture = pertev.render("cornell-box", size=(640, 480), spp=64, layers=["depth"])
    picture.color   # numpy float32 (480, 640, 3), linear Rec. 709
    picture.depth   # numpy float32 (480, 640), metres
"""

import difflib
import os

from . import _core
from ._core import Result, builtin_scenes
from .errors import DeviceError, Error, InputError, InterruptedRender, LimitError, MemoryLimitError, WriteError

__all__ = ["DeviceError", "Error", "InputError", "InterruptedRender", "LimitError", "MemoryLimitError", "Result",
           "WriteError", "builtin_scenes", "render"]

_SETTINGS = {row["name"]: row for row in _core.settings()}


def _text(row, value):
    """Returns one value in the syntax of settings: True as "true", (1, 2, 3) as "1,2,3", a size as "640x480"."""
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, bool) or type(value).__name__ == "bool":
        if row["is_switch"]:
            return "true" if value else "false"
    elif hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0:
        number = float(value)
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    elif hasattr(value, "__iter__"):
        return ("x" if row["form"] == "WIDTHxHEIGHT" else ",").join(_text(row, item) for item in value)
    raise TypeError(f"{row['name']}: {type(value).__name__} is no value of this setting ({row['form'] or 'bool'})")


def _texts(row, value):
    if not row["is_list"]:
        return [_text(row, value)]
    is_one = isinstance(value, (str, os.PathLike)) or not hasattr(value, "__iter__")
    return [_text(row, item) for item in ([value] if is_one else value)]


def render(scene, *, layers=(), output=(), settings=None, **values):
    """Renders a picture of a scene and returns it as a Result.

    scene     a file (.gltf, .glb, .obj, .ply) or the name of a built-in scene (builtin_scenes())
    layers    names of layers to render as well: "albedo", "normal", "depth", "position", "ids", "motion"
    output    a file to write, or several: .exr .png .jpg .hdr
    settings  a file of settings, which `values` overrule
    values    any setting of docs/settings.md by its name: size=(640, 480), spp=64, eye=(0, 1, 3), device="cpu".
              None is as if it was not given.

    The picture has the bytes of `pertev render` with the same settings. The interpreter's lock is released, and Ctrl-C
    raises KeyboardInterrupt. Messages go to the logger "pertev". Raises Error (pertev.errors), and TypeError for a name
    or a type that no setting has.
    """
    given = {}
    values["aov"] = [*([layers] if isinstance(layers, str) else layers), *_aov(values.get("aov"))] or None
    for name, value in values.items():
        if name not in _SETTINGS:
            near = difflib.get_close_matches(name, _SETTINGS, 1)
            raise TypeError(f"render() has no setting '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        if value is not None:
            given[name] = _texts(_SETTINGS[name], value)
    outputs = [output] if isinstance(output, (str, os.PathLike)) else output
    return _core.render(os.fspath(scene), os.fspath(settings or ""), given, [os.fspath(path) for path in outputs])


def _aov(value):
    return () if value is None else [value] if isinstance(value, str) else value
