#include "render/light_paths/light_path_automaton.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "render/light_paths/light_path_nfa.h"

namespace pertev {
namespace {

using StateSet = std::vector<uint32_t>; // sorted states of all automata

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorCode::OverLimit, "lpe", "", why + "; render some of the expressions separately");
}

/// The automata of all expressions, side by side in one.
class AllExpressions {
public:
    AllExpressions(std::span<const LightPathExpression> expressions, uint64_t max_steps, StateSet& firsts)
        : steps_left_(max_steps) {
        uint32_t filters = 0;
        for (const LightPathExpression& expression : expressions) {
            const LightPathNfa one = make_nfa(expression);
            const auto states = static_cast<uint32_t>(nfa_.states.size());
            const auto from = static_cast<uint32_t>(letters_.size());
            const auto moved = [](uint32_t index, uint32_t by) {
                return index == LightPathNfa::kNone ? index : index + by;
            };
            for (const LightPathNfa::State& state : one.states) {
                nfa_.states.push_back({moved(state.letter, from),
                                       moved(state.next, states),
                                       {moved(state.empty[0], states), moved(state.empty[1], states)}});
            }
            if (nfa_.states.size() > kMaxLightPathParts) {
                refuse(fmt::format("{} have too many letters in total", counted(expressions.size(), "expression")));
            }
            for (const LightPathLetter& letter : expression.letters) {
                letters_.push_back(&letter);
                first_filter_.push_back(filters);
            }
            firsts.push_back(one.first + states);
            layer_of_last_.resize(nfa_.states.size(), LightPathNfa::kNone);
            layer_of_last_[one.last + states] = layers_++;
            filters += static_cast<uint32_t>(expression.filters.size());
        }
        seen_.resize(nfa_.states.size());
    }

    uint32_t words() const { return (layers_ + 31) / 32; }
    /// Returns which letters match a scattering.
    std::vector<bool> readers_of(LobeClass lobe_class, bool is_transmission, const std::vector<bool>& tag) {
        std::vector<bool> readers(letters_.size());
        const int mode = is_transmission ? kTransmitted : kReflected;
        spend(letters_.size());
        for (uint32_t i = 0; i < letters_.size(); ++i) {
            const auto is_one = [&](const ScatteringTerm& term) {
                return term.classes.has(lobe_class) && (term.modes & mode) != 0 && lets_through(i, term.names, tag);
            };
            readers[i] = letters_[i]->kind == LightPathLetter::Kind::Scattering &&
                         std::ranges::any_of(letters_[i]->terms, is_one) != letters_[i]->is_negated;
        }
        return readers;
    }
    std::vector<bool> readers_of_light(const std::vector<bool>& tag) {
        std::vector<bool> readers(letters_.size());
        spend(letters_.size());
        for (uint32_t i = 0; i < letters_.size(); ++i) {
            readers[i] = letters_[i]->kind == LightPathLetter::Kind::Light && lets_through(i, letters_[i]->names, tag);
        }
        return readers;
    }
    std::vector<bool> readers_of_eye() const {
        std::vector<bool> readers(letters_.size());
        for (uint32_t i = 0; i < letters_.size(); ++i) readers[i] = letters_[i]->kind == LightPathLetter::Kind::Eye;
        return readers;
    }
    /// Adds everything reachable from `states` by empty transitions, without states that neither read nor end an
    /// expression.
    void close(StateSet& states) {
        close_over_empty(nfa_, states, seen_);
        spend(states.size());
        std::erase_if(states, [&](uint32_t state) {
            return nfa_.states[state].letter == LightPathNfa::kNone && layer_of_last_[state] == LightPathNfa::kNone;
        });
    }
    StateSet read(const StateSet& from, const std::vector<bool>& readers) {
        StateSet to;
        spend(from.size());
        for (const uint32_t state : from) {
            const LightPathNfa::State& s = nfa_.states[state];
            if (s.letter != LightPathNfa::kNone && readers[s.letter]) to.push_back(s.next);
        }
        close(to);
        return to;
    }
    /// Appends the layers whose expressions end in `states`.
    void append_layers(const StateSet& states, std::vector<uint32_t>& sets) const {
        const std::size_t first = sets.size();
        sets.resize(first + words());
        for (const uint32_t state : states) {
            const uint32_t layer = layer_of_last_[state];
            if (layer != LightPathNfa::kNone) sets[first + layer / 32] |= 1u << layer % 32;
        }
    }

private:
    bool lets_through(uint32_t letter, uint32_t names, const std::vector<bool>& tag) const {
        return names == kNoNames || tag[first_filter_[letter] + names];
    }
    void spend(uint64_t steps) {
        if (steps > steps_left_) {
            refuse(fmt::format("the automaton of {} takes too long to build", counted(layers_, "expression")));
        }
        steps_left_ -= steps;
    }

