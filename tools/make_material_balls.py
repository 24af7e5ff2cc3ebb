#!/usr/bin/env python3
"""Writes a room with 40 balls, each of its own material, as a Mitsuba 3 scene that both renderers read, for measuring:
make_material_balls.py OUT.xml

The ball is a mesh, an OBJ beside the scene, so that materials are compared and not shapes.
Rows from the front: metals, dielectrics, plastics, principled opaque ones, principled ones with coats, sheen, anisotropy and glass.
"""

import math
import pathlib
import sys

COLUMNS, SPACE, RADIUS, RINGS = 8, 1.0, 0.4, 32
BALL = "material-ball.obj"
METALS = {"gold": ("0.14, 0.37, 1.44", "3.98, 2.39, 1.6"), "copper": ("0.2, 0.92, 1.1", "3.91, 2.45, 2.14"),
          "aluminium": ("1.66, 0.88, 0.52", "9.22, 6.27, 4.84"), "silver": ("0.16, 0.14, 0.13", "4.03, 3.21, 2.34")}
COLORS = ["0.7, 0.12, 0.1", "0.75, 0.4, 0.08", "0.7, 0.65, 0.1", "0.15, 0.55, 0.12", "0.1, 0.5, 0.5", "0.1, 0.2, 0.65", "0.4, 0.12, 0.55",
          "0.7, 0.7, 0.7"]


def element(tag, name, value):
    return f'<{tag} name="{name}" value="{value}"/>'


def bsdf(kind, *members):
    return f'<bsdf type="{kind}">{"".join(members)}</bsdf>'


def two_sided(inner):
    return f'<bsdf type="twosided">{inner}</bsdf>'


def number(name, value):
    return element("float", name, value)


def color(name, value):
    return element("rgb", name, value)


def metal(name, alpha):
    eta, k = METALS[name]
    indices = [color("eta", eta), color("k", k)]
    if alpha == 0:
        return two_sided(bsdf("conductor", *indices))
    return two_sided(bsdf("roughconductor", element("string", "distribution", "ggx"), number("alpha", alpha), *indices))


def principled(base, **numbers):
    return bsdf("principled", color("base_color", base), *(number(name, value) for name, value in numbers.items()))


def materials():
    """The rows, each of 8."""
    names = list(METALS)
    metals = [metal(names[i % 4], [0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0][i]) for i in range(8)]
    dielectrics = [bsdf("dielectric", number("int_ior", 1.33)), bsdf("dielectric", number("int_ior", 1.5)),
                   bsdf("dielectric", number("int_ior", 2.4)), bsdf("thindielectric", number("int_ior", 1.5))]
    dielectrics += [bsdf("roughdielectric", element("string", "distribution", "ggx"), number("alpha", alpha), number("int_ior", 1.5))
                    for alpha in (0.05, 0.15, 0.3, 0.5)]
    ggx = element("string", "distribution", "ggx")
    plastics = [bsdf("diffuse", color("reflectance", COLORS[0])), bsdf("plastic", color("diffuse_reflectance", COLORS[1]))]
    plastics += [bsdf("roughplastic", ggx, number("alpha", alpha), color("diffuse_reflectance", base))
                 for alpha, base in zip((0.05, 0.1, 0.2, 0.3, 0.4, 0.5), COLORS[2:])]
    opaque = [two_sided(principled(base, roughness=0.1 + 0.1 * i, metallic=(i % 4) / 3, specular=0.5)) for i, base in enumerate(COLORS)]
    layered = [two_sided(principled(COLORS[i], roughness=0.5, clearcoat=1.0, clearcoat_gloss=0.2 + 0.3 * i)) for i in range(3)]
    layered += [two_sided(principled(COLORS[3], roughness=0.8, sheen=1.0)),
                two_sided(principled(COLORS[4], roughness=0.6, sheen=0.5)),
                two_sided(principled(COLORS[5], roughness=0.4, metallic=1.0, anisotropic=0.8)),
                principled(COLORS[7], roughness=0.2, spec_trans=1.0, eta=1.5), principled(COLORS[4], roughness=0.3, spec_trans=0.6, eta=1.4)]
    return [metals, dielectrics, [two_sided(plastic) for plastic in plastics], opaque, layered]


