"""Settings as texts: Python's values in the syntax of the table."""

import math
import operator
import os
from collections.abc import Mapping

from . import _core
from ._arrays import on_host
from .errors import Error, input_error, rename_setting

OF_PICTURES = {row["name"]: row for row in _core.settings()}
OF_SEQUENCES = {row["name"]: row for row in _core.frame_settings()}
OF_PROGRAM = {name: OF_SEQUENCES.pop(name) for name in ("cameras", "stereo")}  # their pictures are files
OF_FRAMES = {**OF_PICTURES, **OF_SEQUENCES}
OF_PARTS = {row["name"]: row for row in _core.part_settings()}
OF_STILLS = {**OF_PICTURES, **OF_PARTS}
ARGUMENTS = ("cameras", "color", "on_device", "out", "output", "seeds", "settings")  # render() has them beside settings
SEPARATORS = {"A:B": ":", "I/N": "/"}  # by the form of a value
TOO_LARGE = "the number is too large"
MATRICES = {"camera_pose": ((4, 4), (3, 4)), "intrinsics": ((3, 3),)}  # shapes of settings that may have rows
BOOLS = ("bool", "bool_")  # names in Python and NumPy 2, and in NumPy 1


def file_name(value, name):
    """Returns a file's name as a text. Raises TypeError and InputError of the argument's name."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise TypeError(f"{name}: expected a file's name, not {type(value).__name__}")
    return _encodable(os.fsdecode(value), name)


def text_of(value, name):
    """Returns a text. Raises TypeError and InputError of the argument's name."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a text, not {type(value).__name__}")
    return _encodable(value, name)


def flag_of(value, name):
    """Returns True or False. Raises TypeError of the argument's name."""
    if isinstance(value, bool) or type(value).__name__ in BOOLS:
        return bool(value)
    raise TypeError(f"{name}: expected True or False, not {value!r}"[:200])


def _encodable(text, name):
    if "\0" in text:  # the program's texts would end there
        raise input_error(name, f"{ascii(text)} has a null character")
    if text.isascii():
        return text
    try:
        text.encode()
    except UnicodeEncodeError:
        raise input_error(name, f"{ascii(text)} is not a text of Unicode") from None
    return text


def number_of(value, name, whole=False):
    """Returns a finite number as Python's float or int. Raises TypeError and InputError of the argument's name."""
    try:
        number = operator.index(value) if whole else float(value)
    except OverflowError:
        raise input_error(name, TOO_LARGE) from None
    except (TypeError, ValueError):
        kind = "a whole number" if whole else "a number"
        raise TypeError(f"{name}: expected {kind}, not {value!r}"[:200]) from None
    if whole and not -(2**63) <= number < 2**63:
        raise input_error(name, TOO_LARGE)
    if not math.isfinite(number):
        raise input_error(name, f"expected a finite number, not {number}", str(number))
    return number


def _text(row, value):
    """Returns one value in the syntax of settings: True as "true", (1, 2, 3) as "1,2,3", a size as "640x480", a part as "1/4"."""
    if isinstance(value, list) and len(value) == 1 and isinstance(value[0], str):
        value = value[0] # a value of texts_of()
    if isinstance(value, str):
        return _encodable(value, row["name"])
    if isinstance(value, os.PathLike):
        return file_name(value, row["name"])
    if hasattr(value, "__dlpack__"):
        value = on_host(value)
    if hasattr(value, "__next__"):
        value = list(value)
    if isinstance(value, (bytes, bytearray, memoryview, complex)) or getattr(getattr(value, "dtype", None), "kind", "") == "c":
        pass # bytes are numbers for iter(), and NumPy's complex ones have a float()
    elif isinstance(value, bool) or type(value).__name__ in BOOLS:
        if row["type"] == "bool":
            return "true" if value else "false"
    elif hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0:
        if row["type"] == "bool":
            raise input_error(row["name"], f"expected True or False, not {value}", str(value))
        try:
            return str(operator.index(value))  # exact: integers of Python, NumPy or PyTorch
        except TypeError:
            number = number_of(value, row["name"])
        except ValueError:  # it has more digits than Python writes
            raise input_error(row["name"], TOO_LARGE) from None
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    elif hasattr(value, "__getitem__") and not isinstance(value, Mapping) and row["type"] not in ("bool", "int", "float"):
        _check_shape(row["name"], value)
        return ("x" if row["type"] == "size" else SEPARATORS.get(row["form"], ",")).join(_text(row, item) for item in value)
    raise TypeError(f"{row['name']}: {type(value).__name__} is not a value of this setting ({row['form'] or 'bool'})")


