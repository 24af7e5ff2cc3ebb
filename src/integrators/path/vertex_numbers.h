#pragma once

// The random numbers that a vertex of a path draws (path_state.h says which groups they are of): when they are asked
// for, as a GPU does, or ahead, those of eight paths at once, as a CPU does (drawn_numbers.h).

#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"

namespace pertev {

/// `Word`: of one path, or of eight (math/random.h).
template <class Word>
struct VertexWords {
    SampleBitsOf<Word> light, direction;
    SampleBitsOf<Word> choices = {}; // lobe, roulette
};

/// `depth`: PathState's. Choices are drawn only where they are asked for.
template <class Word>
HD inline VertexWords<Word> draw_vertex(SamplerKind kind, SampleKeyOf<Word> key, Word depth, bool has_choices) {
    VertexWords<Word> words;
    words.light = sample_bits<Word>(kind, key, vertex_light_group(depth), Pair::Last);
    words.direction = sample_bits<Word>(kind, key, vertex_group(depth, kGroupScatter), Pair::First);
    if (has_choices) words.choices = sample_bits<Word>(kind, key, vertex_group(depth, kGroupChoices), Pair::First);
    return words;
}

/// Each number drawn when it is asked for.
struct DrawWhenAsked {
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
    HD static SampleKey key_of(const PathSettings& settings, const PathState& path) {
        return sample_key(settings, path.pixel, path.sample);
    }
    HD static float choice(const PathSettings& settings, const PathState& path, uint32_t number) {
        return sample_1d(settings.sampler, key_of(settings, path), vertex_group(path.depth, kGroupChoices), number);
    }
};

} // namespace pertev
