"""Mutations of what frames and denoised pictures keep of light. See mutations.py."""

MUTATIONS = [
    ("the history of ReSTIR counts as much where light has changed", "statistical/restir_motion",
     ("src/restir/find_neighbours.h", "if (change.share != nullptr) {", "if (false) {")),
    ("the change of light around a pixel is that of the pixel alone", "statistical/restir_motion",
     ("src/denoise/compare_light.h", "for (int k = 0; k < 9; ++k) {\n            const Float4 there = guide[held(y, k / 3 - 1, h) * w",
      "for (int k = 4; k < 5; ++k) {\n            const Float4 there = guide[held(y, k / 3 - 1, h) * w")),
    ("a black surface's signal counts as dark", "statistical/black_texels",
     ("src/denoise/reconstruction_view.h", "if (!(known > 0)) return {0, 0, 0, kUnknownSignal};", "if (!(known > 0)) return {0, 0, 0, 0};")),
    ("a black channel's signal counts as dark", "statistical/black_texels",
     ("src/denoise/reconstruction_view.h", "const float others = sum / known;", "const float others = 0;")),
    ("the mean of shown pictures is one of compressed light", "unit/reproject",
     ("src/denoise/shown_color.h", "const Rgb c = {min(light.r, kMostShown)", "const Rgb c = {light.r / (1 + light.r)")),
    ("a history at rest is clamped", "unit/reconstruction_stages",
     ("src/denoise/anti_alias.h", "if (pixels_moved < kAtRest) {", "if (false) {")),
    ("a history in motion is not clamped", "unit/reconstruction_stages",
     ("src/denoise/anti_alias.h", "if (pixels_moved < kAtRest) {", "if (true) {")),
    ("history is not clamped where light changes", "unit/reconstruction_stages",
     ("src/denoise/anti_alias.h", "frames_at_rest >= steady.frames && steady.is_around(at, width, height)", "frames_at_rest >= steady.frames")),
]
