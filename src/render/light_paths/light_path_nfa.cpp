#include "render/light_paths/light_path_nfa.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {
namespace {

using State = LightPathNfa::State;
constexpr uint32_t kNone = LightPathNfa::kNone;

class Builder {
public:
    explicit Builder(const LightPathExpression& expression) : expression_(expression) {}

    LightPathNfa build() {
        const Part whole = add(expression_.root);
        nfa_.first = whole.first;
        nfa_.last = whole.last;
        return std::move(nfa_);
    }

private:
    struct Part {
        uint32_t first, last; // `last` has no transition yet
    };

    uint32_t add_state(State state = {}) {
        if (nfa_.states.size() >= 4 * kMaxLightPathLetters) {
            throw Error(ErrorCode::OverLimit, "lpe", expression_.name,
                        fmt::format("the expression has more than {} letters once its {{n}} are expanded",
                                    kMaxLightPathLetters));
        }
        nfa_.states.push_back(state);
        return static_cast<uint32_t>(nfa_.states.size() - 1);
    }
    void connect(uint32_t from, uint32_t to) {
        State& state = nfa_.states[from];
        (state.empty[0] == kNone ? state.empty[0] : state.empty[1]) = to;
    }
    Part add(uint32_t index) {
        const LightPathNode& node = expression_.nodes[index];
        switch (node.kind) {
        case LightPathNode::Kind::Letter: {
            const uint32_t last = add_state();
            return {add_state({.letter = node.letter, .next = last}), last};
        }
        case LightPathNode::Kind::Sequence:
            return add_sequence(node);
        case LightPathNode::Kind::Choice:
            return add_choice(node);
        case LightPathNode::Kind::Repeat:
            return add_repeat(node);
        }
        return {};
    }
    /// Adds the automaton of a sequence, built from its end, in the order in which a path is read.
    Part add_sequence(const LightPathNode& node) {
        const uint32_t first = add_state();
        uint32_t last = first;
        for (auto part = node.parts.rbegin(); part != node.parts.rend(); ++part) {
            const Part next = add(*part);
            connect(last, next.first);
            last = next.last;
        }
        return {first, last};
    }
    Part add_choice(const LightPathNode& node) {
        const uint32_t first = add_state(), last = add_state();
        uint32_t fork = first;
        for (const uint32_t index : node.parts) {
            const Part part = add(index);
            const uint32_t next_fork = add_state();
            nfa_.states[fork].empty[0] = part.first;
            nfa_.states[fork].empty[1] = next_fork;
            connect(part.last, last);
            fork = next_fork;
        }
        return {first, last};
    }
    Part add_repeat(const LightPathNode& node) {
        const uint32_t first = add_state();
        uint32_t at = first;
        const auto append = [&](Part part) {
            connect(at, part.first);
            at = part.last;
            return part;
        };
        for (uint32_t i = 0; i < node.least; ++i) append(add(node.parts.front()));
        const uint32_t last = add_state();
        if (node.most == LightPathNode::kAny) {
            const uint32_t loop = add_state();
            connect(at, loop);
            const Part part = add(node.parts.front());
            connect(loop, part.first);
            connect(loop, last);
            connect(part.last, loop);
            return {first, last};
        }
        for (uint32_t i = node.least; i < node.most; ++i) {
            const uint32_t fork = add_state();
            connect(at, fork);
            const Part part = add(node.parts.front());
            connect(fork, part.first);
            connect(fork, last);
            at = part.last;
        }
        connect(at, last);
        return {first, last};
    }

    const LightPathExpression& expression_;
    LightPathNfa nfa_;
};

/// Returns whether the automaton accepts a path of the eye, any scatterings and a light. `reads_eye` is set to whether
/// it reads the eye.
bool takes_a_path(const LightPathExpression& expression, const LightPathNfa& nfa, bool& reads_eye) {
    using Kind = LightPathLetter::Kind;
    enum Phase : uint32_t { Before, Between, After };
    const auto states = static_cast<uint32_t>(nfa.states.size());
    std::vector<bool> seen(std::size_t(3) * states);
    std::vector<uint32_t> open;
    const auto visit = [&](Phase phase, uint32_t state) {
        const uint32_t node = phase * states + state;
        if (state == kNone || seen[node]) return;
        seen[node] = true;
        open.push_back(node);
    };
    visit(Before, nfa.first);
    while (!open.empty()) {
        const auto phase = static_cast<Phase>(open.back() / states);
        const State& state = nfa.states[open.back() % states];
        open.pop_back();
        for (const uint32_t to : state.empty) visit(phase, to);
        if (state.letter == kNone) continue;
        switch (expression.letters[state.letter].kind) {
        case Kind::Eye:
            if (phase == Before) visit(Between, state.next);
            break;
        case Kind::Scattering:
            if (phase == Between) visit(Between, state.next);
            break;
        case Kind::Light:
            if (phase == Between) visit(After, state.next);
            break;
        }
    }
    const auto between = seen.begin() + states;
    reads_eye = std::any_of(between, between + states, [](bool is_seen) { return is_seen; });
    return seen[After * states + nfa.last];
}

} // namespace

LightPathNfa make_nfa(const LightPathExpression& expression) { return Builder(expression).build(); }

void close_over_empty(const LightPathNfa& nfa, std::vector<uint32_t>& states, std::vector<bool>& seen) {
    std::ranges::sort(states);
    states.erase(std::unique(states.begin(), states.end()), states.end());
    for (const uint32_t state : states) seen[state] = true;
    for (std::size_t i = 0; i < states.size(); ++i) {
        for (const uint32_t to : nfa.states[states[i]].empty) {
            if (to == kNone || seen[to]) continue;
            seen[to] = true;
            states.push_back(to);
        }
    }
    for (const uint32_t state : states) seen[state] = false;
    std::ranges::sort(states);
}

void check_matches_something(const LightPathExpression& expression) {
    bool reads_eye = false;
    if (takes_a_path(expression, make_nfa(expression), reads_eye)) return;
    const std::string& text = expression.text;
    throw Error(
        ErrorCode::BadInput,
        reads_eye
            ? point_at(
                  expression, std::min(text.find_first_not_of(" \t"), text.size()),
                  "no path matches: a path begins with one L, the light, followed only by scatterings up to the last E")
            : point_at(expression, text.empty() ? 0 : text.find_last_not_of(" \t"),
                       "no path matches: a path ends with one E, the eye"));
}

} // namespace pertev
