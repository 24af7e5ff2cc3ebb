#!/usr/bin/env python3
"""Lets public decoders of Cryptomatte read the layers of objects and materials, and compares their mattes with coverage
that a picture shows without Cryptomatte: of objects that emit light of 1, seen by the same samples.

The scene has names that files must quote, names whose hash is no normal float, two objects of one name, one without, a
cut-out, a blended and a moving object, and more names in a pixel than an EXR has ranks. Decoders come from PyPI (bpy
5.0, cryptomatte-api 1.0; mmh3 and OpenEXR for a third, which follows specification 1.2); one that is missing is skipped:

    tests/images/cryptomatte_decoders.py build/bin/pertev [--keep FOLDER]
"""

import argparse
import base64
import importlib.util
import itertools
import json
import multiprocessing
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from late_import import LateImport  # noqa: E402

numpy = LateImport("numpy")

SIZE, SPP, RANKS = (80, 56), 64, 8
TOLERANCE = 1e-6  # shares are whole multiples of 1/64; readers add up to eight floats
FILES = {"plain": [], "half": ["--exr-colors", "half"], "crop": ["--crop", "24,8,40,44"]}
TYPES = ("CryptoObject", "CryptoMaterial")


def id_of(name):
    """The id as specification 1.2 has it: the hash's bits, with an exponent of a normal float."""
    import mmh3
    bits = mmh3.hash(name.encode(), 0, signed=False)
    return bits ^ 1 << 23 if bits >> 23 & 255 in (0, 255) else bits


def names_with_changed_ids():
    """One name whose hash is a subnormal float, and one whose is infinite or not a number."""
    import mmh3
    for exponent in 0, 255:
        yield next(name for i in itertools.count() if mmh3.hash((name := f"thing {i}").encode(), 0, signed=False) >> 23 & 255 == exponent)


def things():
    """Quads as (name, material, x, y, z, width, height, kind)."""
    strange = ['say "no"', "back\\slash", "comma, inside", "Kugel ßé球", "semi;colon = {0}", "", *names_with_changed_ids()]
    yield "wall", "grey", 0, 0, -1, 3.2, 2, "solid"
    for i, name in enumerate(strange):
        yield name, ("grey", 'red "paint"', "")[i % 3], -1.6 + 0.43 * i, 0.9 - 0.1 * (i % 2), -0.3 * (i % 3), 0.38, 0.41, "solid"
    yield "twin", "blue", -1.5, -0.7, 0.1, 0.3, 0.3, "solid"
    yield "twin", "blue", 1.5, -0.7, 0.1, 0.3, 0.3, "solid"
    yield "veil", "veil", -0.2, 0, 0.5, 1.7, 1.1, "blended"
    yield "lattice", "lattice", 0.9, 0.1, 0.3, 0.9, 0.7, "cut out"
    yield "mover", "blue", -0.9, -0.1, 0.2, 0.31, 0.33, "moving"
    for i in range(20):
        yield f"sliver {i}", f"sliver {i % 3}", -0.3 + 0.004 * i, -0.8 - 0.001 * i, 0.7, 0.0035, 0.33, "solid"


def png(pixels):
    """A PNG of RGBA rows."""
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + b"".join(map(bytes, row)) for row in pixels))) + chunk(b"IEND", b"")


