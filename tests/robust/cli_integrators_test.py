#!/usr/bin/env python3
"""What holds of every integrator's pictures, and what belongs to one of them alone."""

import base64
import json
import struct

from cli_run import CliTest, main, write


def lit_triangle():
    """A glTF file of a triangle and a point light before it."""
    corners = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
    light = {"KHR_lights_punctual": {"light": 0}}
    return json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_punctual"], "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}},
        "nodes": [{"mesh": 0}, {"extensions": light, "translation": [0.2, 0.3, 0.5]}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + corners}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})


class Integrators(CliTest):
    def test_a_render_that_a_time_limit_ended_has_the_hash_of_one_of_as_many_samples(self):
        for integrator in ["hybrid", "raster", "reyes", "light", "bidirectional"]:
            flags = ["--integrator", integrator, *(["--ambient", "0.5"] if integrator in ["raster", "reyes"] else [])]
            done = self.render(*flags, "--time-limit", "0.5", size="24x24", spp=8388607)
            self.assertEqual(self.render(*flags, size="24x24", spp=done["samples"])["hash"], done["hash"], integrator)

    def test_where_light_is_evaluated_changes_the_hash(self):
        write(self.path("lit.gltf"), lit_triangle())
        view = ["--eye", "0.3,0.3,2", "--target", "0.3,0.3,0", "--ambient", "0"]
        hashes = [self.render(*view, "--integrator", *flags, scene="lit.gltf")["hash"]
                  for flags in [["raster"], ["raster", "--shading", "flat"], ["raster", "--shading", "gouraud"], ["reyes"],
                                ["reyes", "--shading-rate", "3"]]]
        self.assertEqual(len(set(hashes)), len(hashes))


if __name__ == "__main__":
    main()
