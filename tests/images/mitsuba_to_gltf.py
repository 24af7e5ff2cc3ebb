"""Turns the part of Mitsuba's scene formats (3 and 0.6) that Bitterli's Cornell box and water caustic use into a glTF:
rectangles, cubes and binary PLY files of triangles with a matrix, diffuse materials and smooth glass, one-sided area
lights, one perspective camera. Everything else is refused, so that no picture is compared with one of another scene.

Source: Mitsuba's plugin reference (rectangle, cube, ply, diffuse, twosided, dielectric, area, perspective).
An area light of Mitsuba emits only from its front, like a glTF material that is not double sided here. A diffuse
material of Mitsuba that is not two-sided is black from behind, and here it is not. Pictures of closed or inward-facing
surfaces do not show the difference.

The program writes the glTF to the standard output: mitsuba_to_gltf.py SCENE.xml
"""

import base64
import json
import math
import pathlib
import struct
import sys
import xml.etree.ElementTree as ElementTree

RECTANGLE = [[(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]]
CUBE = [[(-1, -1, -1), (-1, 1, -1), (1, 1, -1), (1, -1, -1)], [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
        [(-1, -1, -1), (1, -1, -1), (1, -1, 1), (-1, -1, 1)], [(-1, 1, -1), (-1, 1, 1), (1, 1, 1), (1, 1, -1)],
        [(-1, -1, -1), (-1, -1, 1), (-1, 1, 1), (-1, 1, -1)], [(1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)]]


def only(parent, tag, kind=None):
    """Returns the only child with that tag, which must have that type."""
    children = parent.findall(tag)
    if len(children) != 1 or (kind and children[0].get("type") != kind):
        raise ValueError(f"<{parent.tag} id={parent.get('id')}> needs one <{tag} type={kind}>")
    return children[0]


def matrix_of(element):
    """Returns the rows of the 4x4 matrix of <transform name="to_world">."""
    values = [float(word) for word in only(only(element, "transform"), "matrix").get("value").split()]
    return [values[i:i + 4] for i in range(0, 16, 4)]


def transformed(matrix, point):
    return tuple(math.fsum([*(m * p for m, p in zip(row, point)), row[3]]) for row in matrix[:3])


def rgb_of(element, name):
    rgb = only(element, "rgb")
    if rgb.get("name") != name:
        raise ValueError(f"<{element.tag}> needs <rgb name={name}>")
    return [float(word) for word in rgb.get("value").replace(",", " ").split()]


class GltfScene:
    """A glTF document with one buffer, written quad by quad."""

    def __init__(self):
        self.data = b""
        self.document = {
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_specular",
                               "KHR_materials_transmission", "KHR_materials_volume"], "scene": 0,
            "scenes": [{"nodes": []}], "nodes": [], "cameras": [], "materials": [], "meshes": [], "accessors": [],
            "bufferViews": []}

    def add(self, key, value):
        self.document[key].append(value)
        return len(self.document[key]) - 1

    def place(self, node):
        self.document["scenes"][0]["nodes"].append(self.add("nodes", node))

    def add_accessor(self, payload, **accessor):
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(payload)})
        self.data += payload
        return self.add("accessors", {"bufferView": view, **accessor})

    def add_material(self, reflectance, radiance=None):
        # A specular weight of 0 removes the specular layer of glTF's base material and leaves Lambert's law.
        material = {"doubleSided": not radiance,
                    "pbrMetallicRoughness": {"baseColorFactor": [*reflectance, 1], "metallicFactor": 0},
                    "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
        if radiance:
            strength = max(radiance)
            material["emissiveFactor"] = [c / strength for c in radiance]
            material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        return self.add("materials", material)

    def add_glass(self, ior):
        return self.add("materials", {
            "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}, "extensions": {
                "KHR_materials_ior": {"ior": ior}, "KHR_materials_transmission": {"transmissionFactor": 1},
                "KHR_materials_volume": {"thicknessFactor": 1}}})

    def add_mesh(self, name, points, normals, indices, material):
        """Without `normals` the faces are flat."""
        def vectors(values, **bounds):
            return self.add_accessor(b"".join(struct.pack("<3f", *v) for v in values), componentType=5126, type="VEC3",
                                     count=len(values), **bounds)
        attributes = {"POSITION": vectors(points, min=[min(c) for c in zip(*points)],
                                          max=[max(c) for c in zip(*points)])}
        if normals:
            attributes["NORMAL"] = vectors(normals)
        corners = self.add_accessor(struct.pack(f"<{len(indices)}I", *indices), componentType=5125, type="SCALAR",
                                    count=len(indices))
        mesh = self.add("meshes", {"primitives": [
            {"attributes": attributes, "indices": corners, "material": material}]})
        self.place({"name": name or f"shape {mesh}", "mesh": mesh})

    def add_quads(self, name, quads, material):
        points = [point for quad in quads for point in quad]
        indices = [4 * i + k for i in range(len(quads)) for k in (0, 1, 2, 0, 2, 3)]
        self.add_mesh(name, points, None, indices, material)

    def text(self):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.document, "buffers": [{"byteLength": len(self.data), "uri": uri}]})