def scene(emitting=None):
    """glTF of the things. With `emitting`, each has a material of its own, and these three emit red, green and blue."""
    every = list(things())
    data = struct.pack("<12f", -0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0) + struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    data += struct.pack("<2f", 0, 1) + struct.pack("<6f", -0.9, -0.1, 0.2, -0.5, 0.2, 0.2)
    views = [(0, 48), (48, 32), (80, 12), (92, 8), (100, 24)]
    accessors = [(0, 5126, 4, "VEC3"), (1, 5126, 4, "VEC2"), (2, 5123, 6, "SCALAR"), (3, 5126, 2, "SCALAR"), (4, 5126, 2, "VEC3")]
    kinds = {material: kind for _, material, *_, kind in every}
    shared = list(kinds)
    looks = {"solid": {}, "moving": {}, "blended": {"alphaMode": "BLEND"}, "cut out": {"alphaMode": "MASK"}}

    def material(name, kind, emission):
        base = {"baseColorFactor": [0, 0, 0, 0.4 if kind == "blended" else 1], "metallicFactor": 0, "roughnessFactor": 1}
        if kind == "cut out":
            base["baseColorTexture"] = {"index": 0}
        return {**({"name": name} if name else {}), "doubleSided": True, "pbrMetallicRoughness": base, "emissiveFactor": emission, **looks[kind]}

    if emitting is None:
        materials, used = [material(name, kinds[name], [0, 0, 0]) for name in shared], [shared.index(m) for _, m, *_ in every]
    else:
        materials = [material(f"own {i}", thing[-1], [int(i == e) for e in emitting]) for i, thing in enumerate(every)]
        used = list(range(len(every)))
    nodes = [{**({"name": name} if name else {}), "mesh": i, "translation": [x, y, z], "scale": [w, h, 1]} for i, (name, _, x, y, z, w, h, _) in enumerate(every)]
    nodes.append({"camera": 0, "translation": [0, 0, 4]})
    mover = next(i for i, thing in enumerate(every) if thing[-1] == "moving")
    holes = png([[(255, 255, 255, 255 * ((x ^ y) & 1)) for x in range(8)] for y in range(8)])
    uri = lambda kind, body: f"data:{kind};base64," + base64.b64encode(body).decode()
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.55, "znear": 0.1}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": m}]} for m in used], "materials": materials,
            "textures": [{"source": 0}], "images": [{"uri": uri("image/png", holes)}],
            "animations": [{"samplers": [{"input": 3, "output": 4}], "channels": [{"sampler": 0, "target": {"node": mover, "path": "translation"}}]}],
            "accessors": [{"bufferView": v, "componentType": c, "count": n, "type": t, **({"min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0]} if v == 0 else {"min": [0], "max": [1]} if v == 3 else {})} for v, c, n, t in accessors],
            "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": n} for at, n in views],
            "buffers": [{"uri": uri("application/octet-stream", data), "byteLength": len(data)}]}


def pixels_of(file, channels="RGB"):
    import OpenEXR
    found = OpenEXR.File(str(file), separate_channels=True).channels()
    return numpy.stack([found[c].pixels for c in channels], axis=-1).astype(float)


class Job:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def render(self, name, gltf, flags):
        (self.folder / f"{name}.gltf").write_text(json.dumps(gltf))
        subprocess.run([self.program, "render", self.folder / f"{name}.gltf", "-o", self.folder / f"{name}.exr", "--size", f"{SIZE[0]}x{SIZE[1]}", "--spp", str(SPP), "--environment", "0,0,0",
                        "--max-depth", "0", "--time", "0", "--shutter", "0.2,0.9", "--aperture", "0.04", "--focus", "4", "--no-bvh-cache", "-q", *flags], check=True)
        return self.folder / f"{name}.exr"

    def coverage(self, flags):
        """The share of samples that show a thing, for each."""
        every, shares = list(things()), []
        for first in range(0, len(every), 3):
            picture = pixels_of(self.render("truth", scene(range(first, first + 3)), flags))
            shares += [picture[..., c] for c in range(3)]
        return shares[:len(every)]


def wanted_mattes(kind, shares):
    """Coverage by name, and the pixels that show more names than files have ranks."""
    wanted, every = {}, list(things())
    materials = list(dict.fromkeys(thing[1] for thing in every))
    for i, thing in enumerate(every):
        name = (thing[0] or f"instance {i}") if kind == "CryptoObject" else thing[1] or f"material {materials.index('')}"
        wanted[name] = wanted.get(name, 0) + shares[i]
    return wanted, sum((share > 0).astype(int) for share in wanted.values()) > RANKS


# Decoders: each returns {name: matte} of a type in a file, for the given names.


def by_specification(file, kind, names):
    import OpenEXR
    import mmh3
    part = OpenEXR.File(str(file), separate_channels=True)
    header, channels = part.header(), part.channels()
    key = f"cryptomatte/{mmh3.hash(kind.encode(), 0, signed=False):08x}"[:19]
    assert [header[f"{key}/{x}"] for x in ("name", "hash", "conversion")] == [kind, "MurmurHash3_32", "uint32_to_float32"], header
    manifest = json.loads(header[f"{key}/manifest"])
    assert set(manifest) <= set(names) and all(int(bits, 16) == id_of(name) for name, bits in manifest.items()), manifest
    layers = sorted({name.split(".")[0] for name in channels if name.startswith(kind) and name != kind})
    mattes = {}
    for name in names:
        bits = numpy.uint32(id_of(name))
        mattes[name] = sum(numpy.where(channels[f"{layer}.{a}"].pixels.view(numpy.uint32) == bits, channels[f"{layer}.{b}"].pixels, 0).astype(float)
                           for layer in layers for a, b in ("RG", "BA"))
        assert (name in manifest) == bool(mattes[name].any()), f"the manifest lists {name} wrongly"
    return mattes


def by_cryptomatte_api(file, kind, names):
    import cryptomatte_api
    matte = next(m for m in cryptomatte_api.Cryptomatte.load(str(file)) if m.metadata().name() == kind)
    found = matte.masks()
    return {name: numpy.array(found[name], dtype=float) if name in found else numpy.zeros((matte.height(), matte.width())) for name in names}


def by_blender(file, kind, names):
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    here = bpy.context.scene
    here.compositing_node_group = group = bpy.data.node_groups.new("matte", "CompositorNodeTree")
    group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    image = bpy.data.images.load(str(file))
    len(image.pixels)  # loads it, which finds its layers
    node, end = group.nodes.new("CompositorNodeCryptomatteV2"), group.nodes.new("NodeGroupOutput")
    node.source, node.image, node.layer_name = "IMAGE", image, kind
    group.links.new(node.outputs["Matte"], end.inputs[0])
    size = pixels_of(file).shape
    here.render.resolution_x, here.render.resolution_y, here.render.resolution_percentage = size[1], size[0], 100
    here.render.compositor_precision = "FULL"
    here.render.image_settings.file_format, here.render.image_settings.color_depth = "OPEN_EXR", "32"
    mattes = {}
    for name in names:
        bits = struct.unpack("<f", struct.pack("<I", id_of(name)))[0]
        node.matte_id = f"<{bits:.9g}>" if "," in name else name  # the node's list has commas between names or ids
        here.render.filepath = str(file.parent / "matte.exr")
        bpy.ops.render.render(write_still=True)
        mattes[name] = pixels_of(here.render.filepath)[..., 0]
    return mattes


DECODERS = {"specification": (by_specification, ("OpenEXR", "mmh3")), "cryptomatte-api": (by_cryptomatte_api, ("cryptomatte_api",)), "Blender": (by_blender, ("bpy", "OpenEXR"))}


def decode(name, *arguments):
    return DECODERS[name][0](*arguments)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--keep", help="a folder for the pictures")
    options = parser.parse_args()
    failed = ran = 0
    with tempfile.TemporaryDirectory() as temporary, multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        job = Job(options.program, pathlib.Path(options.keep or temporary))
        job.folder.mkdir(parents=True, exist_ok=True)
        missing = [name for name, (_, modules) in DECODERS.items() if not all(importlib.util.find_spec(m) for m in modules)]
        print(*(f"skipped: {name} is not installed\n" for name in missing), end="")
        shares = job.coverage([])
        print("| file | type | decoder | names | largest difference | pixels beyond ranks |\n|---|---|---|---:|---:|---:|")
        for (label, flags), kind in itertools.product(FILES.items(), TYPES):
            file = job.render(label, scene(), [*flags, "--aov", "crypto_object,crypto_material"])
            cut = [int(x) for x in flags[1].split(",")] if label == "crop" else (0, 0, *SIZE)
            part = lambda pixels: pixels[cut[1]:cut[1] + cut[3], cut[0]:cut[0] + cut[2]]
            wanted, is_over = wanted_mattes(kind, shares)
            for decoder in sorted(set(DECODERS) - set(missing)):
                found = pool.apply(decode, (decoder, file, kind, list(wanted)))
                worst = max(numpy.where(part(is_over), 0, abs(found[name] - part(share))).max() for name, share in wanted.items())
                # Names beyond the ranks are missing there; no other share changes.
                strange = sum((numpy.minimum(abs(found[name] - part(share)), found[name]) > TOLERANCE).sum() for name, share in wanted.items())
                good = worst <= TOLERANCE and strange == 0
                failed, ran = failed + (not good), ran + 1
                print(f"| {label} | {kind} | {decoder} | {len(wanted)} | {worst:.1e}{'' if good else ' FAILED'} | {part(is_over).sum()} |", flush=True)
    sys.exit(1 if failed else 0 if ran else 77)


if __name__ == "__main__":
    main()
