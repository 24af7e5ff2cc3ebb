"""Runs the examples at small sizes and checks their results."""

import importlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import numpy

import pertev

from other_python import needs, python_with

PROGRAM = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
sys.path.insert(0, str(EXAMPLES))
OBJECT = """v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 -1\nv 2 0 -1\nv 2 1 -1\nv 0 1 -1
f 1 2 3 4\nf 6 5 8 7\nf 2 6 7 3\nf 5 1 4 8\nf 4 3 7 8\nf 5 6 2 1\n"""


def run(name, *arguments):
    """Runs an example and returns what it prints."""
    done = subprocess.run([sys.executable, EXAMPLES / name, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        raise AssertionError(f"{name}: {done.stderr}")
    return done.stdout


# Prints what COCO's own reader finds: of each object its file, category, area, box and mask.
READ_COCO = """
import json, sys
from pycocotools import mask
from pycocotools.coco import COCO
coco, found = COCO(sys.argv[1]), []
for of in coco.loadAnns(coco.getAnnIds()):
    rle = coco.annToRLE(of)
    image, category = coco.loadImgs(of["image_id"])[0], coco.loadCats(of["category_id"])[0]
    found.append([image["file_name"], category["name"], int(mask.area(rle)), mask.toBbox(rle).astype(int).tolist(), coco.annToMask(of).tolist()])
print(json.dumps(found))
"""


def mask_of(rle):
    """Decodes COCO's run lengths."""
    values = numpy.arange(len(rle["counts"])) % 2 == 1
    return numpy.repeat(values, rle["counts"]).reshape(rle["size"], order="F")


class Example(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))


class DataSet(Example):
    def setUp(self):
        super().setUp()
        run("dataset.py", "cornell-box", self.folder, "--count", 3, "--size", "40x30", "--spp", 1)
        self.coco = json.loads((self.folder / "annotations.json").read_text())
        self.arrays = [numpy.load(self.folder / f"{k:06}.npz") for k in range(3)]

    def test_masks_are_the_pixels_of_the_instance_with_the_category_s_name(self):
        names = pertev.load("cornell-box").instance_names
        self.assertIn("back wall", names)
        categories = {category["id"]: category["name"] for category in self.coco["categories"]}
        self.assertEqual(sorted(categories.values()), sorted(names))
        covered = [numpy.zeros((30, 40), int) for _ in range(3)]
        for number, annotation in enumerate(self.coco["annotations"], 1):
            mask, ids = mask_of(annotation["segmentation"]), self.arrays[annotation["image_id"]]["ids"][..., 0]
            self.assertTrue((mask == (ids == names.index(categories[annotation["category_id"]]))).all())
            x, y, width, height = annotation["bbox"]
            self.assertEqual(mask[y:y + height, x:x + width].sum(), mask.sum())
            self.assertTrue(mask[y].any() and mask[y + height - 1].any() and mask[:, x].any() and mask[:, x + width - 1].any())
            self.assertEqual((annotation["id"], annotation["area"], annotation["iscrowd"]), (number, mask.sum(), 0))
            covered[annotation["image_id"]] += mask
        for arrays, count in zip(self.arrays, covered):
            self.assertTrue((count == (arrays["ids"][..., 0] != 0xFFFFFFFF)).all())
            self.assertGreater(count.mean(), 0.5)

    def test_run_lengths_begin_outside_the_mask(self):
        rle_of = importlib.import_module("dataset").rle_of
        for mask, counts in [([[0, 1], [0, 1]], [2, 2]), ([[1, 0], [0, 1]], [0, 1, 2, 1]), ([[1, 1], [1, 1]], [0, 4]), ([[0, 0], [0, 0]], [4])]:
            self.assertEqual(rle_of(numpy.array(mask, bool)), {"size": [2, 2], "counts": counts})

    def test_pixels_of_the_back_wall_lie_in_its_plane(self):
        scene = pertev.load("cornell-box")
        wall, z = scene.instance_names.index("back wall"), scene.bounds[1, 2]
        self.assertAlmostEqual(z, 0.5592, 6)
        for arrays in self.arrays:
            rows, columns = numpy.nonzero(arrays["ids"][..., 0] == wall)
            self.assertGreater(len(rows), 50)
            depth, K, pose = arrays["depth"][rows, columns].astype(float), arrays["K"], arrays["pose"]
            seen = numpy.stack([(columns + 0.5 - K[0, 2]) / K[0, 0], -(rows + 0.5 - K[1, 2]) / K[1, 1], -numpy.ones(len(rows))])
            points = pose[:3, :3] @ (depth * seen) + pose[:3, 3:]
            self.assertLess(abs(points[2] - z).max(), 2e-6)
            self.assertLess(abs(arrays["normal"][rows, columns] - (0, 0, -1)).max(), 2e-7)

    def test_the_turntable_has_its_pictures(self):
        files = [image["file_name"] for image in self.coco["images"]]
        pictures = [pertev.read(self.folder / file) for file in files]
        self.assertEqual({picture.shape[:2] for picture in pictures}, {(30, 40)})
        self.assertEqual(len({picture.tobytes() for picture in pictures}), 3)

    def test_pycocotools_reads_it(self):
        python = python_with("pycocotools")
        if python is None:
            self.skipTest("pycocotools is not installed")
        read = subprocess.run([python, "-c", READ_COCO, self.folder / "annotations.json"], check=True, capture_output=True, text=True)
        known = {category["id"]: category["name"] for category in self.coco["categories"]}
        files = {image["id"]: image["file_name"] for image in self.coco["images"]}
        expected = [[files[of["image_id"]], known[of["category_id"]], of["area"], of["bbox"], mask_of(of["segmentation"]).astype(int).tolist()]
                    for of in self.coco["annotations"]]
        self.assertGreater(len(expected), 10)
        self.assertEqual(json.loads(read.stdout.splitlines()[-1]), expected)


class DataLoader(Example):
    @needs("torch")
    def test_workers_give_the_batches_of_this_process_and_the_network_learns(self):
        import torch
        example = importlib.import_module("data_loader")
        views = example.Views(pertev.load("cornell-box", device="cpu"), 2, 3, (16, 12), 1, device="cpu")
        environment = {"PYTHONPATH": os.pathsep.join(sys.path)}
        with unittest.mock.patch.dict(os.environ, environment):
            batches = list(example.loader_of(views, 1))
        for number, (color, depth) in enumerate(batches):
            here = views[number]
            self.assertEqual((tuple(color.shape), tuple(depth.shape)), ((3, 3, 12, 16), (3, 12, 16)))
            self.assertTrue(torch.equal(color, here[0]) and torch.equal(depth, here[1]))
        self.assertFalse(torch.equal(batches[0][1], batches[1][1]))
        forked = torch.utils.data.DataLoader(views, batch_size=None, num_workers=1, multiprocessing_context="fork")
        with self.assertRaises(pertev.DeviceError):
            next(iter(forked))
        errors = list(example.learn([views[0]] * 12, "cpu"))
        self.assertLess(errors[-1], 0.5 * errors[0])

    def test_without_torch_there_is_a_clear_error(self):
        done = subprocess.run([sys.executable, "-c", "import sys; sys.modules['torch'] = None; import data_loader"], cwd=EXAMPLES,
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (1, 1))


class FitCamera(Example):
    def test_a_displaced_camera_is_found(self):
        text = run("fit_camera.py", "cornell-box", "--size", "48x48", "--spp", 8, "--steps", 8, "--moved", 0.05, "--turned", 3)
        errors = [tuple(map(float, found)) for found in re.findall(r"off by ([\d.]+) m and ([\d.]+) degrees", text)]
        self.assertEqual((len(errors), errors[0]), (9, (0.05, 3)))
        self.assertLess(errors[-1][0], 0.4 * errors[0][0])
        self.assertLess(errors[-1][1], 0.4 * errors[0][1])

    def test_a_pose_is_moved_along_and_turned_about_its_own_axes(self):
        example = importlib.import_module("fit_camera")
        pose = example.moved(numpy.eye(4), (0, 0, 0, 0, numpy.pi / 2, 0)) # the camera looks along -x
        self.assertTrue(numpy.allclose(pose[:3, 2], (1, 0, 0)))
        there = example.moved(pose, (0, 0, -2, 0, 0, 0))
        self.assertTrue(numpy.allclose(there[:3, 3], (-2, 0, 0)))
        self.assertTrue(numpy.allclose(example.error_of(there, numpy.eye(4)), (2, 90)))


class Turntable(Example):
    def test_frames_are_views_from_all_sides(self):
        scene = self.folder / "box.obj"
        scene.write_text(OBJECT)
        text = run("turntable.py", scene, self.folder / "out", "--frames", 4, "--size", "32x24", "--spp", 2)
        self.assertIn(f"ffmpeg -framerate 24 -i {self.folder}/out/frame-%04d.png", text)
        files = sorted((self.folder / "out").iterdir())
        self.assertEqual([file.name for file in files], [f"frame-{k:04}.png" for k in range(4)])
        pictures = [pertev.read(file) for file in files]
        self.assertEqual({picture.shape for picture in pictures}, {(24, 32, 3)})
        self.assertEqual(len({picture.tobytes() for picture in pictures}), 4)

    def test_the_box_is_in_the_view_of_each_pose(self):
        example = importlib.import_module("turntable")
        bounds = numpy.array([[0, 0, -1], [2, 1, 0.0]])
        corners = numpy.array([[x, y, z, 1] for x in bounds[:, 0] for y in bounds[:, 1] for z in bounds[:, 2]])
        half = numpy.tan(numpy.radians(example.FOV) / 2)
        for aspect in (0.5, 2):
            largest = 0
            for pose in example.orbit(bounds, 8, aspect, 20):
                seen = corners @ numpy.linalg.inv(pose).T
                largest = max(largest, (abs(seen[:, 0] / seen[:, 2]) / (half * aspect)).max(), (abs(seen[:, 1] / seen[:, 2]) / half).max())
            self.assertTrue(0.5 < largest <= 1, largest)


class NerfAndColmap(Example):
    def test_cameras_are_read_as_they_were_written(self):
        text = run("nerf_colmap.py", "cornell-box", self.folder, "--count", 3, "--size", "24x16", "--spp", 1)
        errors = [float(error) for error in re.findall(r"3 cameras, rel_mse of their pictures at most (\S+)", text)]
        self.assertEqual((len(errors), errors[0]), (2, 0))
        self.assertLess(errors[1], 1e-3) # quaternions are rounded
        nerf, colmap = (pertev.read_cameras(self.folder / name) for name in ("transforms.json", "sparse"))
        self.assertTrue(numpy.allclose(nerf.poses, colmap.poses @ numpy.diag([1, -1, -1, 1]), atol=1e-12))
        self.assertTrue((nerf.K == colmap.K).all())
        names = ["view-000", "view-001", "view-002"]
        self.assertEqual((nerf.names, colmap.names), ([f"images_{name}" for name in names], names))
        self.assertEqual(colmap.settings["convention"], "opencv")

    def test_the_program_renders_the_same_pictures(self):
        run("nerf_colmap.py", "cornell-box", self.folder, "--count", 2, "--size", "24x16", "--spp", 1)
        here = pertev.render("cornell-box", cameras=pertev.read_cameras(self.folder / "sparse"), size=(24, 16), spp=1, device="cpu")
        subprocess.run([PROGRAM, "render", "cornell-box", "--cameras", self.folder / "sparse", "--spp", "1", "--device", "cpu", "-q",
                        "-o", self.folder / "{name}.exr"], check=True)
        for name, color in zip(("view-000", "view-001"), here.color):
            self.assertTrue((pertev.read(self.folder / f"{name}.exr") == color).all())


if __name__ == "__main__":
    unittest.main()
