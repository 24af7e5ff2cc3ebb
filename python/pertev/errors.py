"""Exceptions of Pertev, one for each code of docs/conventions.md. Each is also Python's own exception of its kind."""

import errno
import os

from . import _core


class Error(Exception):
    """An error of Pertev, with the parts of its message.

    Attributes: `setting` and its `value` (texts; empty if it is about no setting), `reason`, and the place in the
    input: `file`, `line` (from 1; 0: none) or `pointer` (RFC 6901; empty: none).
    """

    setting = value = reason = file = pointer = _marked = ""
    line = 0


class InputError(Error, ValueError):
    """A file or a setting is wrong."""


def input_error(setting, reason, value=""):
    """Returns an InputError about a setting or an argument."""
    error = InputError(f"{setting}: {reason}")
    error.setting, error.reason, error.value = setting, reason, value
    return error


class _OfFile(Error):
    """`errno` and `filename` are those of OSError, or None. Attributes of Python in place of OSError's own leave str() as it is."""

    errno = filename = strerror = None


class MissingFileError(InputError, _OfFile, FileNotFoundError):
    """A file is not there."""


class LimitError(Error, ValueError):
    """Valid, but larger than Pertev's limits."""


class MemoryLimitError(Error, MemoryError):
    """The host or the device has too little memory."""


class DeviceError(Error, RuntimeError):
    """The GPU failed; only a new process can use it."""


class WriteError(_OfFile, OSError):
    """A file could not be written; nothing was replaced."""


class InterruptedRender(Error, RuntimeError):
    """A time limit ended the render before there was anything to keep."""


_KINDS = {2: InputError, 3: LimitError, 4: MemoryLimitError, 5: DeviceError, 6: WriteError, 75: InterruptedRender}
_NUMBERS = {os.strerror(number): number for number in errno.errorcode}


def _text(marked, setting, value):
    # Names with capitals or slashes, as meshes/floor/faces, are no settings of the table.
    text = _core.phrase(marked)
    return text.replace(f"`{setting}`", setting).replace(f"`{setting}={value}`", f"{setting}='{value}'")


def made(status, marked, setting, value, reason, file, line, pointer):
    """Returns the exception for an exit status of the program, with the parts of its message. Names of settings are between
    backquotes in `marked` and `reason`."""
    name = file or value
    number = _NUMBERS.get(reason.rpartition(": ")[2]) if name else None
    kind = MissingFileError if status == 2 and number == errno.ENOENT else _KINDS[status]
    error = kind(_text(marked, setting, value))
    error._marked, error.setting, error.value, error.reason, error.file, error.line, error.pointer = marked, setting, value, reason, file, line, pointer
    if issubclass(kind, _OfFile) and name:
        error.errno, error.filename, error.strerror = number, name, reason
    return error


def rename_setting(error, setting, argument):
    """Makes an error of `made` say `argument` for a setting, as its own or as one that it names between backquotes."""
    marked, error.reason = (
        text.replace(f"`{setting}`", f"`{argument}`").replace(f"`{setting}=", f"`{argument}=") for text in (error._marked, error.reason)
    )
    error.setting = argument if error.setting == setting else error.setting
    error._marked, error.args = marked, (_text(marked, error.setting, error.value),)
