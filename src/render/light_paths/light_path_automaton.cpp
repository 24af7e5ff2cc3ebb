#include "render/light_paths/light_path_automaton.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "render/light_paths/light_path_nfa.h"

namespace pertev {
namespace {

using Kind = LightPathLetter::Kind;
using StateSet = std::vector<uint32_t>; // of all automata, sorted

/// The automata of all expressions side by side, as if they were one.
struct AllExpressions {
    LightPathNfa nfa;
    std::vector<const LightPathLetter*> letters;
    std::vector<uint32_t> first_filter; // [letters]: of its expression
    std::vector<uint32_t> lasts;        // [layers]

    explicit AllExpressions(std::span<const LightPathExpression> expressions, StateSet& firsts) {
        uint32_t filters = 0;
        for (const LightPathExpression& expression : expressions) {
            const LightPathNfa one = make_nfa(expression);
            const auto states = static_cast<uint32_t>(nfa.states.size());
            const auto from = static_cast<uint32_t>(letters.size());
            const auto moved = [](uint32_t index, uint32_t by) {
                return index == LightPathNfa::kNone ? index : index + by;
            };
            for (const LightPathNfa::State& state : one.states) {
                nfa.states.push_back({moved(state.letter, from),
                                      moved(state.next, states),
                                      {moved(state.empty[0], states), moved(state.empty[1], states)}});
            }
            for (const LightPathLetter& letter : expression.letters) {
                letters.push_back(&letter);
                first_filter.push_back(filters);
            }
            firsts.push_back(one.first + states);
            lasts.push_back(one.last + states);
            filters += static_cast<uint32_t>(expression.filters.size());
        }
    }

