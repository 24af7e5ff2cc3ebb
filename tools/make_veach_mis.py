#!/usr/bin/env python3
"""Writes Veach's four plates and three balls of light as OBJ and MTL, from Bitterli's Mitsuba 3 file of that scene:
tools/make_veach_mis.py scene_mitsuba3.xml OUT.obj

For measuring noise, not for comparing pictures: the balls are meshes, and the plates' Beckmann metals are GGX ones of the
same roughness. Camera: --eye 28.2792,3.5,0 --target 0,3.5,0 --fov 20.11 (16:9), direct light alone.

Source of the scene: Veach, Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995, figure 2.
"""

import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "images"))
from make_transport_scenes import sphere  # noqa: E402
from mitsuba_to_gltf import CUBE, RECTANGLE, matrix_of, transformed  # noqa: E402

def material_lines(bsdf):
    inner = bsdf.find("bsdf")
    values = {e.get("name"): e.get("value").replace(",", " ") for e in inner if e.get("value")}
    if inner.get("type") == "diffuse":
        return [f"Kd {values['reflectance']}"]
    scale = [float(c) for c in values["specular_reflectance"].split()]
    eta, k = ([float(c) for c in values[name].split()] for name in ("eta", "k"))
    at_normal = [s * ((n - 1) ** 2 + m * m) / ((n + 1) ** 2 + m * m) for s, n, m in zip(scale, eta, k)]
    return ["Kd " + " ".join(f"{c:.6f}" for c in at_normal), "Pm 1", f"Pr {math.sqrt(float(values['alpha'])):.6f}"]


def main():
    source, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    scene = ElementTree.parse(source).getroot()
    mtl = []
    for bsdf in scene.findall("bsdf"):
        mtl += [f"newmtl {bsdf.get('id')}", *material_lines(bsdf)]
    obj, count = [f"mtllib {out.with_suffix('.mtl').name}"], 0
    for shape in scene.findall("shape"):
        name = shape.find("ref").get("id")
        if shape.get("type") == "sphere":
            place = shape.find("point")
            polygons = sphere([float(place.get(c)) for c in "xyz"], float(shape.find("float").get("value")))
            name = shape.get("id")
            mtl += [f"newmtl {name}", "Kd 0 0 0", "Ke " + shape.find("emitter/rgb").get("value").replace(",", " ")]
        else:
            quads = {"rectangle": RECTANGLE, "cube": CUBE}[shape.get("type")]
            matrix = matrix_of(shape)
            polygons = [[transformed(matrix, corner) for corner in quad] for quad in quads]
        obj.append(f"usemtl {name}")
        for polygon in polygons:
            obj += ["v " + " ".join(f"{c:.9g}" for c in p) for p in polygon]
            obj.append("f " + " ".join(str(count + 1 + i) for i in range(len(polygon))))
            count += len(polygon)
    out.write_text("\n".join(obj) + "\n")
    out.with_suffix(".mtl").write_text("\n".join(mtl) + "\n")


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
