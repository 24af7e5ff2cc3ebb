"""Pictures as arrays and files, by the functions of the program."""

import os

from . import _core
from ._settings import file_name, number_of, text_of
from .errors import input_error


def _one(picture, name="picture"):
    """Returns the Result of a BatchResult of one picture, and anything else as it is. Raises InputError."""
    if not isinstance(picture, _core.BatchResult):
        return picture
    if len(picture) != 1:
        raise input_error(name, f"a BatchResult of {len(picture)} pictures; choose one, as {name}.picture(0)")
    return picture.picture()


def _array(picture, name="picture"):
    picture = _one(picture, name)
    return picture.color if isinstance(picture, _core.Result) else picture


def read(path):
    """Returns the picture of a file (.exr .png .jpg .hdr) as float32 (height, width, 3 or 4), linear Rec. 709."""
    return _core.read(file_name(path, "path"))


def write(path, picture, *, curve="srgb", exposure=0.0):
    """Writes a Result, a BatchResult of one picture, or an array of (height, width) or with 1 to 4 channels, floats of linear Rec. 709.

    .exr and .hdr hold its values, .exr also a Result's layers and metadata; .png and .jpg show it by `curve` (as
    tone_map()) at `exposure` in stops.
    """
    picture = _one(picture)
    writer = _core.write_result if isinstance(picture, _core.Result) else _core.write
    writer(file_name(path, "path"), picture, text_of(curve, "curve"), number_of(exposure, "exposure"))


def tone_map(picture, *, curve="agx", exposure=0.0):
    """Returns uint8 (height, width, 4), sRGB: the picture times 2**exposure by a curve of the setting tone_map."""
    return _core.tone_map(_array(picture), text_of(curve, "curve"), number_of(exposure, "exposure"))


def compare(picture, reference, *, blocks=1):
    """Returns what `pertev compare` prints: rel_mse, rel_mse_98, mse, flip, hdr_flip and equal, as a dictionary.

    Each is a file, a Result, a BatchResult of one picture or an array of 3 or 4 channels; `blocks` compares means over blocks of pixels.
    """
    a, b = (read(one) if isinstance(one, (str, os.PathLike)) else _array(one, name)
            for one, name in ((picture, "picture"), (reference, "reference")))
    if not 1 <= (blocks := number_of(blocks, "blocks", whole=True)) < 2**32:
        raise input_error("blocks", "expected at least 1", str(blocks))
    return _core.compare(a, b, blocks)
