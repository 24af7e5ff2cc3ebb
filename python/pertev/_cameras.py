"""Many cameras in one call."""

from . import _core
from ._settings import texts_of


class Cameras:
    """Cameras of one call of render() or render_chunks().

    poses            (N, 4, 4) or (N, 3, 4), world from camera, in the coordinates of the file
    K                (3, 3) or (N, 3, 3), or focal lengths and principal points (4,) or (N, 4), in pixels; None: the angle of
                     view is that of `fov` or of the scene's camera
    convention       "opengl" (y up, looks along -z; default), "opencv" or "blender"
    intrinsics_size  the size for which K holds; None: that of the pictures
    lens, distortion as the settings: one lens for all
    """

    def __init__(self, poses, K=None, *, convention=None, intrinsics_size=None, lens=None, distortion=None):
        self.poses = poses
        self.K = K
        self.settings = {"convention": convention, "intrinsics_size": intrinsics_size, "lens": lens, "distortion": distortion}

    def __len__(self):
        return len(self.poses)

    def __getitem__(self, part):
        """The cameras of a slice."""
        few = Cameras(self.poses[part], self.K if self._has_one_K() else self.K[part])
        few.settings = self.settings
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


def render_batch(scene, cameras, seeds, color, settings, values, out):
    if not isinstance(cameras, Cameras):
        cameras = Cameras(cameras)
    K, own = cameras._arguments()
    seeds = [seeds] if isinstance(seeds, int) else seeds
    return scene._render_batch(settings, texts_of({**values, **own}), cameras.poses, K, seeds, color, out)


def chunk_size(scene, cameras, color, settings, values):
    K, own = cameras._arguments()
    return scene._batch_size(settings, texts_of({**values, **own}), cameras.poses, K, color)


BatchResult, DeviceArray = _core.BatchResult, _core.DeviceArray
