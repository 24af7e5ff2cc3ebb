"""Scenes that stay open, and their parameters."""

import collections.abc
import os

from . import _core
from ._process import check_process
from ._settings import OF_FRAMES, file_name, nearest, of_layers, suggested, text_of, texts_of, with_layers
from .errors import InputError, input_error


def _is_path(path):
    return isinstance(path, str) and path.encode(errors="ignore").decode() == path


class Params(collections.abc.Mapping):
    """Values of a scene by paths such as "materials/gold/roughness"; what is set holds for all pictures from then on.

    Paths are materials/NAME/..., instances/NAME/transform, lights/NAME/... and cameras/NAME/..., with an object's number
    in place of a name that it lacks or shares, environment/scale (a factor for each channel) and environment/rotation
    (degrees). Transforms are 4x4, world from local, in the coordinates of the file.
    """

    def __init__(self, scene):
        check_process()
        self._scene = scene

    def __getitem__(self, path):
        value = self._scene._value(path) if _is_path(path) else None
        if value is None:
            raise self._unknown(path)
        return value

    def __setitem__(self, path, value):
        if not (_is_path(path) and self._scene._set_value(path, value)):
            raise self._unknown(path)

    def __iter__(self):
        return iter(self._scene._paths())

    def __len__(self):
        return len(self._scene._paths())

    def __repr__(self):
        return f"<pertev.Params of {self._scene.name}, {len(self)} values>"

    def _unknown(self, path):
        parts, known = str(path).split("/"), [known.split("/") for known in self]
        for at, part in enumerate(parts):
            others = {other[at]: "/".join(other) for other in known if other[:at] + [part] + other[at + 1:] == parts}
            if near := nearest(part, others):
                return KeyError(f"there is no '{path}'; did you mean '{others[near]}'?")
        return KeyError(f"there is no '{path}'")


class Scene(_core.Scene):
    """A scene that stays open: of a file, which load() opens, or of arrays.

        Scene(meshes={"floor": {"vertices": (N, 3), "faces": (M, 3), "normals": (N, 3), "uv": (N, 2), "colors": (N, 4)}},
              materials={"gold": {"base_color": (1, 0.8, 0.3), "metallic": 1, "roughness": 0.2}},
              instances={"a": {"mesh": "floor", "material": "gold", "transform": (4, 4)}},
              lights={"lamp": {"kind": "point", "position": (0, 2, 0), "intensity": (9, 9, 9)}},
              environment=(1, 1, 1), cameras={"front": {"eye": (0, 1, 3), "target": (0, 0, 0), "fov": 45}})

    Arrays are of NumPy or of anything with DLPack or the buffer protocol, also on a GPU, and are copied. `colors` are
    from 0 to 1, or uint8. Only meshes and instances must be given. `values` are settings for all pictures that do not overrule them. Raises
    InputError, whose `setting` is the path of a wrong argument, such as "meshes/floor/faces".

    materials    kind "metallic_roughness" (default), "diffuse", "conductor", "dielectric" or "unlit", or a measured metal
                 such as metal="gold"; numbers and
                 colours as scene.params has them; textures of (height, width), or with 1, 3 or 4 channels, uint8 or float:
                 base_color_texture, emission_texture, specular_color_texture, coat_color_texture, fuzz_color_texture,
                 diffuse_transmission_color_texture (uint8: sRGB),
                 metallic_texture, roughness_texture, normal_texture, alpha_texture, transmission_texture,
                 specular_texture, coat_texture, coat_roughness_texture, coat_normal_texture, fuzz_roughness_texture,
                 anisotropy_texture, coat_anisotropy_texture, thin_film_texture, thin_film_thickness_texture, diffuse_transmission_texture;
                 alpha_mode, metal_fresnel, microfacet_distribution, energy, fuzz_model; double_sided, two_sided_emission, thin_walled,
                 has_relative_ior
    lights       kind "point", "spot" or "directional"; intensity, position, direction or transform, range; inner_cone and
                 outer_cone in degrees
    environment  a colour, an array of (height, width, 3) as environment maps have it, or a file
    cameras      eye and target (and up), or transform; fov in degrees; projection "perspective" or "orthographic" with
                 view_height; aperture, aperture_blades, aperture_rotation, aperture_ratio, focus, aspect
    """

    def __init__(self, source=None, *, meshes=None, materials=None, instances=None, lights=None, environment=None,
                 cameras=None, name="arrays", **values):
        check_process()
        parts = {"meshes": meshes, "materials": materials, "instances": instances, "lights": lights, "cameras": cameras}
        if source is not None and any(part is not None for part in parts.values()):
            raise TypeError("a scene is of a file or of arrays")
        is_setting = source is not None or isinstance(environment, (str, os.PathLike))
        if is_setting:
            values["environment"] = environment
        parts["environment"] = None if is_setting else environment
        if source is None and (meshes is None or instances is None):
            raise TypeError("a scene of arrays needs meshes and instances")
        super().__init__(text_of(name, "name") if source is None else file_name(source, "source"), texts_of(values),
                         parts if source is None else None)
        self._is_of_arrays = source is None

    @property
    def params(self):
        """Values by paths such as "materials/gold/roughness" (Params)"""
        return Params(self)

    def save(self, path):
        """Writes the scene as glTF (.glb), with what the settings of load() and changed parameters made of it.

        What glTF lacks, such as an environment, media, lenses of cameras and a generated ground, is left out with a
        warning. Raises WriteError, and as render().
        """
        path = file_name(path, "path")
        if not path.lower().endswith(".glb"):
            raise input_error("path", "a scene is written as glTF, whose name ends in .glb", path)
        self._save(path, "")

    def __reduce__(self):
        if self._is_of_arrays:
            raise TypeError("a scene of arrays is not pickled; make it of its arrays in each process")
        return _reopened, (self.name, self._settings, self._edits())


