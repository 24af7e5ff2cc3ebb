#!/usr/bin/env python3
"""Renders every glTF sample model beside the model's own screenshot, and compares the hashes with docs/gallery.json.

    tools/make_gallery.py build/bin/pertev ../shared/scenes out [--write] [-- FLAG ...]

A model is a folder of SCENES/gltf. `out` gets a sheet of pairs for every eight models (ours on the left) and one picture per model.
Each is rendered with SETTINGS and its own flags of docs/gallery.json; further flags (--device cuda) go to every render. A hash that differs from the
file's is named, and the status is then 1; --write puts the hashes into the file. Its differences are written by hand, and docs/gallery.md is made of
them (--document, which renders nothing). Needs Pillow.
"""
import argparse
import json
import pathlib
import subprocess
import sys

from late_import import LateImport
from make_first_views import models

Image, ImageDraw = LateImport("PIL.Image"), LateImport("PIL.ImageDraw")

DATA = pathlib.Path(__file__).resolve().parent.parent / 'docs/gallery.json'
SETTINGS = '--size 320x240 --spp 64 --tone-map neutral'.split()
SIDE = (320, 240)


def render(pertev, path, target, flags):
    """Renders a model and returns the hash of its picture; None, with its message, for one that fails."""
    done = subprocess.run([pertev, 'render', str(path), '-o', str(target), '--json', *SETTINGS, *flags], capture_output=True, text=True)
    events = [json.loads(line) for line in done.stdout.splitlines()]
    found = [event['hash'] for event in events if event['event'] == 'done']
    if done.returncode != 0 or not found:
        print('%s: %s' % (path, [event for event in events if event['event'] == 'error']), file=sys.stderr)
        return None
    return found[0]


def screenshot_of(folder):
    """Returns the first screenshot of a folder within a picture of the common size; grey without one."""
    canvas = Image.new('RGB', SIDE, 'grey')
    for path in sorted(folder.glob('screenshot*')):
        picture = Image.open(path).convert('RGB')
        picture.thumbnail(SIDE)
        canvas.paste(picture, ((SIDE[0] - picture.width) // 2, (SIDE[1] - picture.height) // 2))
        break
    return canvas


def write_sheet(target, pairs):
    label = 14
    sheet = Image.new('RGB', (4 * SIDE[0], -(-len(pairs) // 2) * (SIDE[1] + label)), 'white')
    draw = ImageDraw.Draw(sheet)
    for number, (name, ours, theirs) in enumerate(pairs):
        x, y = number % 2 * 2 * SIDE[0], number // 2 * (SIDE[1] + label)
        sheet.paste(ours, (x, y))
        sheet.paste(theirs, (x + SIDE[0], y))
        draw.text((x + 3, y + SIDE[1] + 1), name, fill='black')
    sheet.save(target, quality=85)


def document_of(data):
    """Returns docs/gallery.md: models by what differs."""
    by_difference = {}
    for name, model in data.items():
        by_difference.setdefault(model['difference'], []).append(name)
    lines = ['# Gallery', '', 'Sample models of glTF beside their screenshots (`tools/make_gallery.py`; hashes of all: [gallery.json](gallery.json)). View, light',
             'and ground differ everywhere; else:', '']
    named = ((difference, names) for difference, names in by_difference.items() if difference)
    return '\n'.join(lines + ['- %s: %s.' % (', '.join(names), difference) for difference, names in named]) + '\n'


def main():
    words, _, further = ' '.join(sys.argv[1:]).partition(' -- ')
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('pertev')
    parser.add_argument('scenes', type=pathlib.Path)
    parser.add_argument('out', type=pathlib.Path)
    parser.add_argument('--write', action='store_true')
    parser.add_argument('--document', action='store_true')
    args = parser.parse_args(words.split())
    data = json.loads(DATA.read_text(encoding='utf-8'))
    if args.document:
        DATA.with_suffix('.md').write_text(document_of(data), encoding='utf-8')
        return 0
    args.out.mkdir(parents=True, exist_ok=True)
    pairs, wrong = [], []
    for path in models(args.scenes / 'gltf'):
        name = path.parent.name
        model = data.setdefault(name, {'flags': '', 'hash': '', 'difference': ''})
        picture = args.out / (name + '.png')
        found = render(args.pertev, path, picture, model['flags'].split() + further.split())
        if found != model['hash'] and not args.write:
            wrong.append('%s: %s, but %s in the file' % (name, found, model['hash'] or 'none'))
        if found:
            model['hash'] = found
            pairs.append((name, Image.open(picture).convert('RGB'), screenshot_of(path.parent)))
    for first in range(0, len(pairs), 8):
        write_sheet(args.out / ('sheet-%d.jpg' % (first // 8 + 1)), pairs[first:first + 8])
    if args.write:
        DATA.write_text(json.dumps(data, indent=1) + '\n', encoding='utf-8')
    print('\n'.join(wrong + ['%d models, %d differ' % (len(pairs), len(wrong))]))
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
