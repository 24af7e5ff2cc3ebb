"""Pictures in turns against another renderer: the jobs, and what is measured of them. bench/against_mitsuba.py and
bench/against_cycles.py bring the other renderer."""

import argparse
import errno
import json
import os
import pathlib
import re
import statistics
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests/images"), str(ROOT / "tests/support"), str(ROOT / "tools")]
import make_corridor  # noqa: E402
import make_material_balls  # noqa: E402
import make_velvet_sofa  # noqa: E402
from measurement import machine, write_measurement  # noqa: E402
from mitsuba_to_gltf import convert  # noqa: E402
from reference_job import last_event  # noqa: E402

TABLE = json.loads((ROOT / "bench/jobs.json").read_text(encoding="utf-8"))
SPONZA = next(scene for scene in TABLE["scenes"] if scene["name"] == "sponza")
JOBS_OF_RECORD = {job["name"]: job for job in TABLE["jobs"]}


def write_grey_obj(source, target, grey):
    """Positions and faces of an OBJ alone, with one diffuse material of that reflectance beside it."""
    kept = [line for line in source.read_text().splitlines() if line[:2] in ("v ", "f ")]
    faces = [re.sub(r"/\S*", "", line) for line in kept]
    target.with_suffix(".mtl").write_text(f"newmtl grey\nKd {grey} {grey} {grey}\n")
    target.write_text("\n".join([f"mtllib {target.stem}.mtl", "usemtl grey", *faces, ""]))


class Job:
    """One picture in both renderers. `depth` counts scatterings, `eye`, `target` and `fov` (vertical, degrees) are the camera's, and
    `materials` has reflectance and emission of each material of the OBJ."""

    sky, roulette_depth = None, 5
    peers = ("Mitsuba", "Cycles")
    cpu_size, gpu_size = (640, 360), (1920, 1080)

    def __init__(self, scenes, folder, on_gpu):
        self.width, self.height = self.gpu_size if on_gpu else self.cpu_size
        self.folder, self.file = folder, folder / f"{self.stem}.obj"
        self.write(scenes)

    def render_flags(self):
        flags = ["render", self.file, "--filter", "box", "--max-depth", self.depth]
        flags += ["--eye=" + ",".join(map(str, self.eye)), "--target=" + ",".join(map(str, self.target)), "--fov", self.fov]
        return flags + (["--environment", ",".join(map(str, [self.sky] * 3))] if self.sky else [])


class Sponza(Job):
    """Sponza as a file for `pertev render`, whose paths end by the default Russian roulette."""

    name, stem, depth, sky, materials = "grey Sponza, 8 bounces, default roulette", "sponza-default", 8, 1.0, {"grey": (0.7, 0)}
    eye, target, fov = SPONZA["eye"], SPONZA["target"], SPONZA["fov_y_deg"]

    def write(self, scenes):
        self.scene = scenes / SPONZA["file"]
        write_grey_obj(self.scene, self.file, self.materials["grey"][0])


class SponzaJob(Sponza):
    """The job S8, with its roulette: by throughput, from the second vertex on."""

    name, stem, roulette_depth = "grey Sponza, 8 bounces", "sponza", 2

    def render_flags(self):
        return ["bench", "render", "--job", "S8", "--scene", self.scene]


class Bunny(Job):
    name, stem, depth, sky = "bunny, depth 8", "bunny", 7, 1.0
    eye, target, fov = (JOBS_OF_RECORD["bunny"][key] for key in ("eye", "target", "fov_y_deg"))
    materials = {"grey": (JOBS_OF_RECORD["bunny"]["reflectance"], 0)}

    def write(self, scenes):
        write_grey_obj(scenes / "stanford/bunny.obj", self.file, self.materials["grey"][0])


class Corridor(Job):
    name, stem, depth = "corridor of 5,000 emitters, direct light", "corridor", 1
    eye, target, fov = (JOBS_OF_RECORD["corridor"][key] for key in ("eye", "target", "fov_y_deg"))
    materials = {"wall": (make_corridor.REFLECTANCE, 0), "lamp": (0, make_corridor.EMISSION)}

    def write(self, scenes):
        make_corridor.write(self.file)


