"""Pertev: a path tracer on CPUs and GPUs whose pictures have the same bytes everywhere.

    import pertev
    scene = pertev.load("cornell-box")
    picture = pertev.render(scene, size=(640, 480), spp=64, layers=["depth"])
    picture.color   # numpy float32 (480, 640, 3), linear Rec. 709
    picture.depth   # numpy float32 (480, 640), metres
"""

import difflib
import os

from . import _core
from ._core import Result, Scene, builtin_scenes
from .errors import DeviceError, Error, InputError, InterruptedRender, LimitError, MemoryLimitError, WriteError

__all__ = ["DeviceError", "Error", "InputError", "InterruptedRender", "LimitError", "MemoryLimitError", "Result",
           "Scene", "WriteError", "builtin_scenes", "load", "render"]

_SETTINGS = {row["name"]: row for row in _core.settings()}


def _text(row, value):
    """Returns one value in the syntax of settings: True as "true", (1, 2, 3) as "1,2,3", a size as "640x480"."""
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"):  # names in Python, NumPy 2 and 1
        if row["type"] == "bool":
            return "true" if value else "false"
    elif isinstance(value, int):
        return str(value)
    elif hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0:
        number = float(value)
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    elif hasattr(value, "__iter__"):
        return ("x" if row["type"] == "size" else ",").join(_text(row, item) for item in value)
    raise TypeError(f"{row['name']}: {type(value).__name__} is no value of this setting ({row['form'] or 'bool'})")


def _texts(row, value):
    if row["type"] != "list":
        return [_text(row, value)]
    is_one = isinstance(value, (str, os.PathLike)) or not hasattr(value, "__iter__")
    return [_text(row, item) for item in ([value] if is_one else value)]


def _given(values):
    """Returns the texts of all values that are not None, by the names of their settings."""
    given = {}
    for name, value in values.items():
        if name not in _SETTINGS:
            near = difflib.get_close_matches(name, _SETTINGS, 1)
            raise TypeError(f"there is no setting '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        if value is not None:
            given[name] = _texts(_SETTINGS[name], value)
    return given


def load(scene, **values):
    """Opens a scene, builds its trees, and returns it as a Scene, of which render() makes pictures.

    scene   a file (.gltf, .glb, .obj, .ply) or the name of a built-in scene (builtin_scenes())
    values  settings, as render() has them, for all pictures that do not overrule them

    A picture with another camera, size or integrator, or with other samples, takes the scene as it is; other settings,
    such as `device`, `time` or `environment`, open it again. Raises as render().
    """
    opened = Scene(os.fspath(scene), _given(values))
    opened._open()
    return opened


def render(scene, *, layers=(), output=(), settings=None, **values):
    """Renders a picture of a scene and returns it as a Result.

    scene     what load() returns, or as its `scene`
    layers    names of layers to render as well: "albedo", "normal", "depth", "position", "ids", "motion"
    output    a file to write, or several: .exr .png .jpg .hdr
    settings  a file of settings, which `values` overrule
    values    any setting of docs/settings.md by its name: size=(640, 480), spp=64, eye=(0, 1, 3), device="cpu".
              None is as if it was not given.

    The picture has the bytes of `pertev render` with the same settings. The interpreter's lock is released, and Ctrl-C
    raises KeyboardInterrupt. Messages go to the logger "pertev". Raises Error (pertev.errors), and TypeError for a name
    or a type that no setting has.
    """
    aov = () if values.get("aov") is None else values["aov"]
    requested = [name for names in (layers, aov) for name in ([names] if isinstance(names, str) else names)]
    given = _given({**values, "aov": requested or None})
    outputs = [output] if isinstance(output, (str, os.PathLike)) else output
    used = scene if isinstance(scene, Scene) else Scene(os.fspath(scene), {})
    return used._render(os.fspath(settings or ""), given, [os.fspath(path) for path in outputs])
