"""Pictures that are made of the film files of their parts."""

import os

from . import _core
from ._process import check_process
from ._settings import file_name, flag_of, texts_of


def names_of(files, name):
    """Returns a list of names for one file or several. Raises TypeError of the argument's name."""
    is_one = isinstance(files, (str, bytes, os.PathLike)) or not hasattr(files, "__iter__")
    return [file_name(file, name) for file in ([files] if is_one else files)]


def merge(files, *, output=(), partial=False, tone_map=None, exposure=None):
    """Returns the picture of the film files (.pvf) of its parts, which render() wrote, as a Result without pose and K.

    files    a file or several, in any order
    output   a file to write, or several: .exr .png .jpg .hdr, or .pvf with all samples
    partial  True: a picture of the samples that are there, if some are missing; rows without any are black
    tone_map, exposure  as the settings, for .png and .jpg, in place of those of the parts

    The picture has the bytes of one render of all samples. Raises InputError for parts that overlap, are missing or are of
    other pictures, and as render().
    """
    check_process()
    shown = texts_of({"tone_map": tone_map, "exposure": exposure})
    return _core.merge(names_of(files, "files"), flag_of(partial, "partial"), names_of(output, "output"), *("".join(shown.get(name, ())) for name in ("tone_map", "exposure")))
