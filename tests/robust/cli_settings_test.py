#!/usr/bin/env python3
"""Settings files, and everything generated from the table of settings: help, completion, the man page, docs/settings.md."""

import json
import os
import pathlib
import re
import subprocess

from cli_run import FLOOR, CliTest, main, read_exr, write

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SMALL = ["--size", "16x12", "--spp", "2", "--device", "cpu"]


class SettingsFiles(CliTest):
    def settings_of(self, picture, name="s.json"):
        text = self.succeed("info", picture, "--settings").stdout
        write(self.path(name), text)
        return json.loads(text)

    def test_a_picture_is_reproduced_from_the_settings_in_its_metadata(self):
        for flags in [["--aov", "normal,ids", "--seed", "7", "--max-depth", "3", "--eye", "0.1,0.3,1.2", "--fov", "50"],
                      ["--integrator", "whitted", "--ambient", "0.1,0.2,0.3", "--filter", "box"],
                      ["--integrator", "photon_map", "--photons", "200", "--transparent", "--radius", "0.05"],
                      ["--environment", "1,0.5,0.25", "--clamp", "2", "--lpe", "d=LD+E", "--sampler", "independent"]]:
            with self.subTest(flags=flags):
                self.succeed("render", "cornell-box", "-o", "a.exr", *SMALL, *flags)
                settings = self.settings_of("a.exr")
                self.assertEqual((settings["version"], settings["scene"]["name"]), (1, "cornell-box"))
                self.assertNotIn("camera", settings["settings"])
                outcome = self.succeed("render", "cornell-box", "-o", "b.exr", "--settings", "s.json", "--device", "cpu")
                self.assertNotIn("s.json", outcome.stderr)
                a, b = self.info("a.exr"), self.info("b.exr")
                self.assertEqual(a.get("pertev.by_scene"), b.get("pertev.by_scene"))
                for name in ["hash", "channels", "pertev.hash", "pertev.settings", "pertev.scene_hash", "width", "height"]:
                    self.assertEqual(a[name], b[name], name)
                self.assertEqual(read_exr(self.path("a.exr")), read_exr(self.path("b.exr")))  # every number of every layer

    def test_flags_override_a_settings_file_and_info_shows_the_origin_of_each_setting(self):
        write(self.path("s.json"), '{"version": 1, "settings": {"spp": 3, "seed": 5, "size": "8x8"}}')
        self.succeed("render", "cornell-box", "-o", "a.exr", "--settings", "s.json", "--seed", "6", "--device", "cpu")
        info = self.info("a.exr")
        self.assertEqual((info["pertev.spp"], info["pertev.seed"], info["width"]), (3, "6", 8))
        self.assertEqual(set(info["pertev.by_settings"].split()), {"spp", "size"})
        self.assertEqual(set(info["pertev.by_caller"].split()), {"seed", "device"})
        self.assertEqual(info["pertev.by_scene"], "camera")
        self.assertNotIn("pertev.by_default", info)
        origins = dict(re.findall(r"(?m)^pertev\.(seed|camera|projection) .*?(?:\((.*)\))?$", self.succeed("info", "a.exr").stdout))
        self.assertEqual(len({origins["seed"], origins["camera"], origins["projection"]}), 3, origins)
        self.assertEqual(origins["projection"], "")  # this comes from the scene's camera

    def test_info_lists_the_settings_a_scene_suggests_and_the_defaults_it_needs(self):
        write(self.path("f.obj"), FLOOR)
        for scene, suggests, makes_up in [("cornell-box", "camera size", []), ("f.obj", "", ["camera", "light"])]:
            info = self.info(scene)
            self.assertEqual((" ".join(text.split("=")[0] for text in info["suggests"]), info["makes_up"]), (suggests, makes_up), scene)
            self.succeed("render", scene, "-o", "a.exr", "--environment-rotation", "10", *SMALL)
            info = self.info("a.exr")
            self.assertEqual((info.get("pertev.by_scene", ""), "camera" in info.get("pertev.by_default", "").split()),
                             ("camera" if suggests else "", not suggests), scene)
            self.assertEqual("environment" in info.get("pertev.by_default", "").split(), info["pertev.environment"] == "made up")
        self.assertIn("environment", info["pertev.by_default"].split())

    def test_settings_files_of_every_integrator_reproduce_the_picture_and_flags_override_them(self):
        for flags in [["--integrator", "photon_map", "--photons", "100"], ["--integrator", "irradiance_cache"],
                      ["--integrator", "raster", "--ambient", "0.5", "--wireframe"], ["--aov", "depth"],
                      ["--integrator", "raster", "--ambient", "0.5", "--shading", "flat"],
                      ["--integrator", "whitted", "--ambient", "0.5"], ["--integrator", "reyes", "--ambient", "0.5"]]:
            with self.subTest(flags=flags):
                self.succeed("render", "cornell-box", "-o", "a.exr", *SMALL, *flags)
                self.settings_of("a.exr")
                self.succeed("render", "cornell-box", "-o", "b.exr", "--settings", "s.json", "--device", "cpu")
                self.assertEqual(self.info("a.exr")["hash"], self.info("b.exr")["hash"])
                self.succeed("render", "cornell-box", "-o", "c.exr", "--settings", "s.json", "--integrator", "path")
                self.succeed("render", "cornell-box", "-o", "c.png", "--settings", "s.json", "--integrator", "path")
        self.succeed("render", "cornell-box", "-o", "a.exr", *SMALL, "--time", "1")
        self.settings_of("a.exr")
        self.succeed("render", "cornell-box", "-o", "f-#.exr", "--settings", "s.json", "--frames", "0-0")

    def test_an_unknown_setting_is_ignored_with_a_warning_but_refused_with_strict(self):
        write(self.path("s.json"), '{"version": 1, "settings": {"sppp": 3}, "scene": {"name": "x", "hash": "0"}}')
        outcome = self.succeed("render", "cornell-box", "-o", "a.exr", "--settings", "s.json", *SMALL)
        self.assertIn("/settings/sppp", outcome.stderr)
        self.assertIn("a different scene", outcome.stderr)
        self.refuse(2, "render", "cornell-box", "-o", "b.exr", "--settings", "s.json", "--strict", *SMALL, says=["sppp"])

    def test_an_invalid_settings_file_is_refused(self):
        for text in ["", "[]", '{"version": 2, "settings": {}}', '{"version": 1, "settings": {"spp": "x"}}',
                     '{"version": 1, "settings": {"photons": 5}}']:
            write(self.path("s.json"), text)
            self.refuse(2, "render", "cornell-box", "-o", "a.exr", "--settings", "s.json", *SMALL, says=[])
        self.refuse(2, "render", "cornell-box", "-o", "a.exr", "--settings", "nowhere.json", *SMALL, says=["nowhere.json"])
        self.succeed("render", "cornell-box", "-o", "a.png", *SMALL)
        self.refuse(2, "info", "a.png", "--settings", says=["a.png"])
        self.refuse(2, "info", "cornell-box", "--settings", says=["cornell-box"])


