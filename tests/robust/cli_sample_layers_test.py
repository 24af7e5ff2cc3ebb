#!/usr/bin/env python3
"""Layers of names (Cryptomatte, decoded here by its specification), texture coordinates, numbers of samples and variance."""

import json
import struct

from cli_run import CliTest, main, read_exr, write

SQUARES = "vt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\n" + "".join(
    f"o {name}\nusemtl {material}\nv {x} 0 -1\nv {x + 1} 0 -1\nv {x + 1} 0 1\nv {x} 0 1\nf {i * 4 + 4}/4 {i * 4 + 3}/3 {i * 4 + 2}/2 {i * 4 + 1}/1\n"
    for i, (name, material, x) in enumerate([("left", "red", -1.5), ("right", "blue", 0.5), ("middle", "red", -0.5)]))
DOWN = ["--eye", "0,3,0", "--target", "0,0,0", "--projection", "orthographic", "--view-height", "4", "--environment", "1,1,1"]
ALL = "uv,crypto_object,crypto_material,samples,variance"


def murmur3(data):
    """MurmurHash3 of 32 bits with seed 0, from its description."""
    def mixed(word):
        word = word * 0xCC9E2D51 & 0xFFFFFFFF
        return (word << 15 | word >> 17) * 0x1B873593 & 0xFFFFFFFF

    result, whole = 0, len(data) // 4 * 4
    for i in range(0, whole, 4):
        result ^= mixed(int.from_bytes(data[i : i + 4], "little"))
        result = ((result << 13 | result >> 19) & 0xFFFFFFFF) * 5 + 0xE6546B64 & 0xFFFFFFFF
    result ^= mixed(int.from_bytes(data[whole:], "little")) ^ len(data)
    for shift, factor in (16, 0x85EBCA6B), (13, 0xC2B2AE35), (16, 1):
        result = (result ^ result >> shift) * factor & 0xFFFFFFFF
    return result


def id_of(name):
    bits = murmur3(name.encode())
    return bits ^ 1 << 23 if bits >> 23 & 255 in (0, 255) else bits


