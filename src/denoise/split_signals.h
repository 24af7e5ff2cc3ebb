#pragma once

// First stage: splits a frame's light into its two signals, and stores the data that the next frame needs.

#include "denoise/split_light.h"

namespace pertev {

struct SplitSignals {
    NoisyFrameView frame;
    SignalsView signals; // w is 0, or kUnknownSignal. The second one is absent if the frame does not split its light,
                         // because it is black
    HistoryView now;
    bool has_contacts; // the frame has contacts (contacts.h)

    HD void operator()(uint32_t i) const {
        const Float4 normal = frame.normal[i];
        const Contact contact = has_contacts ? contact_of(frame, i) : Contact::Unknown;
        now.guide[i] =
            pack({vec3_of(normal), abs(frame.albedo[i].w), normal.w, object_with(bits_of(frame.hit[i].x), contact)});
        const SplitLight light = split_light(frame, i);
        signals.diffuse[i] = diffuse_signal(light.diffuse, light.diffuse_divisor);
        if (frame.splits_light()) signals.gloss[i] = with_w(light.gloss / light.gloss_divisor, 0);
    }
};

} // namespace pertev
