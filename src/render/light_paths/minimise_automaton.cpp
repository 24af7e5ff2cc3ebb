#include "render/light_paths/minimise_automaton.h"

#include <map>

namespace pertev {

LightPathAutomaton minimise(LightPathAutomaton all, uint64_t max_steps) {
    const uint32_t states = all.state_count(), sets = all.light_count * all.words; // `sets` is the size of a state's
                                                                                   // table of layers
    std::vector<uint16_t> group(states);
    std::size_t groups = 0;
    const uint64_t steps = uint64_t(states) * (all.column_count + 1); // steps per round
    for (bool is_first = true;; is_first = false) {
        if (steps > max_steps) return all;
        max_steps -= steps;
        std::map<std::vector<uint32_t>, uint16_t> of_signature;
        std::vector<uint16_t> finer(states);
        for (uint32_t s = 0; s < states; ++s) {
            std::vector<uint32_t> signature;
            if (is_first) {
                signature.assign(all.layers.begin() + s * sets, all.layers.begin() + (s + 1) * sets);
            } else {
                signature.push_back(group[s]);
                for (uint32_t c = 0; c < all.column_count; ++c) {
                    signature.push_back(group[all.next[s * all.column_count + c]]);
                }
            }
            finer[s] = of_signature.try_emplace(std::move(signature), static_cast<uint16_t>(of_signature.size()))
                           .first->second; // state 0 comes first, so its group is 0
        }
        group = std::move(finer);
        if (!is_first && of_signature.size() == groups) break;
        groups = of_signature.size();
    }
    LightPathAutomaton least = all;
    least.next.assign(groups * all.column_count, 0);
    least.layers.assign(groups * sets, 0);
    for (uint32_t s = 0; s < states; ++s) {
        for (uint32_t c = 0; c < all.column_count; ++c) {
            least.next[group[s] * all.column_count + c] = group[all.next[s * all.column_count + c]];
        }
        for (uint32_t l = 0; l < sets; ++l) least.layers[group[s] * sets + l] = all.layers[s * sets + l];
    }
    least.start = group[all.start];
    return least;
}

} // namespace pertev