def ball():
    """A unit ball as an OBJ, with normals."""
    corners = [(0, 1, 0), (0, -1, 0)]
    for i in range(1, RINGS):
        for k in range(2 * RINGS):
            up, around = math.pi * i / RINGS, math.pi * k / RINGS
            corners.append((math.sin(up) * math.cos(around), math.cos(up), math.sin(up) * math.sin(around)))
    faces, at = [], lambda i, k: 3 + (i - 1) * 2 * RINGS + k % (2 * RINGS)
    for k in range(2 * RINGS):
        faces += [(1, at(1, k + 1), at(1, k)), (2, at(RINGS - 1, k), at(RINGS - 1, k + 1))]
        for i in range(1, RINGS - 1):
            faces += [(at(i, k), at(i, k + 1), at(i + 1, k)), (at(i, k + 1), at(i + 1, k + 1), at(i + 1, k))]
    lines = [f"{word} {x:.7g} {y:.7g} {z:.7g}" for word in ("v", "vn") for x, y, z in corners]
    lines += ["f " + " ".join(f"{corner}//{corner}" for corner in face) for face in faces]
    return "\n".join([*lines, ""])


def write(path):
    path.write_text(scene(), encoding="utf-8")
    path.with_name(BALL).write_text(ball(), encoding="utf-8")


def sheet(transform, *members):
    return f'<shape type="rectangle"><transform name="to_world">{transform}</transform>{"".join(members)}</shape>'


def scene():
    rows = materials()
    half = COLUMNS * SPACE / 2 + 0.5
    grey = two_sided(bsdf("diffuse", color("reflectance", "0.6, 0.6, 0.6")))
    scale, turn = (lambda x, y: f'<scale x="{x}" y="{y}"/>'), (lambda axis, angle: f'<rotate {axis}="1" angle="{angle}"/>')
    move = lambda x, y, z: f'<translate x="{x}" y="{y}" z="{z}"/>'  # noqa: E731
    shapes = [sheet(scale(half, 6) + turn("x", -90) + move(0, 0, 2), grey), sheet(scale(half, 4) + turn("x", 90) + move(0, 5, 0), grey),
              sheet(scale(half, 2.5) + move(0, 2.5, -4), grey)]
    for side, wall in ((-1, "0.6, 0.25, 0.2"), (1, "0.2, 0.35, 0.6")):
        shapes.append(sheet(scale(4, 2.5) + turn("y", -90 * side) + move(side * half, 2.5, 0), two_sided(bsdf("diffuse", color("reflectance", wall)))))
    for x in (-2.5, 0, 2.5):
        shapes.append(sheet(scale(0.7, 0.5) + turn("x", 90) + move(x, 4.99, 0.3),
                            f'<emitter type="area">{color("radiance", "14, 13, 12")}</emitter>', bsdf("diffuse", color("reflectance", "0, 0, 0"))))
    for i, row in enumerate(rows):
        for k, material in enumerate(row):
            x, y, z = (k - (COLUMNS - 1) / 2) * SPACE, RADIUS + 0.45 * i, 2.2 - SPACE * i
            place = f'<transform name="to_world"><scale value="{RADIUS}"/>{move(f"{x:g}", f"{y:g}", f"{z:g}")}</transform>'
            shapes.append(f'<shape type="obj">{element("string", "filename", BALL)}{place}{material}</shape>')
    camera = ('<sensor type="perspective"><float name="fov" value="27"/><string name="fov_axis" value="y"/><transform name="to_world">'
              '<lookat origin="0, 3.4, 11.5" target="0, 1.3, 0" up="0, 1, 0"/></transform><sampler type="independent"/>'
              '<film type="hdrfilm"/></sensor>')
    lines = ['<scene version="3.0.0">', '<integrator type="path"/>', camera, *shapes, "</scene>", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    write(pathlib.Path(sys.argv[1]))
