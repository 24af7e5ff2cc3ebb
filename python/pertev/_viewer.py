"""The viewer of the program, as a process."""

import json
import os
import subprocess
import sys
import tempfile
import threading
import weakref
import webbrowser

from . import _core
from ._settings import OF_FRAMES, file_name, flag_of, number_of, text_of, texts_of
from .errors import Error


OF_VIEWS = {name: row for name, row in OF_FRAMES.items() if row["is_viewed"]}
# Settings whose effects a saved scene has.
_SAVED = {"animation", "define", "environment", "environment_rotation", "environment_scale", "file_scene", "ground", "ies", "lamp",
          "material", "sun_sky", "two_sided_lights", "unit", "up_axis", "variant"}


def _program():
    """Returns the words that start the program: that of $PERTEV_PROGRAM, or the one of this package."""
    given = os.environ.get("PERTEV_PROGRAM")
    return [given] if given else [sys.executable, "-m", "pertev_program"]


def _end(process, readers, folder, owner):
    """Ends a viewer, unless this process is a child that was forked from the viewer's owner."""
    if os.getpid() != owner:
        return
    process.terminate()
    process.wait()
    for reader in readers:
        reader.join()
    process.stdout.close()
    if folder is not None:
        folder.cleanup()


class Viewer:
    """A running viewer: `url` is its address. It ends with a `with` block, by close(), when no variable holds it any more,
    and with Python. Notebooks show it as a frame, if they run in a browser on the machine of the viewer or its port is
    forwarded."""

    def __init__(self, scene, flags, folder=None):
        """`folder` is that of a saved scene, which ends with the viewer."""
        self._process = subprocess.Popen([*_program(), "view", scene, *flags, "--no-browser", "--embed", "--json"],
                                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        readers = []
        self._end = weakref.finalize(self, _end, self._process, readers, folder, os.getpid())
        try:
            self.url = self._address()
        except BaseException:
            self.close()
            raise
        readers.append(threading.Thread(target=self._process.stdout.read, daemon=True)) # so that it never waits for one
        readers[0].start()

    def _address(self):
        for line in self._process.stdout:
            event = json.loads(line)
            if event.get("event") == "listening":
                return event["address"]
            if event.get("event") == "error":
                place = event.get("place", {})
                _core.raise_parts(event["status"], event.get("setting", ""), event.get("value", ""), event.get("reason", event["text"]),
                                  place.get("file", ""), place.get("line", 0), place.get("pointer"))
        raise Error("the viewer did not start: it ended")

    def close(self):
        """Ends the viewer."""
        self._end()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        return f"<pertev.Viewer {self.url}>"

    def _repr_html_(self):
        return f'<iframe src="{self.url}" width="100%" height="600" style="border:0"></iframe>'


def _flags_of(values):
    flags = []
    for name, texts in texts_of(values, OF_VIEWS).items():
        flag = "--" + name.replace("_", "-")
        is_switch = OF_VIEWS[name]["type"] == "bool"
        flags += ([flag] if texts == ["true"] else []) if is_switch else [x for text in texts for x in (flag, text)]
    return flags


def view(scene, *, port=0, host=None, token_file=None, jpeg=None, browser=False, **values):
    """Starts the viewer of a scene (a file, the name of a built-in scene, or what load() returns) as a process of its own,
    and returns it as a Viewer.

    port     that it listens on; 0 is any free one
    host, token_file, jpeg  the flags of `pertev view`; with a token_file, `url` lacks the token
    browser  True: opens the address in the browser of this desktop
    values   settings of `pertev view`; they overrule those of load()

    The viewer shows a scene of arrays, or with changed parameters, as save() writes it, with its environment. Raises Error
    as render() if the viewer does not start.
    """
    opens_browser = flag_of(browser, "browser")
    folder, server = None, ["--port", str(number_of(port, "port", whole=True))]
    for name, value, checked in (("host", host, text_of), ("jpeg", jpeg, text_of), ("token_file", token_file, file_name)):
        server += [] if value is None else ["--" + name.replace("_", "-"), checked(value, name)]
    try:
        if isinstance(scene, _core.Scene):
            of_scene = {name: texts for name, texts in scene._settings.items() if name in OF_VIEWS}
            shown = scene.name
            if scene._is_of_arrays or scene._edits():
                folder = tempfile.TemporaryDirectory(prefix="pertev-")
                shown = os.path.join(folder.name, "scene.glb")
                of_saved = scene._save(shown, os.path.join(folder.name, "environment.exr"))
                if not {"environment", "sun_sky"}.isdisjoint(values):
                    of_saved = {name: text for name, text in of_saved.items() if not name.startswith("environment")}
                of_scene = {**of_saved, **{name: texts for name, texts in of_scene.items() if name not in _SAVED}}
            scene, values = shown, {**of_scene, **values}
        viewer = Viewer(file_name(scene, "scene"), server + _flags_of(values), folder)
    except BaseException:
        if folder is not None:
            folder.cleanup()
        raise
    if opens_browser:
        webbrowser.open(viewer.url)
    return viewer