def _check_shape(name, value):
    """Raises InputError for rows of numbers, unless the setting may have them."""
    shape = getattr(value, "shape", None)
    if shape is None:
        lengths = [len(item) for item in value if hasattr(item, "__len__") and not isinstance(item, str) and getattr(item, "ndim", 1) > 0]
        shape = (len(value), *lengths[:1]) if len(set(lengths)) < 2 else (len(value), "?")
    if len(shape) > 1 and shape not in MATRICES.get(name, ()):
        expected = " or ".join(map(str, MATRICES.get(name, ()))) or "one row of numbers"
        raise input_error(name, f"the shape is {tuple(shape)}; expected {expected}", str(tuple(shape)))


def _texts(row, value):
    if row["type"] != "list":
        return [_text(row, value)]
    is_one = isinstance(value, (str, os.PathLike)) or not hasattr(value, "__iter__")
    return [_text(row, item) for item in ([value] if is_one else value)]


def _unknown(name, known):
    """Returns the TypeError of a name that the call does not have."""
    for of, names in (("pertev.render", (*OF_PARTS, *ARGUMENTS)), ("pertev.Session", OF_SEQUENCES), ("`pertev render` on the command line", OF_PROGRAM),
                      ("pictures, not for the viewer", OF_PICTURES)):
        if name in names:
            return TypeError(f"'{name}' is for {of}")
    near = suggested(name, (*known, *(ARGUMENTS if known is OF_STILLS else ())))
    return TypeError(f"there is no setting '{name}'{near}")


def nearest(name, known):
    """Returns the one of `known` that `name` probably means; empty if there is none."""
    return _core.suggest_name(ascii(name)[1:-1], list(known))


def suggested(name, known):
    """Returns "; did you mean 'NAME'?" for the nearest name, or nothing."""
    near = nearest(name, known)
    return f"; did you mean '{near}'?" if near else ""


def texts_of(values, known=OF_PICTURES):
    """Returns the texts of all values that are not None, by the names of their settings."""
    given = {}
    for name, value in values.items():
        if name not in known:
            raise _unknown(name, known)
        if value is not None:
            given[name] = _texts(known[name], value)
    return given


def with_layers(values, layers):
    """Returns the values with the names of layers as those of `aov`. Raises TypeError and InputError of the argument's name."""
    if isinstance(layers, (tuple, list)) and not layers and values.get("aov") is None:
        return values
    requested, choices = [], OF_PICTURES["aov"]["choices"]
    for argument, names in (("layers", layers), ("aov", values.get("aov"))):
        names = [] if names is None else [names] if isinstance(names, str) else names
        names = list(names) if hasattr(names, "__iter__") else [names]
        if not all(isinstance(name, str) for name in names):
            raise TypeError(f"{argument}: expected names of layers, such as 'depth'")
        names = [name for listed in names for name in listed.split(",")]
        for name in names:
            if name not in choices:
                raise input_error(argument, f"'{name}' is not one of {', '.join(choices)}", name)
        requested += names
    return {**values, "aov": requested} if requested else values


class of_layers:
    """Errors in this block say `layers` for `aov`, as a setting or as one that another needs or excludes, unless the call
    has `aov`."""

    def __init__(self, values):
        self._values = values

    def __enter__(self):
        pass

    def __exit__(self, kind, error, trace):
        if isinstance(error, Error) and error._marked and not error.file and self._values.get("aov") is None:
            rename_setting(error, "aov", "layers")
