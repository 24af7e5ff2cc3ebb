#pragma once

// Light-path expressions: which light a layer shows, in Heckbert's letters from the light to the eye, as LS+DE. Plain
// text to a tree; light_path_automaton.h makes of trees what devices read.
//
// Source: Heckbert, "Adaptive Radiosity Textures for Bidirectional Ray Tracing", SIGGRAPH 1990, for the letters. The
// grammar (docs/transport.md shows it by examples):
//   expression = branch { '|' branch }
//   branch     = { piece }
//   piece      = atom { '*' | '+' | '?' | '{' n '}' | '{' n ',' '}' | '{' n ',' m '}' }
//   atom       = 'L' [ filter ] | 'E' | scattering | '[' [ '^' ] scattering { scattering } ']' | '(' expression ')'
//   scattering = ( 'D' | 'G' | 'S' | '.' ) [ filter ]
//   filter     = '<' [ 'R' | 'T' ] [ [ '^' ] name { name } ] '>'
//   name       = text between ' or ", in which * stands for any letters, ? for one, \ takes the next as it is
// Blanks between these say nothing.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/remark.h"
#include "shading/lobes/bsdf_sample.h"

namespace pertev {

/// Names between < and >.
struct NameFilter {
    struct Name {
        std::string pattern;
        std::size_t place; // of its first letter, in the expression
    };
    std::vector<Name> names = {};
    bool is_negated = false; // all but these
};

inline constexpr uint32_t kNoNames = 0xffffffffu;

/// Which way light goes on at a surface, of scatterings.
enum WayBits : uint8_t { kWayReflected = 1, kWayTransmitted = 2, kAnyWay = 3 };

/// A set of scatterings: one of `classes`, one of `ways`, at something that `names` lets through.
struct ScatteringTerm {
    LobeClasses classes = kAllLobeClasses;
    uint8_t ways = kAnyWay;
    uint32_t names = kNoNames; // index into LightPathExpression::filters
};

/// One letter of an expression, or a set in brackets.
struct LightPathLetter {
    enum class Kind : uint8_t { Light, Eye, Scattering };
    Kind kind = Kind::Scattering;
    std::vector<ScatteringTerm> terms = {}; // of scatterings: any of them
    bool is_negated = false;                // none of them
    uint32_t names = kNoNames;              // of lights
};

/// A piece of the tree: a letter, pieces one after the other, one of several, or one again and again.
struct LightPathNode {
    enum class Kind : uint8_t { Letter, Sequence, Choice, Repeat };
    Kind kind = Kind::Sequence;
    uint32_t letter = 0;              // index into LightPathExpression::letters
    std::vector<uint32_t> parts = {}; // indices into LightPathExpression::nodes; of Repeat one
    uint32_t least = 0, most = kAny;  // of Repeat
    static constexpr uint32_t kAny = 0xffffffffu;
};

struct LightPathExpression {
    std::string name; // of the layer
    std::string text;
    std::vector<NameFilter> filters;
    std::vector<LightPathLetter> letters;
    std::vector<LightPathNode> nodes;
    uint32_t root = 0;
};

/// Of one expression, as it is written.
inline constexpr std::size_t kMaxLightPathText = 4096;
/// Of one expression, in letters, each counted as often as {n} asks for it.
inline constexpr uint64_t kMaxLightPathLetters = 4096;

/// Of NAME=EXPR, as `lpe` takes it. NAME: letters, digits, - and _, at most 64. Throws Error(BadInput) with the
/// expression and a caret under the character that is wrong, also for one that no light path can match;
/// Error(OverLimit) past kMaxLightPathText and kMaxLightPathLetters.
LightPathExpression parse_light_path(std::string_view text);

/// A remark on the setting `lpe`: why, the expression, and a caret under the letter at `place`.
Remark point_at(const LightPathExpression& expression, std::size_t place, std::string_view why);

} // namespace pertev
