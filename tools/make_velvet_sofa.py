#!/usr/bin/env python3
"""Writes the Khronos sample model GlamVelvetSofa as a Mitsuba 3 scene, for measuring: make_velvet_sofa.py GlamVelvetSofa.glb OUT.xml

Mitsuba has no sheen of glTF's kind: the fabric is its nearest, principled with sheen. The light is the model's, and a constant sky.
"""

import json
import pathlib
import struct
import sys

from make_material_balls import principled, two_sided

EYE, TARGET, FOV, SKY = (1.3, 1.1, 2.6), (0, 0.35, -0.1), 32, 0.5
COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


class Model:
    """A GLB file whose accessors are floats and 16-bit indices."""

    def __init__(self, path):
        data = path.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json, self.buffer = json.loads(data[20:20 + length]), data[28 + length:]

    def numbers(self, index):
        """Returns the rows of an accessor."""
        accessor = self.json["accessors"][index]
        view, count = self.json["bufferViews"][accessor["bufferView"]], COUNTS[accessor["type"]]
        form = f"<{count}{'H' if accessor['componentType'] == 5123 else 'f'}"
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        step = view.get("byteStride", struct.calcsize(form))
        return [struct.unpack_from(form, self.buffer, start + i * step) for i in range(accessor["count"])]

    def image(self, index):
        view = self.json["bufferViews"][self.json["images"][index]["bufferView"]]
        return self.buffer[view.get("byteOffset", 0):][:view["byteLength"]]


def write_obj(model, primitive, path):
    attributes = primitive["attributes"]
    lines = [f"v {x} {y} {z}" for x, y, z in model.numbers(attributes["POSITION"])]
    lines += [f"vt {u} {1 - v}" for u, v in model.numbers(attributes["TEXCOORD_0"])]
    lines += [f"vn {x} {y} {z}" for x, y, z in model.numbers(attributes["NORMAL"])]
    corners = [f"{i + 1}/{i + 1}/{i + 1}" for (i,) in model.numbers(primitive["indices"])]
    lines += ["f " + " ".join(corners[i:i + 3]) for i in range(0, len(corners), 3)]
    path.write_text("\n".join(lines) + "\n")


def row(values):
    return ", ".join(map(str, values))


def fabric(material, picture):
    """The nearest of the model's fabric: its sheen's colour goes to the base, by which Mitsuba tints."""
    sheen = material["extensions"]["KHR_materials_sheen"]["sheenColorFactor"]
    texture = material["normalTexture"]["extensions"]["KHR_texture_transform"]
    base = [0.04 * part / max(sheen) for part in sheen]
    inner = principled(row(base), roughness=material["pbrMetallicRoughness"]["roughnessFactor"], sheen=1, sheen_tint=1)
    return (f'<bsdf type="normalmap"><texture type="bitmap" name="normalmap"><boolean name="raw" value="true"/>'
            f'<string name="filename" value="{picture}"/><transform name="to_uv"><scale value="{texture["scale"][0]}"/></transform></texture>{inner}</bsdf>')


def direction_of(rotation):
    """Returns -z turned by a quaternion."""
    x, y, z, w = rotation
    return [-2 * (x * z + w * y), -2 * (y * z - w * x), 2 * (x * x + y * y) - 1]


def write(source, path):
    model, shapes = Model(source), []
    folder, picture = path.parent, f"{path.stem}-normals.png"
    (folder / picture).write_bytes(model.image(1))
    for mesh in model.json["meshes"]:
        primitive = mesh["primitives"][0]
        material = model.json["materials"][primitive["material"]]
        numbers = material["pbrMetallicRoughness"]
        obj = folder / f"{path.stem}-{mesh['name']}.obj"
        write_obj(model, primitive, obj)
        bsdf = (fabric(material, picture) if "extensions" in material else
                principled(row(numbers["baseColorFactor"][:3]), roughness=numbers["roughnessFactor"], metallic=numbers.get("metallicFactor", 1)))
        shapes.append(f'<shape type="obj"><string name="filename" value="{obj.name}"/>{two_sided(bsdf)}</shape>')
    light = next(node for node in model.json["nodes"] if "extensions" in node)
    intensity = model.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"]
    path.write_text(f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="9"/></integrator>
<sensor type="perspective"><float name="fov" value="{FOV}"/><string name="fov_axis" value="y"/>
<transform name="to_world"><lookat origin="{row(EYE)}" target="{row(TARGET)}" up="0, 1, 0"/></transform>
<sampler type="independent"/><film type="hdrfilm"/></sensor>
<emitter type="constant"><rgb name="radiance" value="{row([SKY] * 3)}"/></emitter>
<emitter type="directional"><vector name="direction" value="{row(direction_of(light['rotation']))}"/><rgb name="irradiance" value="{row([intensity] * 3)}"/></emitter>
{chr(10).join(shapes)}
</scene>
""")


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    write(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
