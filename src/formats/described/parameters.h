#pragma once

// Typed parameters of an object in a scene file of pbrt or Mitsuba. Readers look them up by name; what no reader has
// looked up in the end is unknown and is left out with a warning, which suggests the closest name that one has.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/sink.h"
#include "image/color_primaries.h"
#include "math/double_vec3.h"

namespace pertev::described {

enum class ParameterType {
    Integer,
    Float,
    Bool,
    String,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal3,
    Rgb,
    Xyz,
    Spectrum,
    Blackbody,
    Texture,   // the name of a texture or another object
    Transform, // 12 numbers, row by row
};

struct Parameter {
    ParameterType type = ParameterType::Float;
    std::string name;
    std::vector<double> numbers;    // for all types except those below
    std::vector<std::string> texts; // for Bool, String, Texture, and a Spectrum with a name
    std::size_t line = 0;
};

/// A statement's location and parameters.
class Parameters {
public:
    Parameters() = default;
    Parameters(FileLocation location, std::string what) : location_(std::move(location)), what_(std::move(what)) {}

    /// Adds a parameter; of equal names the first counts.
    void add(Parameter parameter) { all_.push_back(std::move(parameter)); }
    /// Adds the parameters of `others` whose names are not there.
    void add_missing(const Parameters& others);

    /// Sets the matrix from the colour space of the parameters' colours to linear Rec. 709; none if they are in linear
    /// Rec. 709.
    void set_color_space(std::optional<ColorMatrix> to_rec709) { to_rec709_ = std::move(to_rec709); }
    const std::optional<ColorMatrix>& color_space() const { return to_rec709_; }

    const FileLocation& location() const { return location_; }
    /// Returns the file and line of a parameter.
    FileLocation location_of(const Parameter& parameter) const { return {location_.file, parameter.line}; }
    /// Returns what the parameters belong to, for messages: "the shape sphere".
    const std::string& what() const { return what_; }
    Error error(std::string reason) const { return {ErrorCode::BadInput, location_, std::move(reason)}; }

    /// Returns the parameter with this name, whatever its type; null if there is none.
    const Parameter* find(std::string_view name);
    bool has(std::string_view name) { return find(name) != nullptr; }
    /// Marks the parameter `name` as looked up. find() cannot take a name that does not outlive this object.
    void look_up(std::string_view name) { looked_up_.emplace_back(name); }
    const std::vector<Parameter>& all() const { return all_; }
    /// Returns whether there is a parameter with this name, without looking it up.
    bool contains(std::string_view name) const;
    /// Returns the bytes that the values of all parameters take.
    std::size_t bytes() const;

    // Values by name; `missing` if there is none. One of another type is left out with a warning.
    double number(std::string_view name, double missing, Sink& sink);
    int64_t integer(std::string_view name, int64_t missing, Sink& sink);
    bool truth(std::string_view name, bool missing, Sink& sink);
    std::string text(std::string_view name, const std::string& missing, Sink& sink);
    /// Returns the numbers of a list, which has a multiple of `size` of them; empty without the list.
    std::span<const double> numbers(std::string_view name, std::size_t size, Sink& sink);
    /// Returns a point, vector or normal.
    std::optional<DoubleVec3> vector(std::string_view name, Sink& sink);

    /// Looks up parameters that do not change what is drawn here.
    void ignore(std::initializer_list<std::string_view> names);
    /// Leaves out those of `names` that are there; `reason` says why.
    void leave_out(std::initializer_list<std::string_view> names, std::string_view reason, Sink& sink);
    /// Leaves out the parameters that no reader has looked up.
    void leave_out_unknown(Sink& sink) const;

private:
    void leave_out_type(const Parameter& parameter, std::string_view expected, Sink& sink) const;
    const Parameter* find_of(std::string_view name, std::initializer_list<ParameterType> types,
                             std::string_view expected, Sink& sink);

    FileLocation location_;
    std::string what_;
    std::optional<ColorMatrix> to_rec709_;
    std::vector<Parameter> all_;
    std::vector<std::string_view> asked_; // literals
    std::vector<std::string> looked_up_;  // names in the file
};

} // namespace pertev::described
