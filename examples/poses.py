"""Poses for the examples: 4x4 matrices, world from camera, which looks along -z with y up."""

import numpy


def look_at(eye, target, up=(0, 1, 0)):
    """Returns the pose of a camera at `eye` that looks at `target`, which is not straight above or below it."""
    back = numpy.subtract(eye, target)
    right = numpy.cross(up, back)
    axes = [right, numpy.cross(back, right), back]
    pose = numpy.eye(4)
    pose[:3, :3] = numpy.stack([axis / numpy.linalg.norm(axis) for axis in axes], axis=1)
    pose[:3, 3] = eye
    return pose


def around(pose, target, count, amount, seed=0):
    """Returns `count` poses that look at `target` from up to `amount` metres beside `pose`, along each axis."""
    steps = numpy.random.default_rng(seed).uniform(-amount, amount, (count, 3))
    return numpy.array([look_at(pose[:3, 3] + step, target) for step in steps])


def size_of(text):
    """Returns the width and height of "320x240"."""
    width, height = text.split("x")
    return int(width), int(height)
