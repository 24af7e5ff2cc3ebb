"""Mutations of readers of files: meshes, materials, textures. See mutations.py."""

MUTATIONS = [
    ("bumps are dents", "unit/read_mtl", ("src/formats/obj/bump_normals.cpp", "Vec3{-along_x, -along_y, 1}", "Vec3{along_x, along_y, 1}")),
    ("heights of an MTL file rise with the rows", "unit/read_mtl",
     ("src/formats/obj/bump_normals.cpp", "(at(x, y - 1) - at(x, y + 1))", "(at(x, y + 1) - at(x, y - 1))")),
    ("a repeated height map ends at its edge", "unit/read_mtl", ("src/formats/obj/bump_normals.cpp", "wrap == Wrap::Repeat ?", "false ?")),
    ("a height map stays beside its normals", "unit/read_mtl", ("src/formats/obj/bump_normals.cpp", "    remove_unused(heights, scene);\n", "    static_cast<void>(&remove_unused);\n")),
    ("the coat of an MTL file is smooth", "unit/read_mtl", ("src/formats/obj/read_mtl.cpp", "to.coat_roughness = factor(", "to.coat_roughness = 0 * factor(")),
    ("a binary STL that begins with solid is a text", "unit/read_stl", ("src/formats/stl/parse_stl.cpp", "if (has_binary_size)", "if (has_binary_size && !text.starts_with(\"solid\"))")),
    ("an STL without its count is empty", "unit/read_stl", ("src/formats/stl/parse_stl.cpp", "stated == 0 && rest == 0 && held > 0", "false")),
    ("a torn STL says nothing", "unit/read_stl", ("src/formats/stl/parse_stl.cpp", "} else if (stated > held) {", "} else if (false) {")),
    ("solids of an STL are one", "unit/read_stl", ("src/formats/stl/read_stl.cpp", "rest = rest.subspan(3 * solid.triangles);", "static_cast<void>(rest);")),
    ("an STL's text is rounded before it is moved", "unit/read_stl", ("src/formats/stl/read_stl.cpp", "if (data.exact.empty()) {", "data.exact.clear();\n    {")),
]
