"""Submits a picture in parts to OpenCue, and a layer that merges them: a template that has not been run.

    python examples/opencue_parts.py scene.glb /shared/folder --parts 16 --spp 4096

The scene and the folder are on a file system that all hosts have. OpenCue's frame numbers are the parts' numbers.
"""

import argparse

import outline  # OpenCue's pyoutline
import outline.cuerun
import outline.modules.shell


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("folder")
    parser.add_argument("--parts", type=int, default=16)
    parser.add_argument("--spp", type=int, default=1024)
    arguments = parser.parse_args()
    folder, number = arguments.folder, "#IFRAME#"
    job = outline.Outline("pertev_parts", shot="shot", show="testing", user="user")
    render = outline.modules.shell.Shell(
        "render", range=f"1-{arguments.parts}",
        command=["pertev", "render", arguments.scene, "-o", f"{folder}/part.{number}.pvf", "--part", f"{number}/{arguments.parts}",
                 "--spp", str(arguments.spp), "--checkpoint", f"{folder}/checkpoint.{number}.pvf", "--progress", "json"])
    merge = outline.modules.shell.Shell("merge", range="1", command=["sh", "-c", f"pertev merge {folder}/part.*.pvf -o {folder}/picture.exr"])
    merge.depend_all(render)
    job.add_layer(render)
    job.add_layer(merge)
    outline.cuerun.launch(job, use_pycuerun=False)


if __name__ == "__main__":
    main()
