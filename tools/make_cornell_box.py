#!/usr/bin/env python3
"""Writes scenes/cornell-box/cornell-box.gltf from the published measurements of the Cornell box.

Source: Cornell University Program of Computer Graphics, "Cornell Box Data" (revision of 1998): vertex lists in
millimetres, reflectance spectra every 4 nm, the light's spectrum at four wavelengths, the camera.

What is ours: millimetres become metres, spectra become linear Rec. 709 (below), and the ceiling has a hole where the
light is, as the data page asks for, since the two lie in one plane. The published frame is right-handed with +y up, so
its coordinates are kept; the camera looks along +z and sees +x on its left.

`make_cornell_box.py --check` writes nothing and fails when the file is not what this script would write.
"""

import json
import math
import pathlib

from gltf_buffer import GltfBuffer
from written_scenes import write_or_check

TARGET = pathlib.Path(__file__).resolve().parent.parent / "scenes/cornell-box/cornell-box.gltf"

# Measured reflectances, 400 to 700 nm in steps of 4 nm.
WHITE = """
.343 .445 .551 .624 .665 .687 .708 .723 .715 .710 .745 .758 .739 .767 .777 .765 .751 .745 .748 .729 .745 .757 .753 .750
.746 .747 .735 .732 .739 .734 .725 .721 .733 .725 .732 .743 .744 .748 .728 .716 .733 .726 .713 .740 .754 .764 .752 .736
.734 .741 .740 .732 .745 .755 .751 .744 .731 .733 .744 .731 .712 .708 .729 .730 .727 .707 .703 .729 .750 .760 .751 .739
.724 .730 .740 .737"""
GREEN = """
.092 .096 .098 .097 .098 .095 .095 .097 .095 .094 .097 .098 .096 .101 .103 .104 .107 .109 .112 .115 .125 .140 .160 .187
.229 .285 .343 .390 .435 .464 .472 .476 .481 .462 .447 .441 .426 .406 .373 .347 .337 .314 .285 .277 .266 .250 .230 .207
.186 .171 .160 .148 .141 .136 .130 .126 .123 .121 .122 .119 .114 .115 .117 .117 .118 .120 .122 .128 .132 .139 .144 .146
.150 .152 .157 .159"""
RED = """
.040 .046 .048 .053 .049 .050 .053 .055 .057 .056 .059 .057 .061 .061 .060 .062 .062 .062 .061 .062 .060 .059 .057 .058
.058 .058 .056 .055 .056 .059 .057 .055 .059 .059 .058 .059 .061 .061 .063 .063 .067 .068 .072 .080 .090 .099 .124 .154
.192 .255 .287 .349 .402 .443 .487 .513 .558 .584 .620 .606 .609 .651 .612 .610 .650 .638 .627 .620 .630 .628 .642 .639
.657 .639 .635 .642"""
LIGHT_REFLECTANCE = 0.78  # equal at every wavelength
LIGHT = {400: 0.0, 500: 8.0, 600: 15.6, 700: 18.4}  # emitted radiance; the page states no unit

# CIE 1931 2-degree colour matching functions, 400 to 700 nm in steps of 5 nm.
CMF_X = """
.01431 .02319 .04351 .07763 .13438 .21477 .2839 .3285 .34828 .34806 .3362 .3187 .2908 .2511 .19536 .1421 .09564 .05795
.03201 .0147 .0049 .0024 .0093 .0291 .06327 .1096 .1655 .22575 .2904 .3597 .43345 .51205 .5945 .6784 .7621 .8425 .9163
.9786 1.0263 1.0567 1.0622 1.0456 1.0026 .9384 .85445 .7514 .6424 .5419 .4479 .3608 .2835 .2187 .1649 .1212 .0874 .0636
.04677 .0329 .0227 .01584 .011359"""
CMF_Y = """
.000396 .00064 .00121 .00218 .004 .0073 .0116 .01684 .023 .0298 .038 .048 .06 .0739 .09098 .1126 .13902 .1693 .20802
.2586 .323 .4073 .503 .6082 .71 .7932 .862 .91485 .954 .9803 .99495 1 .995 .9786 .952 .9154 .87 .8163 .757 .6949 .631
.5668 .503 .4412 .381 .321 .265 .217 .175 .1382 .107 .0816 .061 .04458 .032 .0232 .017 .01192 .00821 .005723 .004102"""
CMF_Z = """
.06785 .1102 .2074 .3713 .6456 1.03905 1.3856 1.62296 1.74706 1.7826 1.77211 1.7441 1.6692 1.5281 1.28764 1.0419 .81295
.6162 .46518 .3533 .272 .2123 .1582 .1117 .07825 .05725 .04216 .02984 .0203 .0134 .00875 .00575 .0039 .00275 .0021
.0018 .00165 .0014 .0011 .001 .0008 .0006 .00034 .00024 .00019 .0001 .00005 .00003 .00002 .00001 0 0 0 0 0 0 0 0 0 0
0"""
# CIE standard illuminant D65, 400 to 700 nm in steps of 10 nm; linear in between by its definition.
D65 = """
82.7549 91.486 93.4318 86.6823 104.865 117.008 117.812 114.861 115.923 108.811 109.354 107.802 104.79 107.689 104.405
104.046 100 96.3342 95.788 88.6856 90.0062 89.5991 87.6987 83.2886 83.6992 80.0268 80.2146 82.2778 78.2842 69.7213
71.6091"""

REC709_FROM_XYZ = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560),
                   (0.0556434, -0.2040259, 1.0572252))


