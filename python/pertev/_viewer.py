"""The viewer of the program, as a process."""

import json
import os
import subprocess
import sys
import tempfile
import threading
import webbrowser

from . import _core
from ._settings import OF_PICTURES, texts_of
from .errors import Error


_OF_VIEWS = {name: row for name, row in OF_PICTURES.items() if row["is_viewed"]}
# Settings whose effects a saved scene has.
_SAVED = {"animation", "define", "environment", "environment_rotation", "environment_scale", "file_scene", "ground", "ies", "lamp",
          "material", "sun_sky", "two_sided_lights", "unit", "up_axis", "variant"}


def _program():
    """Returns the words that start the program: that of $PERTEV_PROGRAM, or the one of this package."""
    given = os.environ.get("PERTEV_PROGRAM")
    return [given] if given else [sys.executable, "-m", "pertev_program"]


class Viewer:
    """A running viewer: `url` is its address. Leaving a `with` block or close() ends it. Notebooks show it as a frame,
    if they run in a browser on the machine of the viewer or its port is forwarded."""

    _reader = None

    def __init__(self, scene, port, values, folder=None):
        self._folder = folder  # the folder of a saved scene, which ends with the viewer
        flags = ["--port", str(port), "--no-browser", "--embed"]
        for name, texts in texts_of(values, _OF_VIEWS).items():
            flag = "--" + name.replace("_", "-")
            is_switch = _OF_VIEWS[name]["type"] == "bool"
            flags += ([flag] if texts == ["true"] else []) if is_switch else [x for text in texts for x in (flag, text)]
        self._process = subprocess.Popen([*_program(), "view", scene, *flags, "--json"], stdout=subprocess.PIPE,
                                         stderr=subprocess.DEVNULL, text=True)
        try:
            self.url = self._address()
        except BaseException:
            self.close()
            raise
        self._reader = threading.Thread(target=self._process.stdout.read, daemon=True) # so that it never waits for one
        self._reader.start()

    def _address(self):
        why = "it ended"
        for line in self._process.stdout:
            event = json.loads(line)
            if event.get("event") == "listening":
                return event["address"]
            why = event.get("text", event.get("reason", why)) if event.get("event") == "error" else why
        raise Error(f"the viewer did not start: {why}")

    def close(self):
        """Ends the viewer."""
        self._process.terminate()
        self._process.wait()
        if self._reader is not None:
            self._reader.join()
        self._process.stdout.close()
        if self._folder is not None:
            self._folder.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        return f"<pertev.Viewer {self.url}>"

    def _repr_html_(self):
        return f'<iframe src="{self.url}" width="100%" height="600" style="border:0"></iframe>'


def view(scene, *, port=0, browser=False, **values):
    """Starts the viewer of a scene (a file, the name of a built-in scene, or what load() returns) as a process of its own,
    and returns it as a Viewer.

    port     that it listens on; 0 is any free one
    browser  True: opens the address in the browser of this desktop
    values   settings of `pertev view`; they overrule those of load()

    The viewer shows a scene of arrays, or with changed parameters, as save() writes it, with its environment. Raises Error
    if the viewer does not start.
    """
    folder = None
    try:
        if isinstance(scene, _core.Scene):
            of_scene = {name: texts for name, texts in scene._settings.items() if name in _OF_VIEWS}
            shown = scene.name
            if scene._is_of_arrays or scene._edits():
                folder = tempfile.TemporaryDirectory(prefix="pertev-")
                shown = os.path.join(folder.name, "scene.glb")
                of_saved = scene._save(shown, os.path.join(folder.name, "environment.exr"))
                if not {"environment", "sun_sky"}.isdisjoint(values):
                    of_saved = {name: text for name, text in of_saved.items() if not name.startswith("environment")}
                of_scene = {**of_saved, **{name: texts for name, texts in of_scene.items() if name not in _SAVED}}
            scene, values = shown, {**of_scene, **values}
        viewer = Viewer(os.fspath(scene), port, values, folder)
    except BaseException:
        if folder is not None:
            folder.cleanup()
        raise
    if browser:
        webbrowser.open(viewer.url)
    return viewer
