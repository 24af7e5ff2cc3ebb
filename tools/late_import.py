"""Modules that are imported when they are first used, so that a script shows its --help where its packages are missing."""

import importlib


class LateImport:
    """Stands for the module of that name."""

    def __init__(self, name):
        self.__name = name

    def __getattr__(self, attribute):
        return getattr(importlib.import_module(self.__name), attribute)
