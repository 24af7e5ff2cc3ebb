#pragma once

// Random numbers of a path's vertex (path_state.h has their groups): drawn on demand, as on a GPU, or ahead for eight
// paths at once, as on a CPU (drawn_numbers.h).

#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "render/batch_view.h"

namespace pertev {

/// Random words of a vertex; `Word` is for one path or for eight (math/random.h).
template <class Word>
struct VertexWords {
    SampleBitsOf<Word> light, direction;
    SampleBitsOf<Word> choices = {}; // lobe, roulette
};

/// Draws the words of a vertex; `depth` as in PathState. Choices are drawn only if requested.
template <class Word>
HD inline VertexWords<Word> draw_vertex(SamplerKind kind, SampleKeyOf<Word> key, Word depth, bool has_choices) {
    VertexWords<Word> words;
    words.light = sample_bits<Word>(kind, key, vertex_light_group(depth), Pair::Last);
    words.direction = sample_bits<Word>(kind, key, vertex_group(depth, kGroupScatter), Pair::First);
    if (has_choices) words.choices = sample_bits<Word>(kind, key, vertex_group(depth, kGroupChoices), Pair::First);
    return words;
}

/// Draws each number on demand, for one picture or for those of a batch.
struct DrawOnDemand {
    const BatchView* batch = nullptr; // null: there is one picture

    HD SampleBits light(const PathSettings& settings, const PathState& path) const {
        return sample_bits(settings.sampler, key_of(settings, path), vertex_light_group(path.depth), Pair::Last);
    }
    HD Vec2 direction(const PathSettings& settings, const PathState& path) const {
        return sample_2d(settings.sampler, key_of(settings, path), vertex_group(path.depth, kGroupScatter));
    }
    HD float lobe(const PathSettings& settings, const PathState& path) const {
        return choice(settings, path, kNumberLobe);
    }
    HD float roulette(const PathSettings& settings, const PathState& path) const {
        return choice(settings, path, kNumberRoulette);
    }

private:
    HD SampleKey key_of(const PathSettings& settings, const PathState& path) const {
        if (batch != nullptr) return batch->key(path.pixel, path.sample);
        return sample_key(settings, path.pixel, path.sample);
    }
    HD float choice(const PathSettings& settings, const PathState& path, uint32_t number) const {
        return sample_1d(settings.sampler, key_of(settings, path), vertex_group(path.depth, kGroupChoices), number);
    }
};

} // namespace pertev
