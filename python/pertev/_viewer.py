"""The viewer of the program, as a process."""

import json
import os
import subprocess
import sys
import threading
import webbrowser

from . import _core
from ._settings import OF_PICTURES, texts_of
from .errors import Error


_OF_VIEWS = {name: row for name, row in OF_PICTURES.items() if row["is_viewed"]}


def _program():
    """Returns the words that start the program: that of $PERTEV_PROGRAM, or the one of this package."""
    given = os.environ.get("PERTEV_PROGRAM")
    return [given] if given else [sys.executable, "-m", "pertev_program"]


class Viewer:
    """A running viewer: `url` is its address. Leaving a `with` block or close() ends it. Notebooks show it as a frame,
    if they run in a browser on the machine of the viewer or its port is forwarded."""

    _reader = None

    def __init__(self, scene, port, values):
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

    Raises Error if the viewer does not start, and TypeError for a scene of arrays or with changed parameters, which the
    process could not read.
    """
    if isinstance(scene, _core.Scene):
        if scene._is_of_arrays or scene._edits():
            raise TypeError("the viewer reads a scene's file: it shows no scene of arrays and no changed parameters")
        of_scene = {name: texts for name, texts in scene._settings.items() if name in _OF_VIEWS}
        scene, values = scene.name, {**of_scene, **values}
    viewer = Viewer(os.fspath(scene), port, values)
    if browser:
        webbrowser.open(viewer.url)
    return viewer
