#!/usr/bin/env python3
"""Fails where object code that feeds the picture calls a function of libm that rounds: those differ between versions
and processors, and src/math/portable_math.h has ours.

`check_libm.py FILE...` reads objects, archives or binaries with nm; `--self-test COMPILER` builds a program that breaks
the rule and must be caught. Functions that IEEE 754 fixes to the last bit (sqrt, fma, floor, rint, fmod, ldexp, ...)
are fine. What a linked shared library calls inside does not show here, nor does device code.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

ROUNDING = set("""acos acosh asin asinh atan atan2 atanh cbrt cos cosh cospi erf erfc exp exp10 exp2 expm1 gamma hypot j0
j1 jn lgamma log log10 log1p log2 pow pow10 rsqrt sin sincos sinh sinpi tan tanh tgamma y0 y1 yn cexp clog cpow csqrt cabs
carg""".split())


def is_rounding(symbol):
    """True for sin, sinf, sinl, sinf32, __sinf_finite, sin@GLIBC_2.2.5, sincosf, lgamma_r, and vector forms _ZGV*_sin."""
    name = re.sub(r"@.*", "", symbol)
    name = re.sub(r"^_ZGV[a-zA-Z0-9]+_", "", name)
    name = re.sub(r"^_+", "", name)
    name = re.sub(r"(_finite|_r)+$", "", name)
    return name in ROUNDING or re.sub(r"(f|l|f16|f32|f64|f128|f32x|f64x)$", "", name) in ROUNDING


def faults_of(path):
    """Lines `object: symbol` for the forbidden symbols that the file leaves to others to define."""
    result = subprocess.run(["nm", "-A", "--undefined-only", str(path)], capture_output=True, text=True)
    if result.returncode != 0:
        return [f"{path}: {result.stderr.strip() or 'nm failed'}"]
    faults = []
    for line in result.stdout.splitlines():
        place, _, symbol = line.rpartition(" ")
        place = re.sub(r":\s+[UwvV]$", "", place.rstrip())
        if is_rounding(symbol):
            faults.append(f"{place}: calls {symbol}")
    return faults


def self_test(compiler):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)

        def faults_of_source(name, body):
            source, objects = folder / f"{name}.cpp", folder / f"{name}.o"
            source.write_text(f"#include <cmath>\n{body}\n")
            subprocess.run([compiler, "-O2", "-c", str(source), "-o", str(objects)], check=True)
            return faults_of(objects)

        for call in ("std::sin(x)", "std::pow(x, 0.3f)", "std::atan2(x, x)", "std::exp(double(x))", "std::hypot(x, x)"):
            faults = faults_of_source("bad", f"float f(float x) {{ return {call}; }}")
            assert len(faults) == 1 and "bad.o" in faults[0], (call, faults)
        both = faults_of_source("both", "void f(float x, float* y) { y[0] = std::sin(x); y[1] = std::cos(x); }")
        assert both, "sincos was not caught"
        good = "std::floor(x) + std::fma(x, x, x) + std::sqrt(x) + std::fmod(x, 3.0f) + std::ldexp(x, 3)"
        assert not faults_of_source("good", f"float f(float x) {{ return {good}; }}"), "an exact function was refused"
        assert faults_of(folder / "missing.o"), "a missing file passed"


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--self-test":
        self_test(arguments[1])
        return 0
    if not arguments or arguments[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    faults = [fault for path in arguments for fault in faults_of(path)]
    for fault in faults:
        print(fault)
    if faults:
        print("Use the functions of src/math/portable_math.h instead.")
    return 1 if faults else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main(sys.argv[1:]))