class SceneFile(Job):
    """A scene whose Mitsuba file `xml` has materials and camera."""

    def render_flags(self):
        return ["render", self.file, "--filter", "box", "--max-depth", self.depth]


class VeachAjar(SceneFile):
    """Bitterli's room behind a door, at its file's size and depth."""

    name, stem, depth, peers = "Veach's door, depth 12", "veach-ajar", 12, ("Mitsuba",)
    cpu_size, gpu_size = (320, 180), (1280, 720)

    def write(self, scenes):
        self.xml = self.file = scenes / "bitterli/veach-ajar/scene_mitsuba3.xml"
        if not self.xml.exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(self.xml))


class CornellBox(SceneFile):
    """Bitterli's Cornell box."""

    name, stem, depth = "Cornell box, depth 8", "cornell-box", 7
    cpu_size, gpu_size = (512, 512), (1024, 1024)

    def write(self, scenes):
        self.xml = scenes / "bitterli/cornell-box/scene_mitsuba3.xml"
        self.file = self.file.with_suffix(".gltf")
        self.file.write_text(convert(self.xml)[0])


class DeepCornellBox(CornellBox):
    name, stem, depth = "Cornell box, depth 65", "cornell-box-65", 64


class MaterialBalls(SceneFile):
    """Metals, glass, plastics and principled materials. Both read one file, and Pertev has the nearest material of principled ones, which
    is brighter where these lose light to their microfacets."""

    name, stem, depth, peers = "40 material balls, depth 8", "material-balls", 8, ("Mitsuba",)

    def write(self, scenes):
        self.xml = self.file = self.file.with_suffix(".xml")
        make_material_balls.write(self.file)


class VelvetSofa(SceneFile):
    """The Khronos sample model. Mitsuba has the nearest of its sheen."""

    name, stem, depth, peers = "GlamVelvetSofa, depth 8", "velvet-sofa", 8, ("Mitsuba",)
    eye, target, fov, sky = make_velvet_sofa.EYE, make_velvet_sofa.TARGET, make_velvet_sofa.FOV, make_velvet_sofa.SKY
    render_flags = Job.render_flags

    def write(self, scenes):
        self.file, self.xml = scenes / "gltf/GlamVelvetSofa/GlamVelvetSofa.glb", self.file.with_suffix(".xml")
        make_velvet_sofa.write(self.file, self.xml)


JOBS = [SponzaJob, Sponza, CornellBox, DeepCornellBox, Bunny, Corridor, VeachAjar, MaterialBalls, VelvetSofa]


