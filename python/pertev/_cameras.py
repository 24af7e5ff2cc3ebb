"""Many cameras in one call."""

import os

from . import _core
from ._arrays import on_host
from ._settings import texts_of
from .errors import InputError


class Cameras:
    """Cameras of one call of render() or render_chunks().

    poses            (N, 4, 4) or (N, 3, 4), world from camera, in the coordinates of the file
    K                (3, 3) or (N, 3, 3), or focal lengths and principal points (4,) or (N, 4), in pixels; None: the angle of
                     view is that of `fov` or of the scene's camera
    convention       "opengl" (y up, looks along -z; default), "opencv" or "blender"
    intrinsics_size  the size for which K holds; None: that of the pictures
    lens, distortion as the settings: one lens for all

    Arrays may be on a GPU. `names` are those of a file's cameras (read_cameras).
    """

    names = None

    def __init__(self, poses, K=None, *, convention=None, intrinsics_size=None, lens=None, distortion=None):
        self.poses = on_host(poses)
        self.K = K if K is None else on_host(K)
        self.settings = {"convention": convention, "intrinsics_size": intrinsics_size, "lens": lens, "distortion": distortion}

    def __len__(self):
        return len(self.poses)

    def __getitem__(self, part):
        """The cameras of a slice."""
        few = Cameras(self.poses[part], self.K if self._has_one_K() else self.K[part])
        few.settings = self.settings
        few.names = self.names and self.names[part]
        return few

    def _has_one_K(self):
        import numpy  # which `import pertev` does without

        return self.K is None or numpy.shape(self.K) in ((3, 3), (4,))

    def _arguments(self):
        """Returns the intrinsics as one row per camera or for all, and the settings of the first camera, which stand for all."""
        import numpy

        K = [self.K] if self.K is not None and self._has_one_K() else self.K
        first = {"camera_pose": numpy.asarray(self.poses[0], dtype=float).ravel() if len(self.poses) else None,
                 "intrinsics": None if K is None else numpy.asarray(K[0], dtype=float).ravel()}
        return K, {**first, **self.settings}


def read_cameras(path, *, size=None, convention=None):
    """Reads the cameras of a file: NeRF's transforms.json, COLMAP's folder, or JSON as of `pertev render --cameras`.

    size        of the pictures, (width, height), where the file has none
    convention  of the poses, where the file has none

    Raises InputError; also for cameras that differ in their lens or size, or have other settings, such as eye.
    """
    import numpy

    rows = _core.read_cameras(os.fspath(path), *(size or (0, 0)))
    others = {name for _, settings in rows for name in settings} - {"camera_pose", "intrinsics", *Cameras([]).settings}
    if others:
        raise InputError(f"{path}: {', '.join(sorted(others))}: use `pertev render --cameras` for these settings")

    def of_all(name, otherwise=None):
        values = {settings.get(name) for _, settings in rows}
        if len(values) > 1:
            raise InputError(f"{path}: its cameras differ in {name}; render them by `pertev render --cameras`")
        return values.pop() if values and values != {None} else otherwise

    def numbers(name):
        return [numpy.array(settings[name].split(","), float) for _, settings in rows if name in settings]

    poses, K = numbers("camera_pose"), numbers("intrinsics")
    if len(poses) != len(rows) or len(K) not in (0, len(rows)):
        raise InputError(f"{path}: each camera needs a camera_pose, and all or none have intrinsics")
    last = numpy.array([0, 0, 0, 1.0])
    cameras = Cameras(numpy.array([numpy.append(pose[:12], last).reshape(4, 4) for pose in poses]),
                      numpy.array([of if len(of) == 4 else of[[0, 4, 2, 5]] for of in K]) if K else None,
                      convention=of_all("convention", convention), intrinsics_size=of_all("intrinsics_size"),
                      lens=of_all("lens"), distortion=of_all("distortion"))
    cameras.names = [name for name, _ in rows]
    return cameras


def render_batch(scene, cameras, seeds, color, settings, values, out):
    seeds = [seeds] if isinstance(seeds, int) else seeds
    if cameras is None:
        return scene._render_batch(settings, texts_of(values), None, None, seeds, color, out)
    if not isinstance(cameras, Cameras):
        cameras = Cameras(cameras)
    K, own = cameras._arguments()
    return scene._render_batch(settings, texts_of({**values, **own}), cameras.poses, K, seeds, color, out)


def chunk_size(scene, cameras, color, settings, values):
    K, own = cameras._arguments()
    return scene._batch_size(settings, texts_of({**values, **own}), cameras.poses, K, color)


BatchResult, DeviceArray = _core.BatchResult, _core.DeviceArray