class SampleLayers(CliTest):
    def mattes(self, file, kind):
        """Decodes the mattes of a type. Returns {name: coverage} of each pixel."""
        info, (width, height, rows) = self.info(file), read_exr(self.path(file))
        prefix = f"cryptomatte/{murmur3(kind.encode()):08x}"[:19] + "/"
        self.assertEqual((info[prefix + "name"], info[prefix + "hash"], info[prefix + "conversion"]), (kind, "MurmurHash3_32", "uint32_to_float32"))
        manifest = json.loads(info[prefix + "manifest"])
        for name, bits in manifest.items():
            self.assertEqual(int(bits, 16), id_of(name), name)
        names, pixels = {int(bits, 16): name for name, bits in manifest.items()}, []
        layers = sorted({name.split(".")[0] for name in rows if name.startswith(kind)})
        self.assertEqual(layers, [f"{kind}{i:02}" for i in range(4)])
        for y in range(height):
            for x in range(width):
                ranks = [(rows[f"{layer}.{a}"][y][x], rows[f"{layer}.{b}"][y][x]) for layer in layers for a, b in ("RG", "BA")]
                shares = [share for _, share in ranks]
                self.assertEqual(shares, sorted(shares, reverse=True))
                pixels.append({names[struct.unpack("<I", struct.pack("<f", bits))[0]]: share for bits, share in ranks if share > 0})
        return pixels

    def test_mattes_decode_to_the_names_and_coverage_of_objects_and_materials(self):
        write(self.path("squares.obj"), SQUARES)
        self.render(*DOWN, "--aov", ALL + ",ids", "--transparent", scene="squares.obj", size="24x16", spp=64, output="x.exr")
        _, _, rows = read_exr(self.path("x.exr"))
        objects, materials = self.mattes("x.exr", "CryptoObject"), self.mattes("x.exr", "CryptoMaterial")
        alpha = [a for row in rows["A"] for a in row]
        for pixel, of_material, a in zip(objects, materials, alpha):
            self.assertAlmostEqual(sum(pixel.values()), a, places=6)
            self.assertEqual(of_material.get("blue", 0), pixel.get("right", 0))
            self.assertAlmostEqual(of_material.get("red", 0), pixel.get("left", 0) + pixel.get("middle", 0), places=6)
        self.assertEqual(set().union(*objects), {"left", "middle", "right"})
        self.assertGreater(sum(len(pixel) == 2 for pixel in objects), 10)
        self.assertTrue(any(0.2 < a < 0.8 for a in alpha) and 0 in alpha and 1 in alpha)
        for y, row in enumerate(rows["uv.u"]):
            for x, u in enumerate(row):
                at = ((x + 0.5) / 4 - 1.5) % 1  # pixels at a square's ends show two
                if rows["A"][y][x] == 1 and 0.3 < at < 0.7:
                    self.assertAlmostEqual(u, at * 2, delta=0.06)
                if rows["A"][y][x] == 0:
                    self.assertEqual(u, 0)
        self.assertEqual({n for row in rows["samples.N"] for n in row}, {64})

    def test_one_sample_has_the_name_of_its_id_by_every_integrator(self):
        for integrator in "path", "distributed", "bidirectional", "hybrid":
            self.render("--aov", "ids,crypto_object", "--integrator", integrator, size="16x12", output="x.exr")
            names, pixels = json.loads(self.info("x.exr")["pertev.instances"]), self.mattes("x.exr", "CryptoObject")
            _, _, rows = read_exr(self.path("x.exr"))
            ids = [i for row in rows["id.instance"] for i in row]
            differ = sum(pixel != {names[str(i)]: 1} for pixel, i in zip(pixels, ids) if str(i) in names and names[str(i)])
            self.assertEqual(differ, 0, integrator)
            self.assertGreater(len(set().union(*pixels)), 3)

    def test_variance_is_that_of_the_samples_and_parts_merge_exactly(self):
        flags = ["--aov", ALL, "--sampler", "independent"]
        whole = self.render(*flags, size="9x7", spp=5, output="whole.exr")
        _, _, rows = read_exr(self.path("whole.exr"))
        singles = []
        for i in range(5):
            self.succeed("render", "cornell-box", "-o", "s.exr", "--size", "9x7", "--device", "cpu", "--sampler", "independent", "--samples", f"{i}:{i + 1}")
            singles.append(read_exr(self.path("s.exr"))[2])
        for channel in "RGB":
            for y in range(7):
                for x in range(9):
                    values = [single[channel][y][x] for single in singles]
                    mean = sum(values) / 5
                    wanted = sum((value - mean) ** 2 for value in values) / 4 / 5
                    self.assertAlmostEqual(rows["variance." + channel][y][x], wanted, delta=1e-5 * wanted + 1e-12)
        for name, part in {"a": "--samples 0:2", "b": "--samples 2:5"}.items():
            self.succeed("render", "cornell-box", "-o", name + ".pvf", "--size", "9x7", "--device", "cpu", "--exposure", "0", *flags, *part.split())
        merged = self.succeed("merge", "b.pvf", "a.pvf", "-o", "all.exr", "--json").events("done")[0]
        self.assertEqual([merged[key] for key in ("hash", "layers_hash")], [whole[key] for key in ("hash", "layers_hash")])
        self.assertEqual(self.mattes("all.exr", "CryptoObject"), self.mattes("whole.exr", "CryptoObject"))
        for rows_of in "0:3", "3:7":
            self.render(*flags, "--rows", rows_of, "--exposure", "0", size="9x7", spp=5, output=rows_of[0] + ".pvf")
        merged = self.succeed("merge", "0.pvf", "3.pvf", "-o", "all.exr", "--json").events("done")[0]
        self.assertEqual(merged["layers_hash"], whole["layers_hash"])
        self.assertEqual(self.render("--sampler", "independent", size="9x7", spp=5, output="plain.exr")["hash"], whole["hash"])

    def test_layers_of_samples_are_refused_where_they_do_not_exist(self):
        self.refuse(2, "render", "nowhere.obj", "-o", "x.exr", "--aov", "variance", "--denoise", "svgf", says=["--aov", "--denoise"])
        self.refuse(2, "render", "nowhere.obj", "-o", "x-#.exr", "--frames", "0-1", "--aov", "crypto_object", "--real-time", says=["--aov", "--real-time"])
        self.refuse(2, "render", "nowhere.obj", "-o", "x.exr", "--aov", "crypto_objects", says=["--aov"])
        self.refuse(2, "render", "nowhere.obj", "-o", "x.png", "--aov", "uv", says=["--aov", "EXR"])


if __name__ == "__main__":
    main()
