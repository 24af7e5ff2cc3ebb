"""Many cameras in one call."""

import operator
import os

from . import _core
from ._arrays import on_host
from ._settings import OF_FRAMES, OF_PICTURES, OF_PROGRAM, file_name, number_of, suggested, texts_of
from .errors import InputError, input_error


_NOT_WITH = OF_PICTURES.keys() & OF_PROGRAM["cameras"]["excludes"].split()  # they place one camera
_OWN = ("convention", "intrinsics_size", "lens", "distortion")  # settings that Cameras may have


def _numbers(value, name):
    """Returns an array of NumPy. Raises InputError of the argument's name."""
    import numpy  # not needed by `import pertev` itself

    try:
        array = numpy.asarray(on_host(value))
    except ValueError as error: # rows of different lengths
        raise input_error(name, f"not an array of numbers: {error}") from None
    if array.dtype.kind not in "fiu" or array.ndim == 0:
        raise input_error(name, f"expected an array of numbers, not {array.dtype if array.ndim else type(value).__name__}")
    return array


def _of_shape(array, name, expected, *shapes):
    """Returns the array. Raises InputError unless it has one of the shapes, each a number of axes and the last lengths."""
    if not any(array.ndim == axes and array.shape[axes - len(last):] == last for axes, last in shapes):
        raise input_error(name, f"the array's shape is {array.shape}; expected {expected}")
    return array


class Cameras:
    """Cameras of one call of render() or render_chunks().

    poses            (N, 4, 4) or (N, 3, 4), world from camera, in the coordinates of the file
    K                (3, 3) or (N, 3, 3), or focal lengths and principal points (4,) or (N, 4), in pixels, where the
                     first pixel's centre is (0.5, 0.5), in OpenCV (0, 0); None: the angle of view is that of `fov` or of the scene's
                     camera
    convention       "opengl" (y up, looks along -z; default), "opencv" or "blender"
    intrinsics_size  the size for which K holds; None: that of the pictures
    lens, distortion as the settings: one lens for all

    What is left out is that of the call, as its `convention` or `intrinsics`, and what differs from the call is an error.

    Arrays may be on a GPU. `names` are those of a file's cameras (read_cameras), and `size` is that of pictures for which the
    call has none. Raises InputError for arrays of other shapes.
    """

    names = size = None

    def __init__(self, poses, K=None, *, convention=None, intrinsics_size=None, lens=None, distortion=None):
        self.poses = _of_shape(_numbers(poses, "cameras"), "cameras", "(N, 4, 4) or (N, 3, 4)", (3, (4, 4)), (3, (3, 4)))
        self.K = K if K is None else _of_shape(_numbers(K, "K"), "K", "(3, 3) or (N, 3, 3), or (4,) or (N, 4)",
                                               (2, (3, 3)), (3, (3, 3)), (1, (4,)), (2, (4,)))
        if not self._has_one_K() and len(self.K) not in (1, len(self.poses)):
            raise input_error("K", f"expected one, or one for each of {len(self.poses)} cameras, not {len(self.K)}")
        self.settings = dict(zip(_OWN, (convention, intrinsics_size, lens, distortion)))

    def __len__(self):
        return len(self.poses)

    def __getitem__(self, part):
        """The cameras of a slice, or the one of a number: Cameras too."""
        import numpy

        numbers = numpy.atleast_1d(numpy.arange(len(self))[part])
        few = Cameras(self.poses[numbers], self.K if self._has_one_K() or len(self.K) == 1 else self.K[numbers])
        few.settings = self.settings
        few.names, few.size = self.names and [self.names[number] for number in numbers], self.size
        return few

    def __repr__(self):
        given = [f", {name}={value!r}" for name, value in self.settings.items() if value is not None]
        return f"<pertev.Cameras of {len(self)} poses{'' if self.K is None else ', K'}{''.join(given)}>"

    def _has_one_K(self):
        return self.K is None or self.K.shape in ((3, 3), (4,))

    def _arguments(self, values):
        """Returns the intrinsics as one row per camera or for all, and the texts of a call's settings, in which the first camera
        stands for all."""
        import numpy

        K = [self.K] if self.K is not None and self._has_one_K() else self.K
        first = {"camera_pose": self.poses[0] if len(self.poses) else None, "intrinsics": None if K is None else K[0]}
        # Numbers that are not finite are refused with the arrays.
        rows = {name: numpy.nan_to_num(row.astype(float)).ravel() for name, row in first.items() if row is not None}
        given = {name: value for name, value in values.items() if value is not None}
        for name in given:
            if name in _NOT_WITH:
                raise input_error(name, "cannot be combined with cameras; leave out one of them")
        if K is not None and "intrinsics" in given:
            raise input_error("intrinsics", "cannot be combined with cameras that have K; leave out one of them")
        texts, own = texts_of({"size": self.size, **given, **rows}), texts_of(self.settings)
        for name in own.keys() & texts.keys():
            if own[name] != texts[name]:
                raise input_error(name, f"that of the call differs from that of the cameras, {', '.join(own[name])}", ", ".join(texts[name]))
        return K, {**texts, **own}


