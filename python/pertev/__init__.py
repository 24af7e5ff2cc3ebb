"""Pertev: a path tracer on CPUs and GPUs whose pictures have the same bytes everywhere.

    import pertev
    scene = pertev.load("cornell-box")
    picture = pertev.render(scene, size=(640, 480), spp=64, layers=["depth"])
    picture.color   # numpy float32 (480, 640, 3), linear Rec. 709
    picture.depth   # numpy float32 (480, 640), metres
"""

import importlib
from collections.abc import Mapping

from ._cameras import BatchResult, Cameras, DeviceArray, cameras_of, chunk_size, read_cameras, render_batch, seeds_of
from ._core import Result, __version__, builtin_scenes
from ._images import compare, read, tone_map, write
from ._process import check_process
from ._parts import merge, names_of
from ._scene import Params, Scene, Session, load, scene, scene_of
from ._settings import OF_PARTS, OF_STILLS, file_name, flag_of, number_of, of_layers, texts_of, with_layers
from ._viewer import Viewer, view
from .errors import (DeviceError, Error, InputError, InterruptedRender, LimitError, MemoryLimitError, MissingFileError, WriteError,
                     input_error)

__all__ = ["BatchResult", "Cameras", "DeviceArray", "DeviceError", "Error", "InputError", "InterruptedRender", "LimitError",
           "MemoryLimitError", "MissingFileError", "Params", "Result", "Scene", "Session", "Viewer", "WriteError", "builtin_scenes", "compare",
           "load", "merge", "read", "read_cameras", "render", "render_chunks", "scene", "tone_map", "view", "write"]


def __getattr__(name):
    if name == "farm":  # few need it
        return importlib.import_module(".farm", __name__)
    raise AttributeError(f"module 'pertev' has no attribute '{name}'")


def render(scene, *, cameras=None, seeds=None, color=True, layers=(), output=(), settings=None, out=None, on_device=False,
           **values):
    """Renders a picture of a scene and returns it as a Result.

    scene     what load() returns, or as its `scene`
    cameras   Cameras, an array of poses (N, 4, 4), or a file of read_cameras(): all pictures are one job if they are not denoised,
              and the call returns a BatchResult. It excludes settings that place one camera: camera, eye, camera_pose ...
    seeds     of these pictures: one for all or (N,); None: that of the setting
    color     False with layers_at="centre" and many cameras or `on_device`: only layers are made
    layers    names of layers to render as well: "albedo", "normal", "depth", "distance", "position", "ids", "motion",
              "uv", "crypto_object", "crypto_material", "samples", "variance"; of these not the last six
              with `cameras` or `on_device`
    output    a file to write, or several: .exr .png .jpg .hdr
    settings  a file of settings, which `values` overrule
    out       arrays to fill, by the names of the Result's attributes: {"color": array}, which are then those of the
              Result, beside `color`; nothing else of the picture's size is allocated. An array alone is that of `color`.
              With `cameras` or `on_device` an earlier BatchResult of the same scene, whose arrays are filled again
    on_device True: the arrays stay in the memory of the device, and the call returns them as a BatchResult
    values    any setting of docs/settings.md by its name: size=(640, 480), spp=64, eye=(0, 1, 3), device="cpu".
              None is as if it was not given. part=(1, 4), samples=(64, 128) and checkpoint=FILE are for a single picture;
              a part is an output="part.1.pvf" for merge().

    The picture has the bytes of `pertev render` with the same settings. The interpreter's lock is released, and Ctrl-C
    raises KeyboardInterrupt. Messages go to the logger "pertev", except those of a call that repeats the last one on an
    open scene. Raises Error (pertev.errors), and TypeError for a name or a type that no setting has.
    """
    check_process()
    used = scene_of(scene)
    color = flag_of(color, "color")
    if flag_of(on_device, "on_device") or cameras is not None:
        for name in OF_PARTS.keys() & {name for name, value in values.items() if value is not None}:
            raise TypeError(f"{name} is of a single picture, not of many cameras or of arrays on the device")
        if output:
            raise TypeError("output: pictures of many cameras or on the device are arrays; `pertev render` writes files")
        with of_layers(values):
            return render_batch(used, cameras_of(cameras, values), seeds, color, _settings_file(settings),
                                with_layers(values, layers), out)
    if seeds is not None or not color:
        raise TypeError("seeds and color are for many `cameras`, or for `on_device`")
    if isinstance(out, BatchResult):
        raise TypeError("out: a BatchResult is for `cameras` or `on_device`; expected arrays, as {'color': array}")
    out = out if out is None else dict(out) if isinstance(out, Mapping) else {"color": out}
    with of_layers(values):
        return used._render(_settings_file(settings), texts_of(with_layers(values, layers), OF_STILLS),
                            names_of(output, "output"), out)


def render_chunks(scene, cameras, *, chunk=None, seeds=None, color=True, layers=(), settings=None, **values):
    """Renders pictures by many cameras in parts, and yields a BatchResult for each.

    chunk   the number of cameras of a part, at least 1; None: as many as keep the device busy and fit into its memory

    The other arguments are those of render(). A BatchResult that is no longer used frees its memory. Raises ValueError
    for a chunk below 1, and for seeds that are neither one nor one per camera. The call itself checks all arguments.
    """
    check_process()
    used = scene_of(scene)
    cameras, color = cameras_of(cameras, values), flag_of(color, "color")
    if cameras is None:
        raise TypeError("cameras: expected Cameras, an array of poses (N, 4, 4), or a file")
    if chunk is not None and (chunk := number_of(chunk, "chunk", whole=True)) < 1:
        raise input_error("chunk", f"expected at least 1, not {chunk}", str(chunk))
    seeds, settings = seeds_of(seeds, len(cameras)), _settings_file(settings)
    with of_layers(values):
        given = with_layers(values, layers)
        at_once = chunk_size(used, cameras, seeds, color, settings, given)
    return _chunks(used, cameras, chunk or at_once, seeds, color, settings, given)


def _chunks(scene, cameras, chunk, seeds, color, settings, values):
    one_for_all = seeds is None or len(seeds) == 1
    for first in range(0, len(cameras), chunk):
        part = slice(first, first + chunk)
        yield render_batch(scene, cameras[part], seeds if one_for_all else seeds[part], color, settings, values, None)


def _settings_file(settings):
    return "" if settings is None else file_name(settings, "settings")
