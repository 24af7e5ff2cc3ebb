#!/usr/bin/env python3
"""Renders every model of a folder with no flag but its size and its samples, and puts the pictures on one sheet.

    tools/make_first_views.py build/bin/pertev ../shared/scenes/gltf docs/pictures/first_views.jpg

A model is a .gltf or .glb file; of a folder that holds several, the first by name. The sheet shows what a person sees who
opens a file: the view, the light, the ground and the exposure that are made up where the file has none. What cannot be
rendered is left out, and the status is then 1. Needs Pillow.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

from late_import import LateImport

Image, ImageDraw = LateImport("PIL.Image"), LateImport("PIL.ImageDraw")

KINDS = {'.gltf', '.glb', '.obj', '.ply'}


def models(folder):
    """Returns one file of each folder below `folder`, in the order of the folders' names."""
    found = {}
    for path in sorted(folder.rglob('*')):
        if path.suffix.lower() in KINDS:
            found.setdefault(path.parent, path)
    return list(found.values())


def render(pertev, path, size, samples, more):
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / 'view.png'
        command = [pertev, 'render', str(path), '-o', str(out), '--size', '%dx%d' % size, '--spp', str(samples), '-q',
                   *more]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            print('%s: %s' % (path, done.stderr.strip()), file=sys.stderr)
            return None
        return Image.open(out).convert('RGB')


def write_sheet(target, views, columns, quality):
    """Pictures of one size with their names below them, side by side."""
    width, height = views[0][1].size
    label = 14
    sheet = Image.new('RGB', (columns * width, -(-len(views) // columns) * (height + label)), 'white')
    draw = ImageDraw.Draw(sheet)
    for number, (name, view) in enumerate(views):
        x, y = number % columns * width, number // columns * (height + label)
        sheet.paste(view, (x, y))
        draw.text((x + 3, y + height + 1), name[:32], fill='black')
    sheet.save(target, quality=quality, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('pertev')
    parser.add_argument('scenes', nargs='+', help='folders, or single files')
    parser.add_argument('sheet', help='the picture to write')
    parser.add_argument('--size', default='200x150', help='of each view, WIDTHxHEIGHT')
    parser.add_argument('--spp', type=int, default=64)
    args = parser.parse_args()

    width, height = (int(part) for part in args.size.split('x'))
    paths = []
    for scene in map(pathlib.Path, args.scenes):
        paths += models(scene) if scene.is_dir() else [scene]
    views = [(path.stem, render(args.pertev, path, (width, height), args.spp, [])) for path in paths]
    failed = sum(view is None for _, view in views)
    views = [(name, view) for name, view in views if view is not None]
    if views:
        write_sheet(args.sheet, views, 8, 80)
    print('%s: %d views, %d failed' % (args.sheet, len(views), failed))
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
