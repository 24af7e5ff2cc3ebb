"""Settings as texts: Python's values in the syntax of the table."""

import difflib
import math
import operator
import os

from . import _core
from .errors import input_error

OF_PICTURES = {row["name"]: row for row in _core.settings()}
OF_FRAMES = {**OF_PICTURES, **{row["name"]: row for row in _core.frame_settings()}}
OF_PARTS = {row["name"]: row for row in _core.part_settings()}
OF_STILLS = {**OF_PICTURES, **OF_PARTS}
SEPARATORS = {"A:B": ":", "I/N": "/"}  # by the form of a value


def _text(row, value):
    """Returns one value in the syntax of settings: True as "true", (1, 2, 3) as "1,2,3", a size as "640x480", a part as "1/4"."""
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"):  # names in Python, NumPy 2 and 1
        if row["type"] == "bool":
            return "true" if value else "false"
    elif hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0:
        try:
            return str(operator.index(value))  # exact: integers of Python, NumPy or PyTorch
        except TypeError:
            number = float(value)
        if not math.isfinite(number):
            raise input_error(row["name"], f"expected finite numbers, not {number}", str(value))
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    elif hasattr(value, "__iter__"):
        return ("x" if row["type"] == "size" else SEPARATORS.get(row["form"], ",")).join(_text(row, item) for item in value)
    raise TypeError(f"{row['name']}: {type(value).__name__} is not a value of this setting ({row['form'] or 'bool'})")


def _texts(row, value):
    if row["type"] != "list":
        return [_text(row, value)]
    is_one = isinstance(value, (str, os.PathLike)) or not hasattr(value, "__iter__")
    return [_text(row, item) for item in ([value] if is_one else value)]


def texts_of(values, known=OF_PICTURES):
    """Returns the texts of all values that are not None, by the names of their settings."""
    given = {}
    for name, value in values.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            raise TypeError(f"there is no setting '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        if value is not None:
            given[name] = _texts(known[name], value)
    return given


def with_layers(values, layers):
    """Returns the values with the names of layers as those of `aov`."""
    aov = () if values.get("aov") is None else values["aov"]
    requested = [name for names in (layers, aov) for name in ([names] if isinstance(names, str) else names)]
    return {**values, "aov": requested} if requested else values