def read_ply(path):
    """Returns points, normals (or None) and triangle indices of a binary PLY file."""
    header, _, data = path.read_bytes().partition(b"end_header\n")
    words = [line.split() for line in header.decode().splitlines()]
    names = [word[2] for word in words if word[:2] == ["property", "float"]]
    counts = [int(word[2]) for word in words if word[0] == "element"]
    if words[1][1:] != ["binary_little_endian", "1.0"] or ["property", "list", "uchar", "int", "vertex_indices"] not in \
            words or names not in (["x", "y", "z"], ["x", "y", "z", "nx", "ny", "nz"]):
        raise ValueError(f"{path.name} has other properties than positions, normals and triangles")
    vertices = list(struct.iter_unpack(f"<{len(names)}f", data[:4 * len(names) * counts[0]]))
    faces = list(struct.iter_unpack("<B3i", data[4 * len(names) * counts[0]:]))
    if len(faces) != counts[1] or any(face[0] != 3 for face in faces):
        raise ValueError(f"{path.name} has faces that are no triangles")
    normals = [vertex[3:] for vertex in vertices] if len(names) == 6 else None
    return [vertex[:3] for vertex in vertices], normals, [corner for face in faces for corner in face[1:]]


def add_ply(gltf, folder, shape, material):
    """The matrix may scale only along the axes."""
    matrix = matrix_of(shape)
    scale = [matrix[k][k] for k in range(3)]
    if any(matrix[r][c] != (scale[r] if r == c else 0) for r in range(3) for c in range(4)) or min(scale) <= 0:
        raise ValueError(f"shape {shape.get('id')} is turned or moved")
    points, normals, indices = read_ply(folder / only(shape, "string").get("value"))
    flags = {flag.get("name"): flag.get("value") for flag in shape.findall("boolean")}
    if flags.pop("faceNormals", "false") == "true":
        normals = None
    if flags:
        raise ValueError(f"shape {shape.get('id')} has other flags than faceNormals")
    if normals:
        normals = [tuple(n / s for n, s in zip(normal, scale)) for normal in normals]
        normals = [tuple(n / math.hypot(*normal) for n in normal) for normal in normals]
    gltf.add_mesh(shape.get("id"), [transformed(matrix, point) for point in points], normals, indices, material)


def ior_of(bsdf):
    """Returns the index of refraction of smooth glass in air. Raises ValueError for any other material."""
    values = {f.get("name").replace("_ior", "IOR"): float(f.get("value")) for f in bsdf.findall("float")}
    if set(values) != {"intIOR", "extIOR"} or values["extIOR"] != 1:
        raise ValueError(f"material {bsdf.get('id')} is no glass in air")
    return values["intIOR"]


def add_camera(scene, sensor):
    defaults = {d.get("name"): d.get("value") for d in scene.findall("default")}
    sizes = {i.get("name"): i.get("value") for i in only(sensor, "film").findall("integer")}
    width, height = (int(defaults.get(sizes[name].lstrip("$"), sizes[name])) for name in ("width", "height"))
    fov = only(sensor, "float")
    if fov.get("name") != "fov":
        raise ValueError("the sensor needs a fov")
    # Mitsuba's angle of view is horizontal, and its camera looks along +z with +x to the left.
    half_width = math.tan(math.radians(float(fov.get("value"))) / 2)
    m = matrix_of(sensor)
    columns = [[-m[r][0] for r in range(3)], [m[r][1] for r in range(3)], [-m[r][2] for r in range(3)],
               [m[r][3] for r in range(3)]]
    camera = {"type": "perspective", "perspective": {
        "aspectRatio": width / height, "yfov": 2 * math.atan(half_width * height / width), "znear": 0.01}}
    matrix = [c for column, w in zip(columns, (0, 0, 0, 1)) for c in [*column, w]]
    return camera, matrix, width, height


def convert(source):
    """Returns the glTF text of the Mitsuba scene at path `source`, and the size of its picture. Raises ValueError for
    unsupported elements."""
    scene = ElementTree.parse(source).getroot()
    gltf = GltfScene()
    reflectances, glasses = {}, {}
    for bsdf in scene.findall("bsdf"):
        name = bsdf.get("id")
        if bsdf.get("type") == "dielectric":
            glasses[name] = gltf.add_glass(ior_of(bsdf))
            continue
        if bsdf.get("type") == "twosided":
            bsdf = only(bsdf, "bsdf", "diffuse")
        if bsdf.get("type") != "diffuse":
            raise ValueError(f"material {name} is neither diffuse nor smooth glass")
        reflectances[name] = rgb_of(bsdf, "reflectance")

    for shape in scene.findall("shape"):
        material = only(shape, "ref").get("id")
        emits = shape.find("emitter") is not None
        if shape.get("type") == "ply" and not emits:
            add_ply(gltf, pathlib.Path(source).parent, shape, glasses[material] if material in glasses else
                    gltf.add_material(reflectances[material]))
            continue
        quads = {"rectangle": RECTANGLE, "cube": CUBE}.get(shape.get("type"))
        if quads is None or material not in reflectances:
            raise ValueError(f"shape {shape.get('id')} is neither a rectangle nor a cube that is diffuse")
        matrix = matrix_of(shape)
        quads = [[transformed(matrix, corner) for corner in quad] for quad in quads]
        reflectance = reflectances[material]
        if not emits:
            gltf.add_quads(shape.get("id"), quads, gltf.add_material(reflectance))
            continue
        if shape.get("type") != "rectangle" or any(reflectance):
            raise ValueError(f"light {shape.get('id')} is not a black rectangle")
        radiance = rgb_of(only(shape, "emitter", "area"), "radiance")
        gltf.add_quads(shape.get("id"), quads, gltf.add_material(reflectance, radiance))

    camera, matrix, width, height = add_camera(scene, only(scene, "sensor", "perspective"))
    gltf.place({"name": "camera", "camera": gltf.add("cameras", camera), "matrix": matrix})
    return gltf.text(), width, height


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    print(convert(sys.argv[1])[0])