class Contest:
    """A renderer `peer` has a name, what() it is, prepare(job, width, height), and render(prepared, samples, seed, path or None), which
    gives samples a second."""

    def __init__(self, arguments, peer, folder):
        self.arguments, self.peer, self.folder = arguments, peer, folder

    def pertev(self, job, width, height, samples, seed, path):
        """Writes a picture. Gives samples a second, without reading and trees."""
        event = last_event(self.arguments.pertev, [
            *job.render_flags(), "-o", path, "--size", f"{width}x{height}", "--spp", samples, "--seed", seed, "--device",
            self.arguments.device, *(["--threads", self.arguments.threads] if self.arguments.device == "cpu" else [])], "job", "done")
        return width * height * samples / event.get("render_seconds", event.get("seconds"))

    def renderers(self, job, width, height):
        scene = self.peer.prepare(job, width, height)
        return [("pertev", lambda samples, seed, path: self.pertev(job, width, height, samples, seed, path)),
                (self.peer.name.lower(), lambda samples, seed, path: self.peer.render(scene, samples, seed, path))]

    def errors(self, job, width, height):
        """relMSE of both against their own references, and the means of these, all of the best 98 % of pixels."""
        errors, references, path = [], [], self.folder / "picture.exr"
        for who, render in self.renderers(job, width, height):
            references.append(self.folder / f"{job.stem}-{who}-{width}x{height}-{self.arguments.reference}.exr")
            if not references[-1].exists():
                render(self.arguments.reference, 1000, references[-1])
            far = []
            for seed in range(1, 5):
                render(self.arguments.samples, seed, path)
                far.append(self.compare(path, references[-1])["rel_mse_98"])
            errors.append(statistics.mean(far))
        both = self.compare(*references)
        return errors, [statistics.mean(both[mean]) for mean in ("mean_98", "reference_mean_98")]

    def compare(self, picture, reference):
        return last_event(self.arguments.pertev, ["compare", picture, reference], "compare")

    def run(self, job):
        """A row of the table."""
        both, rates, samples = self.renderers(job, job.width, job.height), [], self.arguments.samples
        both[1][1](samples, 0, None)  # reads and compiles
        for seed in range(1, self.arguments.runs + 1):
            rates.append([render(samples, seed, self.folder / "picture.exr" if who == "pertev" else None) for who, render in both])
            print(f"{job.name}: {rates[-1][0] * 1e-6:.3f} Msamples/s, {self.peer.name} {rates[-1][1] * 1e-6:.3f}", flush=True)
        ours, theirs = (statistics.median(column) for column in zip(*rates))
        errors, means = self.errors(job, job.width // 4, job.height // 4)
        if abs(means[0] / means[1] - 1) > 0.005:
            print(f"{job.name}: the means {means[0]:.5f} and {means[1]:.5f} differ by more than 0.5 %", file=sys.stderr)
        sooner = ours / theirs * errors[1] / errors[0]
        row = [job.name, *(float(f"{value:.4g}") for value in (ours * 1e-6, theirs * 1e-6, ours / theirs, *errors, sooner)),
               *(float(f"{mean:.5g}") for mean in means)]
        print(*row, sep=", ", flush=True)
        return row


def columns_of(name):
    key = name.lower()
    return [("job", "job", None), ("pertev", "Pertev", "Msamples/s"), (key, name, "Msamples/s"), ("times_the_samples", "times the samples", None),
            ("pertev_relmse", "Pertev relMSE", None), (f"{key}_relmse", f"{name} relMSE", None),
            ("times_sooner", "times sooner to equal error", None), ("pertev_mean", "Pertev mean", None), (f"{key}_mean", f"{name} mean", None)]


NOTES_OF_LANES = {None: [], 1: ["Pertev shades vertices one by one."],
                  8: ["Shading of both held to eight lanes of AVX2 on a processor with AVX-512."]}


def main(description, make_peer, devices):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("pertev")
    parser.add_argument("--device", choices=devices, default="cpu")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--samples", type=int, default=64, help="samples of a picture (64)")
    parser.add_argument("--runs", type=int, default=5, help="runs of each renderer, in turns (5)")
    parser.add_argument("--reference", type=int, default=4096, help="samples of the references (4096)")
    parser.add_argument("--jobs", nargs="+", choices=[kind.stem for kind in JOBS], metavar="STEM", help="only these")
    parser.add_argument("--lanes", type=int, choices=[1, 8],
                        help="shade eight vertices at once, by AVX2, where the processor has AVX-512, or (1) one by one, Pertev alone")
    parser.add_argument("--work", type=pathlib.Path, help="a folder in which references are kept")
    parser.add_argument("-o", "--output", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.lanes:
        os.environ["PERTEV_LANES"] = str(arguments.lanes)
    peer, rows = make_peer(arguments), []
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.work or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for kind in JOBS:
            if peer.name not in kind.peers or (arguments.jobs and kind.stem not in arguments.jobs):
                continue
            try:
                job = kind(pathlib.Path(os.environ["PERTEV_SCENES"]), folder, arguments.device == "cuda")
            except FileNotFoundError as missing:
                print(f"{kind.name}: left out, {missing.filename} is missing", file=sys.stderr)
                continue
            rows.append(Contest(arguments, peer, folder).run(job))
    if arguments.output:
        notes = [f"{peer.what()}; {arguments.samples} samples, box filter; medians of {arguments.runs} runs in turns; references of "
                 f"{arguments.reference} samples.", *NOTES_OF_LANES[arguments.lanes]]
        title = f"Against {peer.name}, {machine(arguments.device)}"
        write_measurement(arguments.output, arguments.pertev, title, columns_of(peer.name), rows, arguments.device, arguments.threads, notes)
