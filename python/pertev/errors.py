"""Exceptions of Pertev, one for each code of docs/conventions.md. Each is also Python's own exception of its kind."""


class Error(Exception):
    """An error of Pertev, with the parts of its message.

    Attributes: `setting` and its `value` (texts; empty if it is about no setting), `reason`, and the place in the
    input: `file`, `line` (from 1; 0: none) or `pointer` (RFC 6901; empty: none).
    """

    setting = value = reason = file = pointer = ""
    line = 0


class InputError(Error, ValueError):
    """A file or a setting is wrong."""


def input_error(setting, reason, value=""):
    """Returns an InputError about a setting or an argument."""
    error = InputError(f"{setting}: {reason}")
    error.setting, error.reason, error.value = setting, reason, value
    return error


class LimitError(Error, ValueError):
    """Valid, but larger than Pertev's limits."""


class MemoryLimitError(Error, MemoryError):
    """The host or the device has too little memory."""


class DeviceError(Error, RuntimeError):
    """The GPU failed; only a new process can use it."""


class WriteError(Error, OSError):
    """A file could not be written; nothing was replaced."""


class InterruptedRender(Error, RuntimeError):
    """A time limit ended the render before there was anything to keep."""
