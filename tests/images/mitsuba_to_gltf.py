"""Turns the part of Mitsuba 3's scene format that Bitterli's Cornell box uses into a glTF: rectangles and cubes with a
matrix, two-sided diffuse materials, one-sided area lights, one perspective camera. Anything else is refused, so that no
picture is compared with one of another scene.

Source: Mitsuba 3's plugin reference (rectangle, cube, diffuse, twosided, area, perspective).
The one thing to know: an area light of Mitsuba emits from its front alone, as a glTF material that is not double sided
does here.
"""

import base64
import json
import math
import struct
import xml.etree.ElementTree as ElementTree

RECTANGLE = [[(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]]
CUBE = [[(-1, -1, -1), (-1, 1, -1), (1, 1, -1), (1, -1, -1)], [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
        [(-1, -1, -1), (1, -1, -1), (1, -1, 1), (-1, -1, 1)], [(-1, 1, -1), (-1, 1, 1), (1, 1, 1), (1, 1, -1)],
        [(-1, -1, -1), (-1, -1, 1), (-1, 1, 1), (-1, 1, -1)], [(1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)]]


def only(parent, tag, kind=None):
    """The one child of that tag, which must be of that type."""
    children = parent.findall(tag)
    if len(children) != 1 or (kind and children[0].get("type") != kind):
        raise ValueError(f"<{parent.tag} id={parent.get('id')}> needs one <{tag} type={kind}>")
    return children[0]


def matrix_of(element):
    """Rows of the 4x4 matrix of <transform name="to_world">."""
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
            "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_specular"], "scene": 0,
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
        # A specular weight of 0 takes off the coat of glTF's base material and leaves Lambert's law.
        material = {"doubleSided": not radiance,
                    "pbrMetallicRoughness": {"baseColorFactor": [*reflectance, 1], "metallicFactor": 0},
                    "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
        if radiance:
            strength = max(radiance)
            material["emissiveFactor"] = [c / strength for c in radiance]
            material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        return self.add("materials", material)

    def add_quads(self, name, quads, material):
        points = [point for quad in quads for point in quad]
        indices = [4 * i + k for i in range(len(quads)) for k in (0, 1, 2, 0, 2, 3)]
        positions = self.add_accessor(
            b"".join(struct.pack("<3f", *p) for p in points), componentType=5126, type="VEC3", count=len(points),
            min=[min(c) for c in zip(*points)], max=[max(c) for c in zip(*points)])
        corners = self.add_accessor(struct.pack(f"<{len(indices)}I", *indices), componentType=5125, type="SCALAR",
                                    count=len(indices))
        mesh = self.add("meshes", {"primitives": [
            {"attributes": {"POSITION": positions}, "indices": corners, "material": material}]})
        self.place({"name": name, "mesh": mesh})

    def text(self):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.document, "buffers": [{"byteLength": len(self.data), "uri": uri}]})


def add_camera(scene, sensor):
    defaults = {d.get("name"): d.get("value") for d in scene.findall("default")}
    sizes = {i.get("name"): i.get("value") for i in only(sensor, "film").findall("integer")}
    width, height = (int(defaults.get(sizes[name].lstrip("$"), sizes[name])) for name in ("width", "height"))
    fov = only(sensor, "float")
    if fov.get("name") != "fov":
        raise ValueError("the sensor needs a fov")
    # Mitsuba's angle of view is that of the width; its camera looks along +z with +x to the left.
    half_width = math.tan(math.radians(float(fov.get("value"))) / 2)
    m = matrix_of(sensor)
    columns = [[-m[r][0] for r in range(3)], [m[r][1] for r in range(3)], [-m[r][2] for r in range(3)],
               [m[r][3] for r in range(3)]]
    camera = {"type": "perspective", "perspective": {
        "aspectRatio": width / height, "yfov": 2 * math.atan(half_width * height / width), "znear": 0.01}}
    matrix = [c for column, w in zip(columns, (0, 0, 0, 1)) for c in [*column, w]]
    return camera, matrix, width, height


def convert(source):
    """glTF text of the Mitsuba scene at path `source`, and the size of its picture. Throws ValueError for what it does
    not know."""
    scene = ElementTree.parse(source).getroot()
    gltf = GltfScene()
    reflectances = {}
    for bsdf in scene.findall("bsdf"):
        if bsdf.get("type") != "twosided":
            raise ValueError(f"material {bsdf.get('id')} is not twosided")
        reflectances[bsdf.get("id")] = rgb_of(only(bsdf, "bsdf", "diffuse"), "reflectance")

    for shape in scene.findall("shape"):
        quads = {"rectangle": RECTANGLE, "cube": CUBE}.get(shape.get("type"))
        if quads is None:
            raise ValueError(f"shape {shape.get('id')} is neither a rectangle nor a cube")
        matrix = matrix_of(shape)
        quads = [[transformed(matrix, corner) for corner in quad] for quad in quads]
        reflectance = reflectances[only(shape, "ref").get("id")]
        if shape.find("emitter") is None:
            gltf.add_quads(shape.get("id"), quads, gltf.add_material(reflectance))
            continue
        if shape.get("type") != "rectangle" or any(reflectance):
            raise ValueError(f"light {shape.get('id')} is not a black rectangle")
        radiance = rgb_of(only(shape, "emitter", "area"), "radiance")
        gltf.add_quads(shape.get("id"), quads, gltf.add_material(reflectance, radiance))

    camera, matrix, width, height = add_camera(scene, only(scene, "sensor", "perspective"))
    gltf.place({"name": "camera", "camera": gltf.add("cameras", camera), "matrix": matrix})
    return gltf.text(), width, height
