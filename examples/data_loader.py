"""Feeds a network with rendered pictures: a torch data loader whose items are batches of cameras, rendered in one call.

    python examples/data_loader.py cornell-box --batches 20 --batch 16

On a CPU, worker processes render while the network learns. They are started by "spawn", because threads of the renderer do
not live on in a fork, and get the scene by pickling. On a GPU this process renders, and tensors share its arrays by DLPack.
The network learns depth from colour.
"""

import argparse
import sys

import numpy
import pertev

from poses import around, size_of

try:
    import torch
except ImportError:
    sys.exit("torch is missing (pip install torch); nothing was done")


class Views(torch.utils.data.Dataset):
    """Batches of views of a scene: colour (N, 3, H, W) and depth (N, H, W). Number k is the same in every process."""

    def __init__(self, scene, batches, batch, size, spp, **settings):
        self.scene, self.batches, self.batch = scene, batches, batch
        self.settings = {"size": size, "spp": spp, **settings}
        first = pertev.render(scene, **{**self.settings, "spp": 1})
        self.pose, self.K, self.bounds = first.pose, first.K, scene.bounds

    def __len__(self):
        return self.batches

    def __getitem__(self, number):
        amount = 0.1 * numpy.ptp(self.bounds, axis=0).max()
        poses = around(self.pose, self.bounds.mean(axis=0), self.batch, amount, seed=number)
        views = pertev.render(self.scene, cameras=pertev.Cameras(poses, self.K), seeds=number, layers="depth",
                              layers_at="centre", **self.settings)
        color, depth = torch.from_dlpack(views.color), torch.from_dlpack(views.depth)
        return color.permute(0, 3, 1, 2), depth


def loader_of(views, workers):
    """Returns a loader of whole batches; 0 workers: this process renders."""
    return torch.utils.data.DataLoader(views, batch_size=None, num_workers=workers,
                                       multiprocessing_context="spawn" if workers > 0 else None)


def learn(loader, device):
    """Trains a small network and yields the error of each batch, metres squared."""
    torch.manual_seed(1)
    network = torch.nn.Sequential(torch.nn.Conv2d(3, 16, 5, padding=2), torch.nn.ReLU(), torch.nn.Conv2d(16, 1, 5, padding=2))
    network.to(device)
    optimizer = torch.optim.Adam(network.parameters(), lr=1e-2)
    for color, depth in loader:
        error = torch.nn.functional.mse_loss(network(color.clamp(max=4))[:, 0], depth)
        optimizer.zero_grad()
        error.backward()
        optimizer.step()
        yield error.item()


def main():
    parser = argparse.ArgumentParser(description="Feeds a torch network with rendered pictures.")
    parser.add_argument("scene", help="a file, or the name of a built-in scene")
    parser.add_argument("--batches", type=int, default=20)
    parser.add_argument("--batch", type=int, default=16, help="cameras of a batch")
    parser.add_argument("--size", type=size_of, default=(64, 64), metavar="WIDTHxHEIGHT")
    parser.add_argument("--spp", type=int, default=16, help="samples per pixel")
    parser.add_argument("--workers", type=int, default=2, help="processes on a CPU")
    given = parser.parse_args()
    on_gpu = torch.cuda.is_available()
    settings = {"device": "cuda"} if on_gpu else {"device": "cpu", "threads": 1 if given.workers > 0 else 0}
    scene = pertev.load(given.scene, device=settings["device"])
    views = Views(scene, given.batches, given.batch, given.size, given.spp, **settings)
    errors = list(learn(loader_of(views, 0 if on_gpu else given.workers), settings["device"]))
    print(f"error of depth, m2: {errors[0]:.4f} in the first batch, {errors[-1]:.4f} in the last of {len(errors)}")


if __name__ == "__main__":
    main()