def scene_of(scene):
    """Returns a Scene for what render() takes as one."""
    if isinstance(scene, Scene):
        getattr(scene, "name")  # An _Unopened scene raises its error here.
        return scene
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene: expected what pertev.load() returns, a file, or the name of a built-in scene, not {type(scene).__name__}")
    return Scene(scene)


class _Unopened(Scene):
    """A pickled scene that could not be opened. Its first use raises the error of that, since unpickling must not: the worker of a
    multiprocessing.Pool whose argument raises ends without an answer, and the pool waits without end."""

    def __getattribute__(self, name):
        raise object.__getattribute__(self, "_error").with_traceback(None)

    def __repr__(self):
        return self.name


def _reopened(name, settings, edits):
    try:
        scene = load(name, **settings)
        for path, value in edits.items():
            scene.params[path] = value
    except Exception as error:
        scene = _Unopened.__new__(_Unopened)
        scene._error = error
    return scene


def load(scene, **values):
    """Opens a scene, builds its trees, and returns it as a Scene, of which render() makes pictures.

    scene   a file (.gltf, .glb, .obj, .ply, .stl, .pbrt, .xml) or the name of a built-in scene (builtin_scenes())
    values  settings, as render() has them, for all pictures that do not overrule them

    A picture with another camera, size or integrator, with other samples, or at another time, takes the scene as it is;
    other settings, such as `device` or `environment`, open it again. Raises as render().
    """
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene: expected a file or the name of a built-in scene, not {type(scene).__name__}")
    opened = Scene(scene, **values)
    opened._open()
    return opened


def scene(name, **values):
    """Opens a built-in scene by its name (builtin_scenes()), whatever files there are, and returns it as load() does.

    Raises InputError for an unknown name, and what load() raises.
    """
    if name not in _core.builtin_scenes():
        raise InputError(f"there is no built-in scene '{name}'{suggested(name, _core.builtin_scenes())}")
    return load(name, **values)


class Session(_core.Session):
    """Frames of a scene, one after the other: each has one sample per pixel, reconstructed with earlier ones.

        for frame in pertev.Session(scene, fps=24, size=(640, 360), frames="0-99"):
            frame.color

    scene   what load() returns, or as its `scene`. The session opens it for itself, with its changes (Scene.params)
    layers  names of layers to render as well, as of render()
    values  settings as render() has them, and those that only frames have. real_time=False gives ordinary pictures;
            without `frames` there is no last one

    Frames are Results with the bytes of `pertev render --frames` with the same settings. Raises as render().
    """

    def __init__(self, scene, *, layers=(), **values):
        check_process()
        scene = scene_of(scene)
        given = with_layers({"real_time": True, "frames": None if values.get("turntable") else "0-1000000000", **values},
                            layers)
        with of_layers(values):
            super().__init__(scene, texts_of(given, OF_FRAMES))

    def __iter__(self):
        return self

    def __next__(self):
        check_process()
        frame = self._next()
        if frame is None:
            raise StopIteration
        return frame

    def set(self, **values):
        """Changes settings of the frames to come. None is as if the setting was not given. Raises as render() for a wrong
        value, and then changes nothing; before the first frame, what the scene lacks is only found by that.

        Settings of the camera keep the history of earlier frames. Those that change the scene, its trees or the device
        open the scene again, without a history."""
        texts = texts_of(values, OF_FRAMES)
        self._set({name: texts.get(name, []) for name in values})
