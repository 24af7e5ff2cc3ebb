"""Makes a data set of a scene: pictures, depth, normals, ids, and the masks of all instances in COCO's format.

    python examples/dataset.py cornell-box out --count 8 --size 320x240

FOLDER gets 000000.png, 000000.npz (depth in metres along the camera's axis, normal, ids, pose and K) and so on, and
annotations.json. Layers are those of pixels' centres, so that no value is a blend of two surfaces.
"""

import argparse
import json
import pathlib

import numpy
import pertev

from poses import around, size_of

NOTHING = 0xFFFFFFFF  # the id of a pixel that shows the background


def rle_of(mask):
    """Returns a mask as COCO's run lengths: down the columns, beginning with the number of pixels outside."""
    flat = mask.ravel(order="F")
    ends = numpy.flatnonzero(numpy.diff(flat)) + 1
    starts = numpy.concatenate([[0] if not flat[0] else [0, 0], ends, [flat.size]])
    return {"size": list(mask.shape), "counts": numpy.diff(starts).tolist()}


def annotations_of(ids, names):
    """Yields the annotations of the instances that a picture shows, without numbers."""
    for instance in numpy.unique(ids):
        if instance == NOTHING:
            continue
        mask = ids == instance
        rows, columns = numpy.flatnonzero(mask.any(axis=1)), numpy.flatnonzero(mask.any(axis=0))
        x, y = int(columns[0]), int(rows[0])
        yield {"category": names[instance], "segmentation": rle_of(mask), "area": int(mask.sum()), "iscrowd": 0,
               "bbox": [x, y, int(columns[-1]) + 1 - x, int(rows[-1]) + 1 - y]}


def make(scene, folder, count, size, spp):
    """Writes the data set and returns the contents of annotations.json."""
    scene = pertev.load(scene)
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    first = pertev.render(scene, size=size, spp=1)  # its camera and angle of view are the scene's own
    poses = around(first.pose, scene.bounds.mean(axis=0), count, 0.1 * numpy.ptp(scene.bounds, axis=0).max())
    names = [name or f"instance {number}" for number, name in enumerate(scene.instance_names)]
    categories = {name: number for number, name in enumerate(sorted(set(names)), 1)}
    coco = {"images": [], "annotations": [], "categories": [{"id": number, "name": name} for name, number in categories.items()]}
    for part in pertev.render_chunks(scene, pertev.Cameras(poses, first.K), seeds=numpy.arange(count), size=size, spp=spp,
                                     layers=["depth", "normal", "ids"], layers_at="centre"):
        arrays = {name: numpy.asarray(array) for name, array in part.arrays.items()}
        for k in range(len(part)):
            number = len(coco["images"])
            pertev.write(folder / f"{number:06}.png", arrays["color"][k], curve="agx")
            numpy.savez_compressed(folder / f"{number:06}.npz", pose=poses[number], K=first.K,
                                   **{name: arrays[name][k] for name in ("depth", "normal", "ids")})
            coco["images"].append({"id": number, "file_name": f"{number:06}.png", "width": size[0], "height": size[1]})
            for annotation in annotations_of(arrays["ids"][k, :, :, 0], names):
                annotation.update(id=len(coco["annotations"]) + 1, image_id=number,
                                  category_id=categories[annotation.pop("category")])
                coco["annotations"].append(annotation)
    (folder / "annotations.json").write_text(json.dumps(coco), encoding="utf-8")
    return coco


def main():
    parser = argparse.ArgumentParser(description="Makes a data set with depth, normals, ids and COCO masks.")
    parser.add_argument("scene", help="a file, or the name of a built-in scene")
    parser.add_argument("folder")
    parser.add_argument("--count", type=int, default=8, help="number of pictures")
    parser.add_argument("--size", type=size_of, default=(320, 240), metavar="WIDTHxHEIGHT")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel")
    given = parser.parse_args()
    coco = make(given.scene, given.folder, given.count, given.size, given.spp)
    print(f"{len(coco['images'])} pictures with {len(coco['annotations'])} masks of {len(coco['categories'])} categories")


if __name__ == "__main__":
    main()
