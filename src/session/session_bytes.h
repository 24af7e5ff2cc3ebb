#pragma once

// Device memory that a session will need, before there is one.

#include <cstddef>

#include "denoise/reconstruction_settings.h"
#include "render/prepare_scene.h"
#include "restir/restir_settings.h"
#include "settings/render_settings.h"

namespace pertev {

/// Predicted device memory, in bytes, of a session that renders `settings.samples` in one call.
std::size_t predicted_bytes(const PreparedScene& scene, const RenderSettings& settings, bool on_cuda);
/// Predicted bytes for real-time frames of a scene that changes. Temporal gradients use memory of the reconstruction.
std::size_t predicted_frame_bytes(const PreparedScene& scene, const RenderSettings& settings,
                                  const ReconstructionSettings& reconstruction, const RestirSettings& restir,
                                  bool on_cuda);

} // namespace pertev
