"""Pictures whose parts are rendered by many processes or machines, by engines that exist: Ray and Dask.

    import pertev.farm
    picture = pertev.farm.ray("scene.glb", parts=16, spp=4096, output="picture.exr")

A part is a range of samples. A part whose worker dies is rendered again by the engine, and the picture has the bytes of
one render. Workers import pertev and read the scene by its name: each must find the same file.
"""

import operator
import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, SupportsIndex, TypeAlias

from . import Result, Scene, render
from ._parts import merge
from ._process import check_process
from ._scene import scene_of

_Text: TypeAlias = str | os.PathLike[str]


def _render_part(scene, part, count, values):
    """Runs in a worker: returns the film file of a part."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "part.pvf")
        render(scene, part=(part, count), output=file, **values)
        with open(file, "rb") as film:
            return film.read()


def _source_of(scene, parts, values):
    """Checks what no machine could render, before work is distributed. Returns what workers render, and the number of parts."""
    check_process()
    if not hasattr(parts, "__index__") or operator.index(parts) < 1:
        raise ValueError(f"parts: expected a number of parts, not {parts!r}")
    for name in ("part", "part_base", "samples", "rows", "checkpoint", "out", "cameras", "on_device"):
        if values.get(name) is not None:
            raise TypeError(f"{name} is not for pictures in parts")
    return scene if scene_of(scene) is scene else os.fspath(scene), operator.index(parts)


def _merged(films, output):
    """Merges the contents of film files as they come. If all have come and cannot be merged, their files are kept, and a
    note of the exception names the folder."""
    folder, is_whole, files = tempfile.mkdtemp(), False, []
    try:
        for film in films:
            files.append(os.path.join(folder, f"{len(files)}.pvf"))
            with open(files[-1], "wb") as file:
                file.write(film)
        is_whole = True
        picture = merge(files, output=output)
    except BaseException as error:
        if is_whole:
            error.add_note(f"the parts are kept in {folder}")
        else:
            shutil.rmtree(folder)
        raise
    shutil.rmtree(folder)
    return picture


def ray(scene: Scene | _Text, *, parts: SupportsIndex, output: _Text | Sequence[_Text] = (), retries: SupportsIndex = 3,
        options: Mapping[str, Any] | None = None, **values: Any) -> Result:
    """Renders a picture by Ray, and returns it as merge() does.

    scene    a file or a built-in scene, or what load() returns
    parts    the number of parts; a few for each worker, because workers that are faster then take more
    output   as of merge()
    retries  how often a part is rendered again if its worker or machine is lost
    options  of ray.remote, as {"num_cpus": 8} or {"num_gpus": 1}
    values   as of render(), such as spp=4096 and threads=8

    Ray is started if it is not. Raises as render(); the other parts are then cancelled.
    """
    scene, parts = _source_of(scene, parts, values)
    import ray as engine  # pylint: disable=import-outside-toplevel
    if not engine.is_initialized():
        engine.init()
    task = engine.remote(max_retries=operator.index(retries), **(options or {}))(_render_part)
    waiting = [task.remote(scene, i, parts, values) for i in range(1, parts + 1)]

    def films():
        while waiting:
            done, waiting[:] = engine.wait(waiting)
            yield engine.get(done[0])

    try:
        return _merged(films(), output)
    except engine.exceptions.RayTaskError as failure:
        for one in waiting:
            engine.cancel(one)
        raise failure.cause from None


def dask(client: Any, scene: Scene | _Text, *, parts: SupportsIndex, output: _Text | Sequence[_Text] = (), **values: Any) -> Result:
    """Renders a picture by Dask, and returns it as merge() does.

    client   a distributed.Client
    The others are those of ray(). A part whose worker is lost is rendered again as often as Dask's setting
    distributed.scheduler.allowed-failures says. Raises as render(); the other parts are then cancelled.
    """
    scene, parts = _source_of(scene, parts, values)
    from distributed import as_completed  # pylint: disable=import-outside-toplevel
    waiting = client.map(lambda part: _render_part(scene, part, parts, values), range(1, parts + 1), pure=False)
    try:
        return _merged((future.result() for future in as_completed(waiting)), output)
    finally:
        client.cancel(waiting)
