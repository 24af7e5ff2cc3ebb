"""Pertev: a path tracer on CPUs and GPUs whose pictures have the same bytes everywhere.

    import pertev
    scene = pertev.load("cornell-box")
    picture = pertev.render(scene, size=(640, 480), spp=64, layers=["depth"])
    picture.color   # numpy float32 (480, 640, 3), linear Rec. 709
    picture.depth   # numpy float32 (480, 640), metres
"""

import os

from ._core import Result, builtin_scenes
from ._images import compare, read, tone_map, write
from ._process import check_process
from ._scene import Params, Scene, Session, load
from ._settings import texts_of, with_layers
from ._viewer import Viewer, view
from .errors import DeviceError, Error, InputError, InterruptedRender, LimitError, MemoryLimitError, WriteError

__all__ = ["DeviceError", "Error", "InputError", "InterruptedRender", "LimitError", "MemoryLimitError", "Params", "Result",
           "Scene", "Session", "Viewer", "WriteError", "builtin_scenes", "compare", "load", "read", "render", "tone_map",
           "view", "write"]


def render(scene, *, layers=(), output=(), settings=None, out=None, **values):
    """Renders a picture of a scene and returns it as a Result.

    scene     what load() returns, or as its `scene`
    layers    names of layers to render as well: "albedo", "normal", "depth", "position", "ids", "motion"
    output    a file to write, or several: .exr .png .jpg .hdr
    settings  a file of settings, which `values` overrule
    out       arrays to fill, by the names of the Result's attributes: {"color": array}
    values    any setting of docs/settings.md by its name: size=(640, 480), spp=64, eye=(0, 1, 3), device="cpu".
              None is as if it was not given.

    The picture has the bytes of `pertev render` with the same settings. The interpreter's lock is released, and Ctrl-C
    raises KeyboardInterrupt. Messages go to the logger "pertev", but for those of a call that repeats the last one on an
    open scene. Raises Error (pertev.errors), and TypeError for a name or a type that no setting has.
    """
    check_process()
    used = scene if isinstance(scene, Scene) else Scene(scene)
    outputs = [output] if isinstance(output, (str, os.PathLike)) else output
    made = used._render(os.fspath(settings or ""), texts_of(with_layers(values, layers)), [os.fspath(path) for path in outputs])
    if out is not None:
        made._fill(out)
    return made
