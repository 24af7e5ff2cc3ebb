#!/usr/bin/env python3
"""Checks that device code reads no register before it is written: tools/check_stalls.py PROGRAM, with code for sm_90.

ptxas 13.0 counts too few cycles where CS2R clears a pair of registers that a predicated instruction may write next, as for a pointer
that is null unless a condition holds. The comparison that follows then finds the pair's former value, and a kernel read through null.
Prints each read fewer than six cycles after CS2R, and exits 1 if there is one. Stores read their data later and do not count; reads
behind a branch that is taken are not seen.
Needs cuobjdump and nvdisasm (PyPI: nvidia-cuda-cuobjdump, nvidia-cuda-nvdisasm). The stall cycles of an instruction are bits 105 to
108 of its two words (Jia et al., "Dissecting the NVIDIA Volta GPU Architecture via Microbenchmarking", 2018, section 2.1).
"""

import pathlib
import re
import subprocess
import sys
import tempfile

CYCLES = 6  # after which the registers of CS2R are read elsewhere
LINE = re.compile(r"\s+/\*([0-9a-f]{4,})\*/\s+(@!?U?P\w+\s+)?(\S+)\s*(.*?)\s*;?\s*/\* 0x[0-9a-f]{16} \*/")
STORES = ("ST", "RED", "ATOM")
ENDS = ("BRA", "BRX", "JMP", "EXIT", "RET")
WITHOUT_RESULT = ("ISETP", "FSETP", "DSETP", "HSETP", "PLOP3", "R2P", "BRA", "BRX", "CALL", "RET")


def registers_read(name, operands):
    """Numbers of the registers that an instruction reads; a pair's second one where the text has .64."""
    sources = operands if name.startswith(WITHOUT_RESULT) else operands.partition(",")[2]
    return {int(number) + second for number, pair in re.findall(r"\bR(\d+)(\.64)?", sources) for second in range(2 if pair else 1)}


def early_read(lines, start):
    """The cycles to the first early read of the CS2R in lines[start], and the instruction; None if there is none. Each instruction
    has two lines, of which the second ends with the word that has the stall cycles."""
    pair, cycles = set(), 0
    for i in range(start, len(lines) - 1):
        found = LINE.match(lines[i])
        if not found:
            continue
        _, condition, name, operands = found.groups()
        if not pair:
            first = re.match(r"R(\d+)", operands)
            if not first:
                return None  # RZ
            pair = {int(first.group(1)), int(first.group(1)) + 1}
        elif registers_read(name, operands) & pair and not name.startswith(STORES):
            return cycles, f"{name} {operands}"
        elif not condition:
            if name.startswith(ENDS):
                return None
            if written := re.match(r"R(\d+)\b", operands):
                pair.discard(int(written.group(1)))
        cycles += max(int(re.search(r"/\* (0x[0-9a-f]{16}) \*/", lines[i + 1]).group(1), 16) >> 41 & 15, 1)
        if cycles >= CYCLES or not pair:
            return None
    return None


def early_reads(text):
    """Yields (kernel, cycles, instruction) for each early read in nvdisasm's text with its words."""
    lines, kernel = text.split("\n"), ""
    for i, line in enumerate(lines):
        if line.startswith(".text."):
            kernel = line[len(".text."):].rstrip(":")
        elif "CS2R" in line and (found := early_read(lines, i)):
            yield kernel, *found


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program, count, kernels = pathlib.Path(sys.argv[1]).resolve(), 0, set()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["cuobjdump", "-xelf", "all", program], cwd=folder, stdout=subprocess.DEVNULL, check=True)
        codes = sorted(pathlib.Path(folder).glob("*.cubin"))
        for code in codes:
            text = subprocess.run(["nvdisasm", "-c", "-hex", code], stdout=subprocess.PIPE, text=True, check=True).stdout
            count += text.count("\n.text.")
            for kernel, cycles, instruction in early_reads(text):
                kernels.add(kernel)
                print(f"{kernel}\n    cleared by CS2R, read {cycles} cycles later: {instruction}")
    print(f"{count} kernels in {len(codes)} parts, {len(kernels)} of them read a register too early")
    sys.exit(1 if kernels or not codes else 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
