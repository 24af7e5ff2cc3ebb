"""Processes that fork: the threads of a process that has worked are not in its child, which would wait for them."""

import os

from .errors import DeviceError

_has_worked = _is_forked = False


def _after_fork():
    global _is_forked
    _is_forked = _has_worked


os.register_at_fork(after_in_child=_after_fork)


def check_process():
    """Raises DeviceError in the child of a process that had worked before it forked."""
    global _has_worked
    if _is_forked:
        raise DeviceError("this process was forked from one that had used pertev; start processes by 'spawn'")
    _has_worked = True