    LightPathNfa nfa_;
    std::vector<const LightPathLetter*> letters_;
    std::vector<uint32_t> first_filter_;  // [letters] first filter of its expression
    std::vector<uint32_t> layer_of_last_; // [states of nfa_] layer, or kNone if no expression ends there
    uint32_t layers_ = 0;
    std::vector<bool> seen_; // scratch memory of close_over_empty
    uint64_t steps_left_;
};

/// Distinct sets of letters in the order of their first appearance.
class ReaderSets {
public:
    uint16_t number_of(std::vector<bool> readers) {
        const auto [offset, is_new] = numbers_.try_emplace(std::move(readers), static_cast<uint16_t>(sets_.size()));
        if (is_new) sets_.push_back(&offset->first);
        if (sets_.size() > UINT16_MAX) refuse("the names distinguish more than 65535 objects");
        return offset->second;
    }
    const std::vector<const std::vector<bool>*>& all() const { return sets_; }
    uint32_t count() const { return static_cast<uint32_t>(sets_.size()); }

private:
    std::unordered_map<std::vector<bool>, uint16_t> numbers_;
    std::vector<const std::vector<bool>*> sets_;
};

struct HashOfStates {
    std::size_t operator()(const StateSet& states) const {
        std::size_t hash = states.size();
        for (const uint32_t state : states) hash = (hash ^ state) * 0x9e3779b97f4a7c15ull;
        return hash ^ hash >> 32;
    }
};

/// Makes the automaton by subset construction. State 0 is the empty set and state 1 the first one.
LightPathAutomaton determinise(AllExpressions& all, StateSet firsts, const LightPathTags& tags) {
    LightPathAutomaton automaton;
    ReaderSets scatterings, lights;
    for (const std::vector<bool>& tag : tags.surfaces) {
        for (const LobeClass lobe_class : {LobeClass::Diffuse, LobeClass::Glossy, LobeClass::Specular}) {
            for (const bool is_transmission : {false, true}) {
                automaton.columns.push_back(scatterings.number_of(all.readers_of(lobe_class, is_transmission, tag)));
            }
        }
    }
    for (const std::vector<bool>& tag : tags.lights) {
        automaton.lights.push_back(lights.number_of(all.readers_of_light(tag)));
    }
    automaton.column_count = scatterings.count();
    automaton.light_count = lights.count();
    automaton.words = all.words();

    const uint64_t entries_of_state = automaton.column_count + uint64_t(automaton.light_count) * automaton.words;
    std::unordered_map<StateSet, uint16_t, HashOfStates> numbers;
    std::vector<const StateSet*> sets;
    const auto number_of = [&](StateSet set) {
        const auto [offset, is_new] = numbers.try_emplace(std::move(set), static_cast<uint16_t>(numbers.size()));
        if (is_new) sets.push_back(&offset->first);
        if (sets.size() > kMaxLightPathStates) {
            refuse(fmt::format("the expressions need more than {} states in total", kMaxLightPathStates));
        }
        if (sets.size() * entries_of_state > kMaxLightPathEntries) {
            refuse(fmt::format("the names distinguish {} objects, too many for {} states",
                               automaton.column_count + automaton.light_count, sets.size()));
        }
        return offset->second;
    };
    number_of({});
    all.close(firsts);
    automaton.start = number_of(all.read(firsts, all.readers_of_eye()));
    for (std::size_t i = 0; i < sets.size(); ++i) {
        for (const std::vector<bool>* readers : scatterings.all()) {
            automaton.next.push_back(number_of(all.read(*sets[i], *readers)));
        }
        for (const std::vector<bool>* readers : lights.all()) {
            all.append_layers(all.read(*sets[i], *readers), automaton.layers);
        }
    }
    return automaton;
}

/// Merges states that no path distinguishes; kNothing stays 0. Returns `all` unchanged if that takes more than
/// `max_steps`.
///
/// Source: Moore, "Gedanken-Experiments on Sequential Machines", 1956.
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

} // namespace

LightPathAutomaton make_automaton(std::span<const LightPathExpression> expressions, const LightPathTags& tags,
                                  uint64_t max_steps) {
    PERTEV_CHECK(!expressions.empty() && !tags.surfaces.empty() && !tags.lights.empty());
    StateSet firsts;
    AllExpressions all(expressions, max_steps, firsts);
    return minimise(determinise(all, std::move(firsts), tags), max_steps);
}

} // namespace pertev
