#pragma once

// Reads the statements of pbrt files in their order. An unreadable or unknown statement is left out with a warning, and
// the next one is read.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/pbrt/context.h"
#include "formats/pbrt/tokens.h"
#include "formats/pbrt/world.h"

namespace pertev::pbrt {

class Statements {
public:
    /// The arguments must outlive this object.
    Statements(const Context& context, World& world) : context_(context), world_(world) {}

    /// Reads a text. `file` is its path, to which includes are relative. Throws Error(OverLimit) if the files of the
    /// scene take more than the size of the first one justifies.
    void read(std::string_view text, const std::filesystem::path& file);
    /// The size of all texts so far.
    uint64_t bytes() const { return bytes_; }

private:
    struct Statement;
    static const std::vector<Statement>& all();
    static const Statement* find(std::string_view name);

    void read_one(Tokens& tokens, const Statement& statement, const FileLocation& place);
    void finish();
    std::string take_text(Tokens& tokens, const FileLocation& place);
    std::vector<double> take_numbers(Tokens& tokens, std::size_t count, const FileLocation& place);
    Parameters take_parameters(Tokens& tokens, const FileLocation& place, std::string what, const char* attribute = "");
    /// Takes the type and the parameters of a statement about the picture; `what` names it in messages.
    ViewStatement take_view(Tokens& tokens, const FileLocation& place, std::string_view what);
    void apply(const DoubleTransform& transform, bool replaces, const FileLocation& place);

    // One function for each statement, or for a few.
    void include(Tokens& tokens, const FileLocation& place);
    void import_file(Tokens& tokens, const FileLocation& place);
    void read_file(Tokens& tokens, const FileLocation& place, bool keeps_state);
    void begin(Tokens& tokens, const FileLocation& place);
    void end(Tokens& tokens, const FileLocation& place);
    void begin_transform(Tokens& tokens, const FileLocation& place);
    void end_transform(Tokens& tokens, const FileLocation& place);
    void begin_world(Tokens& tokens, const FileLocation& place);
    void end_world(Tokens& tokens, const FileLocation& place);
    void begin_object(Tokens& tokens, const FileLocation& place);
    void end_object(Tokens& tokens, const FileLocation& place);
    void instance(Tokens& tokens, const FileLocation& place);
    void identity(Tokens& tokens, const FileLocation& place);
    void translate(Tokens& tokens, const FileLocation& place);
    void scale(Tokens& tokens, const FileLocation& place);
    void rotate(Tokens& tokens, const FileLocation& place);
    void look_at(Tokens& tokens, const FileLocation& place);
    void transform(Tokens& tokens, const FileLocation& place);
    void concat_transform(Tokens& tokens, const FileLocation& place);
    void coordinate_system(Tokens& tokens, const FileLocation& place);
    void coord_sys_transform(Tokens& tokens, const FileLocation& place);
    void active_transform(Tokens& tokens, const FileLocation& place);
    void transform_times(Tokens& tokens, const FileLocation& place);
    void reverse_orientation(Tokens& tokens, const FileLocation& place);
    void camera(Tokens& tokens, const FileLocation& place);
    void film(Tokens& tokens, const FileLocation& place);
    void sampler(Tokens& tokens, const FileLocation& place);
    void integrator(Tokens& tokens, const FileLocation& place);
    void pixel_filter(Tokens& tokens, const FileLocation& place);
    void ignored(Tokens& tokens, const FileLocation& place);
    void option(Tokens& tokens, const FileLocation& place);
    void color_space(Tokens& tokens, const FileLocation& place);
    void attribute(Tokens& tokens, const FileLocation& place);
    void texture(Tokens& tokens, const FileLocation& place);
    void material(Tokens& tokens, const FileLocation& place);
    void make_named_material(Tokens& tokens, const FileLocation& place);
    void named_material(Tokens& tokens, const FileLocation& place);
    void medium(Tokens& tokens, const FileLocation& place);
    void medium_interface(Tokens& tokens, const FileLocation& place);
    void light(Tokens& tokens, const FileLocation& place);
    void area_light(Tokens& tokens, const FileLocation& place);
    void shape(Tokens& tokens, const FileLocation& place);

    /// A state that an end statement restores.
    struct Kept {
        GraphicsState state;
        bool is_transform_alone = false, is_object = false;
    };

    const Context& context_;
    World& world_;
    std::vector<Kept> kept_;
    std::size_t files_ = 0; // open ones
    uint64_t bytes_ = 0, first_bytes_ = 0;
};

} // namespace pertev::pbrt
