#!/usr/bin/env python3
"""How soon a page of `pertev view` shows what is asked for, in a real headless Chromium on the same machine:
tools/view_latency_in_browser.py PERTEV SCENE [options] [-- flags of pertev view], on the CPU by default.

Holds a key that turns the view's place into another one with each picture of the browser. Milliseconds from an input to
the first picture that shows it and is drawn, by the page's own clock, and what of that is beyond the frame itself (the
median of its stages, as the panel has them): medians and 95th percentiles. Exits 1 where more than `--most` milliseconds
(50) are beyond the frame, at the median. tools/view_latency.py measures the same without a browser."""

import argparse
import pathlib
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "robust"))
from chromium import Chromium, find_chromium  # pylint: disable=wrong-import-position
from viewer_client import Viewer  # pylint: disable=wrong-import-position

# Input numbers of each drawn picture; none if it shows no new one.
WATCH = """(() => { window.waits = []; new MutationObserver(() => {
  if (document.body.dataset.latency) window.waits.push(Number(document.body.dataset.latency));
}).observe(document.body, {attributeFilter: ['data-frame']}); })()"""
ROWS = """[...document.querySelectorAll('#readings .row')].map((row) => [...row.querySelectorAll('span')].map((s) => s.innerText))"""


def share(values, part):
    return sorted(values)[min(int(part * len(values)), len(values) - 1)] if values else float("nan")


def steered(page, seconds):
    """Milliseconds of each input that was seen, and of the frames and their packing, while a key is held."""
    frame_ms, pack_ms, rates, sizes = [], [], [], set()
    page.key("KeyD", "d", up=False)
    time.sleep(1)  # until the size has settled
    page.value(WATCH)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        time.sleep(0.25)
        rows = dict(page.value(ROWS))
        pack_ms.append(float(rows["pack"].split()[0]))
        frame_ms.append(sum(float(value.split()[0]) for label, value in rows.items()
                            if value.endswith(" ms") and label != "input to picture"))
        rates += [float(rows["shown here"].split()[0])] if "shown here" in rows else []
        sizes.add(rows["size"])
    waits = page.value("window.waits")
    page.key("KeyD", "d", down=False)
    return waits, frame_ms, pack_ms, rates, sizes


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("pertev", help="the program, which tests/robust takes from the command line too")
    parser.add_argument("scene")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--most", type=float, default=50, help="milliseconds beyond the frame, at the median")
    own = sys.argv[1:]
    more = own[own.index("--") + 1 :] if "--" in own else []
    given = parser.parse_args(own[: len(own) - len(more) - 1] if "--" in own else own)
    if find_chromium() is None:
        sys.exit("no Chromium is here")
    with Viewer(*more, scene=given.scene, size=given.size, spp=100000, device=given.device) as viewer, \
            Chromium(1920, 1080) as page:
        page.go(viewer.address)
        page.until("document.body.dataset.samples")
        waits, frame_ms, pack_ms, rates, sizes = steered(page, given.seconds)
    frame = share(frame_ms, 0.5)
    beyond = [wait - frame for wait in waits]
    print(f"{share(rates, 0.5):.1f} pictures a second shown, of {', '.join(sorted(sizes))}; frame {frame:.1f} ms, pack "
          f"{share(pack_ms, 0.5):.1f} ms")
    print(f"input to drawn picture {share(waits, 0.5):.1f} ms, 95th percentile {share(waits, 0.95):.1f}; beyond the frame "
          f"{share(beyond, 0.5):.1f} ms, 95th percentile {share(beyond, 0.95):.1f} ({len(waits)} inputs)")
    sys.exit(0 if share(beyond, 0.5) <= given.most else 1)


if __name__ == "__main__":
    main()