def _of_file(path, reason):
    error = InputError(f"{path}: {reason}")
    error.file, error.reason = path, reason
    return error


def _size_of(size):
    """Returns width and height of the setting `size`, zeros of None. Raises TypeError and InputError of its name."""
    text = texts_of({"size": size}).get("size", ["0x0"])[0]
    numbers = text.lower().split("x")
    if len(numbers) != 2 or not all(number.isdecimal() and int(number) < 2**32 for number in numbers):
        raise input_error("size", "expected (width, height)", text)
    return int(numbers[0]), int(numbers[1])


def read_cameras(path, *, size=None, convention=None):
    """Reads the cameras of a file: NeRF's transforms.json, COLMAP's folder, or JSON as of `pertev render --cameras`.

    size        of the pictures, (width, height), where the file has none
    convention  of the poses, where the file has none

    Raises InputError; also for cameras that differ in their lens or size, or have other settings, such as eye.
    """
    import numpy

    width, height = _size_of(size)
    rows = _core.read_cameras(path := file_name(path, "path"), width, height)
    others = {name for _, settings in rows for name in settings} - {"camera_pose", "intrinsics", "size", *_OWN}
    if unknown := others - OF_FRAMES.keys():
        raise _of_file(path, f"there is no setting '{(first := min(unknown))}'{suggested(first, OF_FRAMES)}")
    if others:
        raise _of_file(path, f"{', '.join(sorted(others))}: Cameras have camera_pose and intrinsics; `pertev render --cameras` takes these settings, too")

    def of_all(name, otherwise=None):
        values = {settings.get(name) for _, settings in rows}
        if len(values) > 1:
            raise _of_file(path, f"its cameras differ in {name}; render them by `pertev render --cameras`")
        return values.pop() if values and values != {None} else otherwise

    def numbers(name, *counts):
        found = []
        for camera, text in ((camera, settings[name]) for camera, settings in rows if name in settings):
            try:
                found.append(numpy.array(text.split(","), float))
            except ValueError:
                raise _of_file(path, f"camera '{camera}': {name}: expected numbers, not '{text}'") from None
            if len(found[-1]) not in counts:
                raise _of_file(path, f"camera '{camera}': {name}: expected {' or '.join(map(str, counts))} numbers, not {len(found[-1])}")
        return found

    poses, K = numbers("camera_pose", 12, 16), numbers("intrinsics", 4, 9)
    if len(poses) != len(rows) or len(K) not in (0, len(rows)):
        raise _of_file(path, "each camera needs a camera_pose, and all or none have intrinsics")
    last = numpy.array([0, 0, 0, 1.0])
    cameras = Cameras(numpy.array([numpy.append(pose[:12], last) for pose in poses]).reshape(-1, 4, 4),
                      numpy.array([of if len(of) == 4 else of[[0, 4, 2, 5]] for of in K]) if K else None,
                      convention=of_all("convention", convention), intrinsics_size=of_all("intrinsics_size"),
                      lens=of_all("lens"), distortion=of_all("distortion"))
    cameras.names, cameras.size = [name for name, _ in rows], of_all("size")
    return cameras


def cameras_of(cameras, values):
    """Returns the argument `cameras` of render() as Cameras; None stays None. `values` are the settings of the call."""
    if cameras is None or isinstance(cameras, Cameras):
        return cameras
    if isinstance(cameras, (str, os.PathLike)):
        return read_cameras(cameras, size=values.get("size"), convention=values.get("convention"))
    return Cameras(cameras)


def seeds_of(seeds, count):
    """Returns a list of one seed for what stands for all pictures, and None or an array for each of `count` as it is.
    Raises InputError."""
    if seeds is None:
        return None
    if not hasattr(seeds, "__len__") or getattr(seeds, "ndim", 1) == 0:
        try:
            return [operator.index(seeds)]
        except TypeError:
            raise input_error("seeds", f"expected whole numbers, not {type(seeds).__name__}") from None
    if len(seeds) not in (1, count):
        raise input_error("seeds", f"expected one, or one for each of {count} cameras, not {len(seeds)}")
    return seeds


def render_batch(scene, cameras, seeds, color, settings, values, out):
    seeds = seeds_of(seeds, 1 if cameras is None else len(cameras))
    if cameras is None:
        own = values if seeds is None else {**values, "seed": seeds[0]}
        return scene._render_batch(settings, texts_of(own), None, None, None, color, out)
    K, texts = cameras._arguments(values)
    return scene._render_batch(settings, texts, cameras.poses, K, seeds, color, out)


def chunk_size(scene, cameras, seeds, color, settings, values):
    """Returns how many pictures are rendered at once. Raises what a render of the first would."""
    K, texts = cameras._arguments(values)
    return scene._batch_size(settings, texts, cameras.poses, K, seeds, color)


BatchResult, DeviceArray = _core.BatchResult, _core.DeviceArray
