"""Writes rendered views for programs that reconstruct scenes, as NeRF's transforms.json and as COLMAP's model, and reads the
cameras of both again.

    python examples/nerf_colmap.py cornell-box out --count 12

FOLDER gets images/, transforms.json, and sparse/ with cameras.txt, images.txt and an empty points3D.txt. The pictures of the
cameras that were read are compared with those that were written.
"""

import argparse
import json
import pathlib

import numpy
import pertev

from poses import around, size_of


def quaternion_of(rotation):
    """Returns w, x, y, z of a rotation, by the eigenvector that rounds least (Bar-Itzhack)."""
    r = rotation
    k = numpy.array([[r[0, 0] + r[1, 1] + r[2, 2], 0, 0, 0], [r[2, 1] - r[1, 2], r[0, 0] - r[1, 1] - r[2, 2], 0, 0],
                     [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], 0],
                     [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1]]])
    return numpy.linalg.eigh(k)[1][:, -1]  # eigh reads the lower triangle


def write_transforms(path, poses, K, size, names):
    """NeRF's file: poses as Pertev has them."""
    document = {"camera_model": "PINHOLE", "w": size[0], "h": size[1], "fl_x": K[0, 0], "fl_y": K[1, 1], "cx": K[0, 2], "cy": K[1, 2],
                "frames": [{"file_path": f"images/{name}.png", "transform_matrix": pose.tolist()} for name, pose in zip(names, poses)]}
    path.write_text(json.dumps(document, indent=1), encoding="utf-8")


def write_colmap(folder, poses, K, size, names):
    """COLMAP's model as text: camera from world, y down, as quaternions and translations."""
    folder.mkdir(exist_ok=True)
    numbers = " ".join(map(repr, map(float, (K[0, 0], K[1, 1], K[0, 2], K[1, 2]))))
    (folder / "cameras.txt").write_text(f"1 PINHOLE {size[0]} {size[1]} {numbers}\n", encoding="utf-8")
    lines = []
    for number, (name, pose) in enumerate(zip(names, poses), 1):
        camera_from_world = numpy.linalg.inv(pose @ numpy.diag([1, -1, -1, 1]))
        place = [*quaternion_of(camera_from_world[:3, :3]), *camera_from_world[:3, 3]]
        lines += [f"{number} {' '.join(repr(float(x)) for x in place)} 1 {name}.png", ""]  # a line for its points
    (folder / "images.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "points3D.txt").write_text("", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description="Writes views for NeRF and COLMAP, and reads their cameras.")
    parser.add_argument("scene", help="a file, or the name of a built-in scene")
    parser.add_argument("folder")
    parser.add_argument("--count", type=int, default=12, help="number of pictures")
    parser.add_argument("--size", type=size_of, default=(320, 240), metavar="WIDTHxHEIGHT")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    given = parser.parse_args()
    folder = pathlib.Path(given.folder)
    (folder / "images").mkdir(parents=True, exist_ok=True)
    scene = pertev.load(given.scene)
    settings = {"size": given.size, "spp": given.spp}
    first = pertev.render(scene, **{**settings, "spp": 1})
    poses = around(first.pose, scene.bounds.mean(axis=0), given.count, 0.1 * numpy.ptp(scene.bounds, axis=0).max())
    names = [f"view-{k:03}" for k in range(given.count)]

    def render(cameras):
        return numpy.asarray(pertev.render(scene, cameras=cameras, **settings).color)

    pictures = render(pertev.Cameras(poses, first.K))
    for name, picture in zip(names, pictures):
        pertev.write(folder / "images" / f"{name}.png", picture, curve="agx")
    write_transforms(folder / "transforms.json", poses, first.K, given.size, names)
    write_colmap(folder / "sparse", poses, first.K, given.size, names)
    for source in ("transforms.json", "sparse"):
        cameras = pertev.read_cameras(folder / source)
        errors = [pertev.compare(one, other)["rel_mse"] for one, other in zip(render(cameras), pictures)]
        print(f"{source}: {len(cameras)} cameras, rel_mse of their pictures at most {max(errors):.2g}")


if __name__ == "__main__":
    main()
