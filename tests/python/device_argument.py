"""The device that renders in a test: `--device NAME` on its command line (tools/check_gpu.sh), else the CPU."""

import sys


def device_argument():
    """Takes it from the command line, which unittest reads too."""
    if "--device" not in sys.argv:
        return "cpu"
    at = sys.argv.index("--device")
    device = sys.argv[at + 1]
    del sys.argv[at:at + 2]
    return device


DEVICE = device_argument()
