"""A known way to break the renderer, and the tests that must notice it."""

from dataclasses import dataclass


@dataclass
class Mutation:
    name: str
    edits: list  # list of (file, text that is there once, replacement)
    tests: list  # CTest's names; each must notice


def edit(file, old, new):
    return (file, old, new)
