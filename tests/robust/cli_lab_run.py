"""Small scenes and command lines that the tests of `pertev lab` share.

Most scenes are closed boxes with the camera inside: every camera ray and every bounce hits, whatever the traversal. If
the box is the only object, no shadow ray hits. Times are compared only with 0.
"""

import re

from cli_run import CliTest, write

# A closed box from -1 to 1 with two triangles per side, and an eye position for it.
CORNERS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
INSIDE = ["--eye", "0.1,0.2,0.3", "--target", "0,0,-1"]

BOX = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(
    "f " + " ".join(str(corner + 1) for corner in side) + "\n" for side in SIDES)

FRAME_SETS = ["primary", "shadow", "diffuse1", "diffuse2"]
SMALL = ["--structures", "binned", "--traversals", "if-if,wide8"]


def rows_of(measurement, name):
    """Returns the rows of a table of a measurement (src/lab/measurement.h) as dictionaries."""
    (table,) = [table for table in measurement["tables"] if table["name"] == name]
    keys = [column["key"] for column in table["columns"]]
    return [dict(zip(keys, row)) for row in table["rows"]]


def lab_report(measurement):
    """Returns a report by combinations: the rows of each combination with its runs."""
    (scene,) = rows_of(measurement, "scene")
    combinations = {}
    for row in rows_of(measurement, "runs"):
        of = combinations.setdefault(row["combination"], {**row, "name": row["combination"], "runs": []})
        if row["set"]:
            of["runs"].append({**row, "different": row["different_rays"]})
    for of in combinations.values():
        seconds = {run["frame_depth"]: run["seconds_per_frame"] for run in of["runs"] if run["frame_depth"]}
        of["frame_seconds"] = [seconds.get(depth) for depth in range(scene["first_depth"], scene["last_depth"] + 1)]
    return {**scene, "event": measurement["event"], "triangles": scene["scene_triangles"], "notes": measurement["notes"],
            "interrupted": measurement["interrupted"], "sets": rows_of(measurement, "sets"),
            "structures": rows_of(measurement, "structures"), "combinations": list(combinations.values())}


class LabTest(CliTest):
    def setUp(self):
        super().setUp()
        self.environment.pop("PERTEV_SCENES", None)
        write(self.path("box.obj"), BOX)

    def lab(self, *arguments, runs=1, device="cpu", size="16x12"):
        """Returns a command line of lab with small default sizes."""
        arguments = [str(argument) for argument in arguments]
        given = [("--runs", runs), ("--device", device)]
        if "record" not in arguments:  # the size of the frame follows from --count
            given.append(("--size", size))
        return ["lab", *arguments, *(str(part) for pair in given if pair[0] not in arguments for part in pair)]

    def report(self, *arguments):
        """Returns the last JSON line of a successful run."""
        last = self.succeed(*self.lab(*arguments, "--json")).events()[-1]
        self.assertEqual((last["event"], last["format"], last["interrupted"]), ("lab", "pertev-measurement", False))
        return lab_report(last)

    def refuse_unmeasured(self, status, *arguments, says=(), **options):
        """Tests, like `refuse`, that the line is refused before any work began."""
        outcome = self.refuse(status, *self.lab(*arguments, "--json"), says=says, **options)
        self.assertEqual([event for event in outcome.events() if event["event"] in ("progress", "lab")], [], outcome)

    def names_of(self, flag):
        """Returns the values that a flag accepts, from its error message."""
        outcome = self.refuse(2, *self.lab("box.obj", flag, "nonsense"), says=[flag, "nonsense"])
        names = re.search("is not one of (.*)", outcome.stderr).group(1).split(", ")
        self.assertGreater(len(names), 3, outcome)
        return names

    def check_hits(self, report, allowed_refusals=()):
        """Tests that every combination that is not refused has figures for closest hits and correct hits."""
        self.assertGreater(len(report["combinations"]), 0)
        self.assertEqual({rest["name"] for rest in report["structures"] if rest["failed"]}, set())
        for of in report["combinations"]:
            if of["refused"]:
                self.assertTrue(any(text in of["refused"] for text in allowed_refusals), of)
                self.assertEqual(of["runs"], [])
                continue
            # Some traversals support only closest hits.
            wanted = {known["name"] for known in report["sets"]}
            self.assertLessEqual({run["set"] for run in of["runs"]}, wanted, of)
            self.assertLessEqual(wanted - {run["set"] for run in of["runs"]}, {"shadow"}, of)
            for run in of["runs"]:
                self.assertEqual(run["different"], 0, of)
                self.assertGreater(run["rays_per_second"], 0)
                self.assertGreater(run["least_seconds"], 0)
                self.assertLessEqual(run["least_seconds"], run["median_seconds"])
                self.assertLessEqual(run["median_seconds"], run["greatest_seconds"])
                self.assertGreater((run["nodes_per_ray"] or 0) + run["triangles_per_ray"], 0)
