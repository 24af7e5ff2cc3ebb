#!/usr/bin/env python3
"""Finds loops of kernels that count in a register of the whole warp around calls that call others: tools/check_warp_counters.py BINARY

BINARY is an object or a program with kernels; `cuobjdump` of the CUDA toolkit (or of PyPI's nvidia-cuda-cuobjdump and
nvidia-cuda-nvdisasm) is on the path. src/device/per_thread.h says why such loops lose rounds. Exits 1 when there is one.
"""

import argparse
import itertools
import re
import subprocess
import sys

INSTRUCTION = re.compile(r"\s+/\*([0-9a-f]{4,})\*/\s+(.*?);")
PREDICATE = re.compile(r"^@!?U?P\d+ +")
TARGET = re.compile(r"\b(?:BRA|CALL)\S*\s+(?:\S+, )?`?\(?(0x[0-9a-f]+)")
WRITE = re.compile(r"(U[A-Z]\S*|R2UR\S*)\s+(?:UP\d+, )?(UR\d+)(.*)")


def without_predicate(text):
    return PREDICATE.sub("", text, count=1)


def calls_others(code, address_of, target):
    """Returns whether the function at `target` calls one."""
    for _, text in code[address_of[target]:]:
        if without_predicate(text).startswith("CALL"):
            return True
        if text.startswith("RET"):  # a conditional one is not the end
            return False
    return False


def warp_counters(body):
    """Returns the registers of the warp that the loop's only write to them increments."""
    writes = {}
    for _, text in body:
        if found := WRITE.match(without_predicate(text)):
            writes.setdefault(found[2], []).append((found[1], found[3]))
            if ".64" in found[1]:
                writes.setdefault(f"UR{int(found[2][2:]) + 1}", []).append((found[1], ""))
    return [name for name, all_of in writes.items() if len(all_of) == 1 and all_of[0][0] == "UIADD3" and re.search(rf"[^-]\b{name}\b", all_of[0][1])]


def faults(kernel, code):
    address_of = {address: i for i, (address, _) in enumerate(code)}
    for i, (address, text) in enumerate(code):
        branch = TARGET.search(text) if "BRA" in text else None
        start = int(branch[1], 16) if branch else address
        if start >= address or start not in address_of:
            continue
        body = code[address_of[start]:i + 1]
        calls = [int(found[1], 16) for _, inner in body if without_predicate(inner).startswith("CALL") and (found := TARGET.search(inner))]
        if any(target in address_of and calls_others(code, address_of, target) for target in set(calls)) and (names := warp_counters(body)):
            yield f"{kernel}: the loop at {start:#x} counts in {', '.join(names)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    kernel, code, found, kernels = None, [], [], 0
    with subprocess.Popen(["cuobjdump", "-sass", parser.parse_args().binary], stdout=subprocess.PIPE, text=True) as dump:
        for line in itertools.chain(dump.stdout, ["Function : "]):
            if "Function :" in line:
                found += faults(kernel, code)
                kernel, code = line.split(":", 1)[1].strip(), []
                kernels += 1
            elif instruction := INSTRUCTION.match(line):
                code.append((int(instruction[1], 16), instruction[2].strip()))
    print("\n".join([*found, f"{kernels - 1} kernels, {len(found)} faults"]))
    return 1 if found or kernels < 2 else 0


if __name__ == "__main__":
    sys.exit(main())