    bool lets_through(uint32_t letter, uint32_t names, const std::vector<bool>& tag) const {
        return names == kNoNames || tag[first_filter[letter] + names];
    }
    /// Which letters read a scattering.
    std::vector<bool> readers_of(LobeClass lobe_class, bool is_transmission, const std::vector<bool>& tag) const {
        std::vector<bool> readers(letters.size());
        const int way = is_transmission ? kWayTransmitted : kWayReflected;
        for (uint32_t i = 0; i < letters.size(); ++i) {
            const auto is_one = [&](const ScatteringTerm& term) {
                return term.classes.has(lobe_class) && (term.ways & way) != 0 && lets_through(i, term.names, tag);
            };
            readers[i] = letters[i]->kind == Kind::Scattering &&
                         std::ranges::any_of(letters[i]->terms, is_one) != letters[i]->is_negated;
        }
        return readers;
    }
    std::vector<bool> readers_of_light(const std::vector<bool>& tag) const {
        std::vector<bool> readers(letters.size());
        for (uint32_t i = 0; i < letters.size(); ++i) {
            readers[i] = letters[i]->kind == Kind::Light && lets_through(i, letters[i]->names, tag);
        }
        return readers;
    }
    std::vector<bool> readers_of_eye() const {
        std::vector<bool> readers(letters.size());
        for (uint32_t i = 0; i < letters.size(); ++i) readers[i] = letters[i]->kind == Kind::Eye;
        return readers;
    }
    StateSet read(const StateSet& from, const std::vector<bool>& readers) const {
        StateSet to;
        for (const uint32_t state : from) {
            const LightPathNfa::State& s = nfa.states[state];
            if (s.letter != LightPathNfa::kNone && readers[s.letter]) to.push_back(s.next);
        }
        std::ranges::sort(to);
        to.erase(std::unique(to.begin(), to.end()), to.end());
        close_over_empty(nfa, to);
        return to;
    }
    uint32_t layers_of(const StateSet& states) const {
        uint32_t layers = 0;
        for (uint32_t layer = 0; layer < lasts.size(); ++layer) {
            layers |= std::ranges::binary_search(states, lasts[layer]) ? 1u << layer : 0;
        }
        return layers;
    }
};

/// The place of `value` among `values`, to which it is added where it is new.
template <class T>
uint16_t place_in(std::vector<T>& values, const T& value) {
    const auto found = std::ranges::find(values, value);
    if (found != values.end()) return static_cast<uint16_t>(found - values.begin());
    if (values.size() > UINT16_MAX) throw Error(ErrorCode::OverLimit, "--lpe: the names tell too many things apart");
    values.push_back(value);
    return static_cast<uint16_t>(values.size() - 1);
}

constexpr uint64_t kMaxEntries = 1u << 24; // of the tables: states times all that a path may do in one

/// Subsets of states as states, of which 0 is the empty one and 1 the first.
LightPathAutomaton determinise(const AllExpressions& all, StateSet firsts, const LightPathTags& tags) {
    LightPathAutomaton automaton;
    std::vector<std::vector<bool>> scatterings, lights;
    for (const std::vector<bool>& tag : tags.surfaces) {
        for (const LobeClass lobe_class : {LobeClass::Diffuse, LobeClass::Glossy, LobeClass::Specular}) {
            for (const bool is_transmission : {false, true}) {
                automaton.columns.push_back(place_in(scatterings, all.readers_of(lobe_class, is_transmission, tag)));
            }
        }
    }
    for (const std::vector<bool>& tag : tags.lights) {
        automaton.lights.push_back(place_in(lights, all.readers_of_light(tag)));
    }
    automaton.column_count = static_cast<uint32_t>(scatterings.size());
    automaton.light_count = static_cast<uint32_t>(lights.size());

    std::map<StateSet, uint16_t> numbers;
    std::vector<const StateSet*> sets;
    const auto number_of = [&](StateSet set) {
        const auto [place, is_new] = numbers.try_emplace(std::move(set), static_cast<uint16_t>(numbers.size()));
        if (is_new) sets.push_back(&place->first);
        if (sets.size() > kMaxLightPathStates) {
            throw Error(ErrorCode::OverLimit,
                        fmt::format("--lpe: the expressions need more than {} states together; render some of them "
                                    "apart",
                                    kMaxLightPathStates));
        }
        if (sets.size() * (scatterings.size() + lights.size()) > kMaxEntries) {
            throw Error(ErrorCode::OverLimit,
                        fmt::format("--lpe: the names tell {} things apart, too many for {} states; render some of the "
                                    "expressions apart",
                                    scatterings.size() + lights.size(), sets.size()));
        }
        return place->second;
    };
    number_of({});
    close_over_empty(all.nfa, firsts);
    automaton.start = number_of(all.read(firsts, all.readers_of_eye()));
    for (std::size_t i = 0; i < sets.size(); ++i) {
        for (const std::vector<bool>& readers : scatterings) {
            automaton.next.push_back(number_of(all.read(*sets[i], readers)));
        }
        for (const std::vector<bool>& readers : lights) {
            automaton.layers.push_back(all.layers_of(all.read(*sets[i], readers)));
        }
    }
    return automaton;
}

/// The least automaton that says the same: states are one where no path tells them apart. kNothing stays 0.
LightPathAutomaton minimise(const LightPathAutomaton& all) {
    const uint32_t states = all.state_count();
    std::vector<uint16_t> group(states);
    std::size_t groups = 0;
    for (bool is_first = true;; is_first = false) {
        std::map<std::vector<uint32_t>, uint16_t> of_signature;
        std::vector<uint16_t> finer(states);
        for (uint32_t s = 0; s < states; ++s) {
            std::vector<uint32_t> signature;
            if (is_first) {
                signature.assign(all.layers.begin() + s * all.light_count,
                                 all.layers.begin() + (s + 1) * all.light_count);
            } else {
                signature.push_back(group[s]);
                for (uint32_t c = 0; c < all.column_count; ++c) {
                    signature.push_back(group[all.next[s * all.column_count + c]]);
                }
            }
            finer[s] = of_signature.try_emplace(std::move(signature), static_cast<uint16_t>(of_signature.size()))
                           .first->second; // state 0 comes first: its group is 0
        }
        group = std::move(finer);
        if (!is_first && of_signature.size() == groups) break;
        groups = of_signature.size();
    }
    LightPathAutomaton least = all;
    least.next.assign(groups * all.column_count, 0);
    least.layers.assign(groups * all.light_count, 0);
    for (uint32_t s = 0; s < states; ++s) {
        for (uint32_t c = 0; c < all.column_count; ++c) {
            least.next[group[s] * all.column_count + c] = group[all.next[s * all.column_count + c]];
        }
        for (uint32_t l = 0; l < all.light_count; ++l) {
            least.layers[group[s] * all.light_count + l] = all.layers[s * all.light_count + l];
        }
    }
    least.start = group[all.start];
    return least;
}

} // namespace

LightPathAutomaton make_automaton(std::span<const LightPathExpression> expressions, const LightPathTags& tags) {
    PERTEV_CHECK(expressions.size() <= kMaxLightPathLayers && !tags.surfaces.empty() && !tags.lights.empty());
    StateSet firsts;
    const AllExpressions all(expressions, firsts);
    return minimise(determinise(all, std::move(firsts), tags));
}

} // namespace pertev
