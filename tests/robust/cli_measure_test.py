#!/usr/bin/env python3
"""Light at a point, in the units of the file."""

import json
import math

from cli_run import FLOOR, CliTest, gltf_with_cameras, main, write


class Light(CliTest):
    def measure(self, scene, *arguments):
        outcome = self.succeed("measure", scene, "--normal", "0,3,0", "--device", "cpu", "--spp", "1", "--json", *arguments)
        return outcome.events("measure")[0]

    def test_light_is_measured_in_the_units_of_the_file(self):
        gltf = json.loads(gltf_with_cameras())
        gltf["extensionsUsed"] = ["KHR_lights_punctual"]
        gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 100}]}}
        gltf["nodes"].append({"translation": [5, 2, 5], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        gltf["scenes"][0]["nodes"].append(3)
        write(self.path("lamp.gltf"), json.dumps(gltf))
        lamp = ["lamp.gltf", "--at", "5,0,5", "--max-depth", "0"]
        told = self.measure(*lamp)
        self.assertAlmostEqual(told["illuminance"]["value"], 25, delta=1e-3)  # 100 cd / (2 m)^2
        self.assertEqual(told["lumens_per_watt"], 1)
        self.assertEqual(told["paths"], 8192)
        self.assertAlmostEqual(self.measure(*lamp, "--efficacy", "683")["illuminance"]["value"], 683 * 25, delta=1)
        write(self.path("floor.obj"), FLOOR)
        told = self.measure("floor.obj", "--at", "0,0,0", "--environment", "1,2,0")
        self.assertAlmostEqual(told["irradiance_rgb"][1]["value"], 2 * math.pi, delta=1e-2)
        watts = told["irradiance"]
        self.assertAlmostEqual(watts["value"], math.pi * (0.2126 + 2 * 0.7152), delta=5 * watts["standard_error"] + 1e-4)
        self.assertAlmostEqual(told["illuminance"]["value"], 683 * watts["value"], delta=1e-3)
        words = self.succeed("measure", "floor.obj", "--at", "0,0,0", "--normal", "0,1,0", "--device", "cpu", "--spp", "1")
        self.assertRegex(words.stdout, r"irradiance +[0-9.]+ ± [0-9.e-]+ W/m2[^\n]*\nilluminance +[0-9.]+ ± [0-9.e-]+ lx")

    def test_measuring_uses_the_light_amounts_that_are_set_and_adds_no_sky(self):
        gltf = json.loads(gltf_with_cameras())
        gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 0, "name": "L"}]}}
        gltf["nodes"].append({"translation": [5, 2, 5], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        gltf["scenes"][0]["nodes"].append(3)
        write(self.path("dark.gltf"), json.dumps(gltf))
        dark = ["dark.gltf", "--at", "5,0,5", "--max-depth", "0"]
        self.assertEqual(len(self.measure(*dark)["made_up"]), 1)  # a sky
        told = self.measure(*dark, "--lamp", "L=120cd")
        self.assertEqual(told["made_up"], [])
        self.assertAlmostEqual(told["illuminance"]["value"], 30, delta=1e-3)
        gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = 9
        write(self.path("lit.gltf"), json.dumps(gltf))
        told = self.measure("lit.gltf", *dark[1:], "--lamp", "L=0cd")
        self.assertEqual((told["made_up"], told["illuminance"]["value"]), ([], 0))

    def test_an_invalid_meter_normal_is_refused_before_the_scene_is_read(self):
        for normal in ["0,0,0", "up", "nan,0,1", "1e-30,0,0"]:
            self.refuse(2, "measure", "nowhere.obj", "--at", "0,0,0", "--normal", normal, says=["--normal", normal])
        self.refuse(2, "measure", "cornell-box", "--normal", "0,1,0", says=["--at"])


if __name__ == "__main__":
    main()