def table(text):
    """A function of wavelength from values spread evenly over 400 to 700 nm, linear in between."""
    values = [float(word) for word in text.split()]
    step = 300 / (len(values) - 1)

    def at(nm):
        i = min(int((nm - 400) / step), len(values) - 2)
        f = (nm - 400) / step - i
        return values[i] * (1 - f) + values[i + 1] * f

    return at


def light_spectrum(nm):
    low = min(400 + (nm - 400) // 100 * 100, 600)
    f = (nm - low) / 100
    return LIGHT[low] * (1 - f) + LIGHT[low + 100] * f


def xyz(spectrum):
    return [math.fsum(cmf(nm) * spectrum(nm) for nm in range(400, 701)) for cmf in map(table, (CMF_X, CMF_Y, CMF_Z))]


def rec709(xyz_values):
    return [math.fsum(m * c for m, c in zip(row, xyz_values)) for row in REC709_FROM_XYZ]


def reflectance(text):
    """Rec. 709 of a surface under D65, channel by channel over a perfect white under the same light: a spectrum of
    ones is exactly (1, 1, 1)."""
    d65, r = table(D65), table(text)
    lit = rec709(xyz(lambda nm: d65(nm) * r(nm)))
    white = rec709(xyz(d65))
    return [round(a / b, 4) for a, b in zip(lit, white)]


def emission():
    """Rec. 709 of the light, so scaled that a light of 1 at every wavelength has luminance 1. The published numbers
    have no unit; they are taken as W/(sr m2) over the band that each channel stands for."""
    luminance_of_one = xyz(lambda nm: 1.0)[1]
    return [round(c / luminance_of_one, 3) for c in rec709(xyz(light_spectrum))]


# Quads in the published order: counter-clockwise seen from where they are looked at. Millimetres.
FLOOR = [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]
LIGHT_QUAD = [(343, 548.8, 227), (343, 548.8, 332), (213, 548.8, 332), (213, 548.8, 227)]
CEILING = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
BACK_WALL = [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]
RIGHT_WALL = [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]
LEFT_WALL = [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]
SHORT_BLOCK_TOP = [(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)]
TALL_BLOCK_TOP = [(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)]
CAMERA_POSITION = (278, 273, -800)
FOCAL_LENGTH, FILM_SIZE = 35, 25


def quad(corners):
    a, b, c, d = corners
    return [(a, b, c), (a, c, d)]


def frame(outer, inner):
    """The flat ring between two quads whose corners match."""
    triangles = []
    for i in range(4):
        j = (i + 1) % 4
        triangles += quad([outer[i], outer[j], inner[j], inner[i]])
    return triangles


def block(top):
    """Top and four sides; the underside stands on the floor and is left out, as in the published data."""
    triangles = quad(top)
    for i in range(4):
        (ax, ay, az), (bx, by, bz) = top[i], top[(i + 1) % 4]
        triangles += quad([(bx, by, bz), (ax, ay, az), (ax, 0, az), (bx, 0, bz)])
    return triangles


OBJECTS = [
    ("floor", "white", quad(FLOOR)),
    ("ceiling", "white", frame(CEILING, LIGHT_QUAD)),
    ("back wall", "white", quad(BACK_WALL)),
    ("right wall", "green", quad(RIGHT_WALL)),
    ("left wall", "red", quad(LEFT_WALL)),
    ("short block", "white", block(SHORT_BLOCK_TOP)),
    ("tall block", "white", block(TALL_BLOCK_TOP)),
    ("light", "light", quad(LIGHT_QUAD)),
]


def material(name, color, emitted=None):
    # glTF's base material has a dielectric coat; a specular weight of 0 takes it off and leaves Lambert's law.
    result = {
        "name": name,
        "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
    }
    if emitted:
        strength = max(emitted)
        result["emissiveFactor"] = [round(c / strength, 9) for c in emitted]
        result["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
    return result


def make_gltf():
    materials = [material("white", reflectance(WHITE)), material("green", reflectance(GREEN)),
                 material("red", reflectance(RED)), material("light", [LIGHT_REFLECTANCE] * 3, emission())]
    index_of = {m["name"]: i for i, m in enumerate(materials)}

    buffer, meshes, nodes = GltfBuffer(), [], []
    for name, material_name, triangles in OBJECTS:
        vertices = sorted({v for t in triangles for v in t})
        positions = buffer.add([[c / 1000 for c in v] for v in vertices], "f", "VEC3", has_bounds=True, target=34962)
        corners = buffer.add([vertices.index(v) for t in triangles for v in t], "H", "SCALAR", target=34963)
        meshes.append({"name": name, "primitives": [
            {"attributes": {"POSITION": positions}, "indices": corners, "material": index_of[material_name]}]})
        nodes.append({"name": name, "mesh": len(meshes) - 1})

    # glTF's camera looks along -z; half a turn about +y makes that the published +z.
    nodes.append({"name": "camera", "camera": 0, "rotation": [0, 1, 0, 0],
                  "translation": [c / 1000 for c in CAMERA_POSITION]})
    return {
        "asset": {"version": "2.0", "generator": "tools/make_cornell_box.py",
                  "copyright": "Measurements: Cornell University Program of Computer Graphics"},
        "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_specular"],
        "scene": 0,
        "scenes": [{"name": "Cornell box", "nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "cameras": [{"name": "camera", "type": "perspective", "perspective": {
            "aspectRatio": 1, "yfov": round(2 * math.atan(FILM_SIZE / 2 / FOCAL_LENGTH), 9), "znear": 0.01}}],
        "materials": materials,
        "meshes": meshes,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [buffer.describe()],
    }


if __name__ == "__main__":
    write_or_check(__doc__, {TARGET: json.dumps(make_gltf(), indent=1) + "\n"})
