"""Renders a picture in parts by Ray, on this machine or on a cluster, with the bytes of one render.

    python examples/ray_farm.py cornell-box picture.exr --parts 8 --spp 1024
    python examples/ray_farm.py scene.glb picture.exr --address auto --parts 64 --spp 65536 --cpus 16
    python examples/ray_farm.py scene.glb picture.exr --address auto --parts 64 --spp 65536 --gpus 1

Each machine has pertev and the scene under the same name. A part whose machine is lost is rendered again.
"""

import argparse
import os

import pertev.farm
import ray

from poses import size_of


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("output", nargs="+")
    parser.add_argument("--address", help="of a cluster; without it Ray is started on this machine")
    parser.add_argument("--parts", type=int, default=8)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--size", type=size_of, default=(1280, 720))
    parser.add_argument("--cpus", type=int, default=1, help="threads of a part")
    parser.add_argument("--gpus", type=int, default=0, help="GPUs of a part, of which it uses the first")
    arguments = parser.parse_args()
    ray.init(address=arguments.address, include_dashboard=False, log_to_driver=False)
    scene = os.path.abspath(arguments.scene) if os.path.exists(arguments.scene) else arguments.scene
    picture = pertev.farm.ray(scene, parts=arguments.parts, output=arguments.output, options={"num_cpus": arguments.cpus, "num_gpus": arguments.gpus},
                              spp=arguments.spp, size=arguments.size, threads=arguments.cpus, device="cuda" if arguments.gpus else "cpu")
    print(f"{picture.samples} spp, {picture.hash}")


if __name__ == "__main__":
    main()
