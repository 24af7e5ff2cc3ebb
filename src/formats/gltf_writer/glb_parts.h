#pragma once

// The parts of a glTF file that is being written: the objects of its tables as JSON text, and the binary chunk that
// buffer views and accessors describe.
//
// Source: glTF 2.0, sections 3.6 and 4.4.

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"

namespace pertev::glb {

/// Returns the shortest text that is read as the same float; 0 if it is not finite.
std::string json_float(float value);
std::string json_floats(std::span<const float> values);

/// Members of a JSON object in their order.
class JsonMembers {
public:
    /// Adds a member; `json` is its text.
    JsonMembers& add(const char* name, const std::string& json);
    /// Adds a number unless it is `usual`, which readers take if the member is missing.
    JsonMembers& add_number(const char* name, float value, float usual);
    bool is_empty() const { return text_.empty(); }
    std::string text() const { return '{' + text_ + '}'; }

private:
    std::string text_;
};

class GlbParts {
public:
    /// Adds an object to a table such as "materials" and returns its index there.
    uint32_t add(const std::string& table, std::string object);
    /// Adds an object unless the table has an equal one.
    uint32_t add_once(const std::string& table, const std::string& object);
    /// Names an extension that the file uses.
    void use(const std::string& extension) { extensions_.insert(extension); }

    /// Adds a buffer view with these bytes, at a multiple of four.
    uint32_t add_view(std::span<const std::byte> bytes);
    uint32_t add_indices(std::span<const uint32_t> indices);
    uint32_t add_array(std::span<const Vec2> values);
    uint32_t add_array(std::span<const Vec3> values, bool has_bounds = false);
    uint32_t add_array(std::span<const Vec4> values);

    /// Returns the file. `members` are those of the document that are no table. Throws Error(OverLimit) if it is larger
    /// than the format can be, 4 GiB.
    std::vector<std::byte> finish(JsonMembers members) const;

private:
    uint32_t add_accessor(std::span<const std::byte> bytes, uint32_t component, std::size_t count, const char* type,
                          const std::string& bounds = "");

    std::map<std::string, std::vector<std::string>> tables_;
    std::map<std::string, uint32_t> known_; // indices of objects of add_once, by table and text
    std::set<std::string> extensions_;
    std::vector<std::byte> binary_;
};

} // namespace pertev::glb
