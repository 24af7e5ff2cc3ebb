#pragma once

// Light-path expressions, which define the light of a layer in Heckbert's letters from the light to the eye, such as
// LS+DE. This parses text to a tree; light_path_automaton.h turns trees into device tables.
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
// Blanks between these have no meaning.

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
        std::size_t offset; // position of its first letter in the expression
    };
    std::vector<Name> names = {};
    bool is_negated = false; // matches all names but these
};

inline constexpr uint32_t kNoNames = 0xffffffffu;

/// Directions in which light leaves a surface.
enum ModeBits : uint8_t { kReflected = 1, kTransmitted = 2, kAnyMode = 3 };

/// A set of scatterings: one of `classes`, in one of `modes`, at an object that `names` accepts.
struct ScatteringTerm {
    LobeClasses classes = kAllLobeClasses;
    uint8_t modes = kAnyMode;
    uint32_t names = kNoNames; // index into LightPathExpression::filters
};

/// A letter of an expression, or a set in brackets.
struct LightPathLetter {
    enum class Kind : uint8_t { Light, Eye, Scattering };
    Kind kind = Kind::Scattering;
    std::vector<ScatteringTerm> terms = {}; // for Scattering: any of these
    bool is_negated = false;                // matches what is none of the terms
    uint32_t names = kNoNames;              // for Light
};

/// A node of the tree: a letter, a sequence, a choice or a repetition.
struct LightPathNode {
    enum class Kind : uint8_t { Letter, Sequence, Choice, Repeat };
    Kind kind = Kind::Sequence;
    uint32_t letter = 0;              // index into LightPathExpression::letters
    std::vector<uint32_t> parts = {}; // indices into LightPathExpression::nodes; one for Repeat
    uint32_t least = 0, most = kAny;  // for Repeat
    static constexpr uint32_t kAny = 0xffffffffu;
};

struct LightPathExpression {
    std::string name; // name of the layer
    std::string text;
    std::vector<NameFilter> filters;
    std::vector<LightPathLetter> letters;
    std::vector<LightPathNode> nodes;
    uint32_t root = 0;
};

/// Maximum length of an expression's text.
inline constexpr std::size_t kMaxLightPathText = 4096;
/// Maximum number of letters of an expression, each counted as often as {n} repeats it.
inline constexpr uint64_t kMaxLightPathLetters = 4096;

/// Parses NAME=EXPR, the syntax of the setting `lpe`. NAME has letters, digits, - and _, at most 64. Throws
/// Error(BadInput) with the expression and a caret under the wrong character, also for an expression that no light
/// path can match; Error(OverLimit) beyond kMaxLightPathText and kMaxLightPathLetters.
LightPathExpression parse_light_path(std::string_view text);

/// A remark on the setting `lpe`: the reason, the expression, and a caret under the letter at byte `offset`.
Remark point_at(const LightPathExpression& expression, std::size_t offset, std::string_view why);

} // namespace pertev
