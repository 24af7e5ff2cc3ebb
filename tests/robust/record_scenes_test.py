#!/usr/bin/env python3
"""The generated scenes of the ray record: they have the same bytes everywhere, and the program reads all triangles."""

import hashlib
import importlib.util
import os
import pathlib
import sys
import unittest

from cli_run import CliTest, main

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
SCENES = pathlib.Path(os.environ.get("PERTEV_SCENES", "/nowhere"))


def digest(positions, triangles):
    return hashlib.sha256(positions.astype("<f4").tobytes() + triangles.astype("<u4").tobytes()).hexdigest()[:16]


@unittest.skipUnless(importlib.util.find_spec("numpy"), "numpy is not here")
class Made(CliTest):
    def rays_in(self, name, mesh):
        """Returns the ray sets that the program traces in a scene of the record with that mesh."""
        import make_record_scenes
        make_record_scenes.write_ply(pathlib.Path(self.path(f"record/{name}.ply")), *mesh)
        environment = {**self.environment, "PERTEV_SCENES": self.path(".")}
        done = self.succeed("bench", "rays", "--scene", name, "--count", "2000", "--runs", "1", "--check", "--device", "cpu", "--json", env=environment)
        return {rays["set"]: rays for rays in done.events("rays")}

    def test_a_small_forest_has_the_recorded_digest_and_hit_share(self):
        from make_record_scenes import make_forest
        mesh = make_forest(40, 30, 200)
        self.assertEqual(len(mesh[1]), 2 * 40 * 40 + 30 * (36 + 2 * 200))
        self.assertEqual(digest(*mesh), "051fae3574e27bde")
        self.assertAlmostEqual(self.rays_in("forest", mesh)["primary"]["hit_share"], 0.492, delta=0.001)

    @unittest.skipUnless((SCENES / "stanford/bunny.obj").exists(), "PERTEV_SCENES has no stanford/bunny.obj (docs/scenes.md)")
    def test_the_bunny_has_the_recorded_digest_and_hit_share(self):
        from make_record_scenes import make_bunny
        mesh = make_bunny(SCENES / "stanford/bunny.obj")
        self.assertEqual(digest(*mesh), "0e067601ebd6621b")
        self.assertAlmostEqual(self.rays_in("bunny", mesh)["shadow"]["hit_share"], 0.35, delta=0.03)


if __name__ == "__main__":
    main()
