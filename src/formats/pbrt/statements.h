#pragma once

// Reads the statements of pbrt files in their order. An unreadable or unknown statement is left out with a warning, and
// the next one is read.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/files/included_files.h"
#include "formats/pbrt/context.h"
#include "formats/pbrt/tokens.h"
#include "formats/pbrt/world.h"

namespace pertev::pbrt {

class Statements {
public:
    /// The arguments must outlive this object.
    Statements(const Context& context, World& world) : context_(context), world_(world) {}

    /// Reads the text of a file that has `file_bytes`. `file` is its path, to which includes are relative. Throws
    /// Error(OverLimit) if the files of the scene take more than the size of the first one justifies, or the same ones
    /// are included very often.
    void read(std::string_view text, const std::filesystem::path& file, uint64_t file_bytes);
    /// The size of all files so far.
    uint64_t bytes() const { return bytes_; }

private:
    struct Statement;
    static const std::vector<Statement>& all();
    static const Statement* find(std::string_view name);

    void read_one(Tokens& tokens, const Statement& statement, const FileLocation& location);
    void finish();
    std::string take_text(Tokens& tokens, const FileLocation& location);
    std::vector<double> take_numbers(Tokens& tokens, std::size_t count, const FileLocation& location);
    Parameters take_parameters(Tokens& tokens, const FileLocation& location, std::string what,
                               const char* attribute = "");
    /// Takes the type and the parameters of a statement about the picture; `what` names it in messages.
    ViewStatement take_view(Tokens& tokens, const FileLocation& location, std::string_view what);
    void apply(const DoubleTransform& transform, bool replaces, const FileLocation& location);

    // One function for each statement, or for a few.
    void include(Tokens& tokens, const FileLocation& location);
    void import_file(Tokens& tokens, const FileLocation& location);
    void read_file(Tokens& tokens, const FileLocation& location, bool keeps_state);
    void begin(Tokens& tokens, const FileLocation& location);
    void end(Tokens& tokens, const FileLocation& location);
    void begin_transform(Tokens& tokens, const FileLocation& location);
    void end_transform(Tokens& tokens, const FileLocation& location);
    void begin_world(Tokens& tokens, const FileLocation& location);
    void end_world(Tokens& tokens, const FileLocation& location);
    void begin_object(Tokens& tokens, const FileLocation& location);
    void end_object(Tokens& tokens, const FileLocation& location);
    void instance(Tokens& tokens, const FileLocation& location);
    void identity(Tokens& tokens, const FileLocation& location);
    void translate(Tokens& tokens, const FileLocation& location);
    void scale(Tokens& tokens, const FileLocation& location);
    void rotate(Tokens& tokens, const FileLocation& location);
    void look_at(Tokens& tokens, const FileLocation& location);
    void transform(Tokens& tokens, const FileLocation& location);
    void concat_transform(Tokens& tokens, const FileLocation& location);
    void coordinate_system(Tokens& tokens, const FileLocation& location);
    void coord_sys_transform(Tokens& tokens, const FileLocation& location);
    void active_transform(Tokens& tokens, const FileLocation& location);
    void transform_times(Tokens& tokens, const FileLocation& location);
    void reverse_orientation(Tokens& tokens, const FileLocation& location);
    void camera(Tokens& tokens, const FileLocation& location);
    void film(Tokens& tokens, const FileLocation& location);
    void sampler(Tokens& tokens, const FileLocation& location);
    void integrator(Tokens& tokens, const FileLocation& location);
    void pixel_filter(Tokens& tokens, const FileLocation& location);
    void accelerator(Tokens& tokens, const FileLocation& location);
    void option(Tokens& tokens, const FileLocation& location);
    void color_space(Tokens& tokens, const FileLocation& location);
    void attribute(Tokens& tokens, const FileLocation& location);
    void texture(Tokens& tokens, const FileLocation& location);
    void material(Tokens& tokens, const FileLocation& location);
    void make_named_material(Tokens& tokens, const FileLocation& location);
    void named_material(Tokens& tokens, const FileLocation& location);
    void medium(Tokens& tokens, const FileLocation& location);
    void medium_interface(Tokens& tokens, const FileLocation& location);
    void light(Tokens& tokens, const FileLocation& location);
    void area_light(Tokens& tokens, const FileLocation& location);
    void shape(Tokens& tokens, const FileLocation& location);

    /// A state that an end statement restores.
    struct Kept {
        GraphicsState state;
        bool is_transform_alone = false, is_object = false;
    };

    const Context& context_;
    World& world_;
    std::vector<Kept> kept_;
    std::size_t files_ = 0;                // open ones
    uint64_t bytes_ = 0, first_bytes_ = 0; // sizes of files on the disk
    uint64_t text_bytes_ = 0;
    IncludedFiles included_;
};

} // namespace pertev::pbrt
