"""Arrays of other packages."""


def on_host(value):
    """Returns an array in the memory of the CPU: of PyTorch, CuPy, Warp, JAX or of a DeviceArray a copy if it is on a GPU."""
    import numpy  # not needed by `import pertev` itself

    if hasattr(value, "detach"):  # PyTorch's, which NumPy takes only without a gradient
        value = value.detach()
    for name in ("cpu", "get", "numpy"):  # methods of PyTorch, CuPy, and Warp and a DeviceArray
        if callable(copy := getattr(value, name, None)):
            try:
                return copy()
            except TypeError:  # another method of this name, as a dictionary's
                continue
    return numpy.asarray(value)
