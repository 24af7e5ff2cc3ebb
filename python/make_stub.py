#!/usr/bin/env python3
"""Prints the type stub of the package: `make_stub.py PACKAGE`. The settings are those of the table, from PACKAGE/_core."""

import importlib
import inspect
import pathlib
import sys
import textwrap

TYPES = {"bool": "bool", "int": "int", "float": "float", "size": "tuple[int, int] | str",
         "vector": "Sequence[float] | str", "list": "_Text | Sequence[_Text]",
         "text": "_Text | float | Sequence[float]"}

HEAD = '''# Made by python/make_stub.py from the table of settings.
import os
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy
from numpy.typing import NDArray

from .errors import DeviceError as DeviceError, Error as Error, InputError as InputError
from .errors import InterruptedRender as InterruptedRender, LimitError as LimitError
from .errors import MemoryLimitError as MemoryLimitError, WriteError as WriteError

_Text: TypeAlias = str | os.PathLike[str]
_Floats: TypeAlias = NDArray[numpy.float32]

def builtin_scenes() -> list[str]: ...
'''

ARRAYS = {"ids": "NDArray[numpy.uint32]", "layers": "dict[str, NDArray[Any]]", "info": "dict[str, Any]", "hash": "str",
          "samples": "int", "seconds": "float", "name": "str"}


def type_of(row):
    """The type of a setting's values. Other texts than a text's listed choices are refused when they are given."""
    if row["choices"] and row["type"] in ("choice", "text"):
        return f"Literal[{', '.join(repr(choice) for choice in row['choices'])}]"
    return TYPES.get(row["type"], "str")


def class_of(kind):
    yield f"class {kind.__name__}:"
    yield f'    """{(kind.__doc__ or "").strip()}"""'
    for name, value in vars(kind).items():
        if not name.startswith("_"):
            yield "    @property"
            yield f"    def {name}(self) -> {ARRAYS.get(name, '_Floats')}:"
            yield f'        """{inspect.getdoc(value)}"""'
    yield ""


def function_of(name, first, returned, core, package):
    yield f"def {name}("
    yield from (f"    {line}" for line in first)
    for row in core.settings():
        yield from textwrap.wrap(row["sentence"], 110, initial_indent="    # ", subsequent_indent="    # ")
        yield f"    {row['name']}: {type_of(row)} | None = None,"
    yield f") -> {returned}:"
    yield textwrap.indent(f'"""{inspect.getdoc(getattr(package, name))}"""', "    ")
    yield ""


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    sys.path.insert(0, str(folder.parent))
    package = importlib.import_module(folder.name)
    core = importlib.import_module(f"{folder.name}._core")
    print(HEAD)
    for kind in (core.Scene, core.Result):
        print("\n".join(class_of(kind)))
    print("\n".join(function_of("load", ["scene: _Text,", "*,"], "Scene", core, package)))
    print("\n".join(function_of("render", ["scene: Scene | _Text,", "*,", "layers: str | Sequence[str] = (),",
                                          "output: _Text | Sequence[_Text] = (),", "settings: _Text | None = None,"],
                                "Result", core, package)))


if __name__ == "__main__":
    main()
