#pragma once

// Elementary functions with one result, to the bit, on every compiler, CPU and GPU: float polynomials evaluated with
// + - * / sqrt and written-out fma, which IEEE 754 rounds in one way. libm and CUDA's own functions differ between
// versions and devices, so nothing that feeds a picture calls them. Inside namespace pertev the unqualified name is
// ours.
//
// Special values follow C's Annex F; a NaN result is always the quiet NaN 0x7fc00000. Each function states its greatest
// error in ulp; tests/unit/portable_math_test.cpp measures it, over all floats in the long setting.
// Coefficients: tools/fit_polynomials.py.

#include "math/portable_exp_log.h"
#include "math/portable_inverse_trig.h"
#include "math/portable_pow.h"
#include "math/portable_trig.h"