class Documents(CliTest):
    def test_help_fits_a_terminal_and_groups_show_the_rest(self):
        lines = self.succeed("render", "--help").stdout.splitlines()
        self.assertLessEqual(len(lines), 50)
        self.assertLessEqual(max(map(len, lines)), 80)
        everything = self.succeed("render", "--help", "all").stdout
        shown = set(re.findall(r"(?m)^  (?:-\w,)?(--[a-z-]+)", everything))
        of_groups = set()
        for group in re.search(r"shows more: (.*), or all", " ".join(lines)).group(1).split(", "):
            of_groups |= set(re.findall(r"(?m)^  (?:-\w,)?(--[a-z-]+)", self.succeed("render", "--help", group).stdout))
        of_groups |= set(re.findall(r"(?m)^  (?:-\w,)?(--[a-z-]+)", "\n".join(lines)))
        self.assertEqual(of_groups, shown)
        self.assertGreater(len(shown), 90)
        for verb in ["view", "measure", "lab", "bench frames", "solve radiosity"]:
            self.assertLessEqual(max(map(len, self.succeed(*verb.split(), "--help", "all").stdout.splitlines())), 80, verb)

    def test_the_document_of_settings_is_up_to_date(self):
        with open(os.path.join(ROOT, "docs", "settings.md"), encoding="utf-8") as file:
            self.assertEqual(file.read(), self.succeed("--settings-document").stdout,
                             "pertev --settings-document > docs/settings.md")

    def test_every_metadata_key_is_a_setting_or_documented(self):
        keys = set()
        for folder in ["src", "apps"]:
            for path in pathlib.Path(ROOT, folder).rglob("*.cpp"):
                keys |= set(re.findall(r'"pertev\.([a-z_]+)"', path.read_text(encoding="utf-8")))
        self.assertGreater(len(keys), 20)
        settings = {name.replace("-", "_")
                    for name in re.findall(r"(?m)^\| `--([a-z-]+)` ", self.succeed("--settings-document").stdout)}
        conventions = pathlib.Path(ROOT, "docs/conventions.md").read_text(encoding="utf-8")
        table = conventions.partition("The metadata of an EXR")[2].partition("\n\n")[2].partition("\n\n")[0]
        told = {key for row in table.splitlines() for key in re.findall(r"`([a-z_]+)`", row.split("|")[1])}
        self.assertEqual(keys - settings, told - settings)

    def test_the_document_lists_every_event(self):
        events = set()
        for folder in ["src", "apps"]:
            for path in pathlib.Path(ROOT, folder).rglob("*.cpp"):
                events |= set(re.findall(r'"event":"([a-z_]+)"', path.read_text(encoding="utf-8")))
        self.assertGreater(len(events), 10)
        conventions = pathlib.Path(ROOT, "docs/conventions.md").read_text(encoding="utf-8")
        table = conventions.partition("\n| event |")[2].partition("\n\n")[0]
        told = {event for row in table.splitlines()[2:] for event in re.findall(r"`([a-z_]+)`", row.split("|")[1])}
        self.assertEqual(events - told, set())

    def test_bash_completes_verbs_flags_and_values(self):
        write(self.path("complete.bash"), self.succeed("--completion", "bash").stdout)
        for line, expected in [("pertev re", "render"), ("pertev render --max-d", "--max-depth"),
                               ("pertev render --sampler s", "sobol"), ("pertev bench rays --cou", "--count")]:
            words = line.split()
            script = (f"source complete.bash; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _pertev; "
                      'printf "%s\\n" "${COMPREPLY[@]}"')
            outcome = subprocess.run(["bash", "-c", script], cwd=self.folder, capture_output=True, text=True, check=True)
            self.assertEqual(outcome.stdout.split(), [expected], line)
        self.refuse(2, "--completion", "tcsh", says=["tcsh"])
        self.assertIn("--max-depth", self.succeed("--completion", "zsh").stdout)

    def test_fish_completes_the_flags_of_the_whole_verb(self):
        flags = {}
        for verb, flag in re.findall(r"""(?m)^complete -c pertev -n '__pertev_verb_is "([a-z ]*)"' -l ([a-z-]+)""",
                                     self.succeed("--completion", "fish").stdout):
            flags.setdefault(verb, set()).add(flag)
        for verb in ["render", "bench", "bench render"]:
            shown = self.succeed(*verb.split(), "--help", "all").stdout
            self.assertEqual(flags[verb], set(re.findall(r"(?m)^  (?:-\w,)?--([a-z-]+)", shown)), verb)
        self.assertIn("isolated", flags["bench render"] - flags["render"])
        self.assertIn("max-depth", flags["render"] - flags["bench render"])

    def test_the_man_page_names_every_flag_of_render(self):
        page = self.succeed("--man").stdout.replace("\\-", "-")
        for flag in re.findall(r"(?m)^  (?:-\w,)?(--[a-z-]+)", self.succeed("render", "--help", "all").stdout):
            self.assertIn(flag, page)


if __name__ == "__main__":
    main()
