"""Finds the camera of a picture: the pose is changed until a rendered picture looks like the given one.

    python examples/fit_camera.py cornell-box --moved 0.05 --turned 3

The given picture is rendered from the scene's own camera, and the search begins at a displaced one. Its derivatives are finite
differences: each step renders the pose and six neighbours in each direction as one batch, with the same random numbers, and
solves for the change that explains the difference best (Levenberg and Marquardt).
"""

import argparse

import numpy
import pertev

from poses import size_of


def turned(vector):
    """Returns the rotation about `vector` by its length, radians (Rodrigues)."""
    angle = numpy.linalg.norm(vector)
    if angle == 0:
        return numpy.eye(3)
    x, y, z = vector / angle
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross


def moved(pose, change):
    """Returns a pose moved by change[:3] metres along its own axes and turned by change[3:] radians about them."""
    result = pose.copy()
    result[:3, :3] = pose[:3, :3] @ turned(numpy.asarray(change[3:]))
    result[:3, 3] += pose[:3, :3] @ change[:3]
    return result


def error_of(pose, truth):
    """Returns the distance of two poses in metres and in degrees."""
    cosine = (numpy.trace(pose[:3, :3].T @ truth[:3, :3]) - 1) / 2
    return numpy.linalg.norm(pose[:3, 3] - truth[:3, 3]), numpy.degrees(numpy.arccos(numpy.clip(cosine, -1, 1)))


class Views:
    """Pictures of a scene by many cameras in one call, blurred, so that edges change them little by little."""

    def __init__(self, scene, K, **settings):
        self.scene, self.K, self.settings = scene, K, settings

    def __call__(self, poses):
        return numpy.asarray(pertev.render(self.scene, cameras=pertev.Cameras(numpy.array(poses), self.K), **self.settings).color)


def blurred(pictures, sigma):
    """Returns pictures (N, H, W, 3) after a Gaussian of `sigma` pixels, as (N, numbers). Emitters count as white."""
    rows, columns = (numpy.exp(-0.5 * (numpy.subtract.outer(range(n), range(n)) / sigma)**2) for n in pictures.shape[1:3])
    rows, columns = rows / rows.sum(axis=1, keepdims=True), columns / columns.sum(axis=1, keepdims=True)
    return numpy.einsum("ij,njkc,lk->nilc", rows, numpy.minimum(pictures, 1), columns, optimize=True).reshape(len(pictures), -1)


def fit(views, picture, start, steps):
    """Yields the pose and the mean squared difference from `picture` before each step, with less and less blur, and at the end."""
    pose, damping = start, 1e-3
    for number in range(steps):
        share = number / max(steps - 1, 1)
        sigma = max(picture.shape[1] / 12 * (1 - share), 1.0)
        step = 1e-2 * (1 - share) + 2e-3 * share  # metres and radians
        goal = blurred(picture[None], sigma)[0]
        changes = step * numpy.concatenate([numpy.zeros((1, 6)), numpy.eye(6), -numpy.eye(6)])
        made = blurred(views([moved(pose, change) for change in changes]), sigma)
        rest = goal - made[0]
        yield pose, (rest**2).mean()
        slopes = (made[1:7] - made[7:]) / (2 * step)
        squares = slopes @ slopes.T
        tries = [numpy.linalg.solve(squares + factor * numpy.diag(numpy.diag(squares)), slopes @ rest)
                 for factor in damping * numpy.array([0.1, 1, 10, 100])]
        errors = ((blurred(views([moved(pose, change) for change in tries]), sigma) - goal)**2).mean(axis=1)
        best = int(errors.argmin())
        if errors[best] < (rest**2).mean():
            pose = moved(pose, tries[best])
        damping *= 10.0**(best - 1)
    yield pose, ((blurred(views([pose]), sigma)[0] - goal)**2).mean()


def main():
    parser = argparse.ArgumentParser(description="Finds a displaced camera by finite differences of pictures.")
    parser.add_argument("scene", help="a file, or the name of a built-in scene")
    parser.add_argument("--moved", type=float, default=0.05, help="metres by which the camera is displaced")
    parser.add_argument("--turned", type=float, default=3, help="degrees by which it is turned")
    parser.add_argument("--steps", type=int, default=12)
    parser.add_argument("--size", type=size_of, default=(64, 64), metavar="WIDTHxHEIGHT")
    parser.add_argument("--spp", type=int, default=16, help="samples per pixel")
    given = parser.parse_args()
    scene = pertev.load(given.scene)
    settings = {"size": given.size, "spp": given.spp, "max_depth": 2}
    sought = pertev.render(scene, **{**settings, "spp": 4 * given.spp, "seed": 1})  # with noise of its own
    truth = sought.pose
    away = numpy.array([1, -1, 1, 1, 1, -1]) / numpy.sqrt(3)
    start = moved(truth, away * ([given.moved] * 3 + [numpy.radians(given.turned)] * 3))
    views = Views(scene, sought.K, **settings)
    for number, (pose, difference) in enumerate(fit(views, sought.color, start, given.steps)):
        metres, degrees = error_of(pose, truth)
        print(f"step {number}: difference {difference:.6f}, off by {metres:.5f} m and {degrees:.4f} degrees")


if __name__ == "__main__":
    main()
