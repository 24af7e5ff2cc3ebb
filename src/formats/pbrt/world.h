#pragma once

// The graphics state of a pbrt file, and all that its statements have put into the world.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/described/parts.h"
#include "formats/pbrt/camera.h"
#include "formats/pbrt/context.h"
#include "formats/pbrt/lights.h"
#include "formats/pbrt/materials.h"
#include "formats/pbrt/shapes.h"
#include "formats/pbrt/textures.h"

namespace pertev::pbrt {

/// The state that statements change and AttributeBegin keeps.
struct GraphicsState {
    std::array<DoubleTransform, 2> transforms; // at the start and the end of the shutter's time
    std::array<bool, 2> is_active = {true, true};
    bool is_reversed = false;
    uint32_t surface = 0; // index into the surfaces
    std::optional<uint32_t> area_light;
    std::string inside, outside; // names of media; empty: a vacuum
    std::optional<ColorMatrix> color_space;
    // pbrt-v4's defaults of parameters, by what they are for; shared, because most states have none.
    std::shared_ptr<const std::map<std::string, Parameters>> attributes;
};

class World {
public:
    /// `context` must outlive this object.
    explicit World(const Context& context);

    GraphicsState state;
    View view;
    std::map<std::string, std::array<DoubleTransform, 2>> coordinate_systems;

    // Statements in the world. Each throws Error(BadInput) if it is left out.
    void add_texture(const std::string& name, const std::string& kind, const std::string& type, Parameters& parameters);
    void set_material(const std::string& type, Parameters& parameters);
    void make_named_material(const std::string& name, Parameters& parameters);
    void set_named_material(const std::string& name, const FileLocation& location);
    void make_named_medium(const std::string& name, Parameters& parameters);
    void set_media(const std::string& inside, const std::string& outside, const FileLocation& location);
    /// Puts the present medium outside around everything, because a camera is there.
    void set_camera_medium() { around_ = state.outside; }
    void set_area_light(const std::string& type, Parameters& parameters);
    void add_light(const std::string& type, Parameters& parameters);
    void add_shape(const std::string& type, Parameters& parameters, uint64_t file_bytes);
    void begin_object(const std::string& name, const FileLocation& location);
    void end_object(const FileLocation& location);
    void add_instance(const std::string& name, const FileLocation& location, uint64_t file_bytes);

    /// Makes the scene. `file_bytes` is the size of all files of statements.
    Scene finish(uint64_t file_bytes);

private:
    uint32_t add_surface(const std::string& type, const std::string& name, Parameters& parameters);
    const Surface* find_surface(const std::string& name, const FileLocation& from);
    DoubleTransform place(const FileLocation& from);
    bool fill(Placed& placed);
    std::optional<uint32_t> medium_index(const std::string& name) const;
    void finish_media();
    std::optional<uint32_t> alpha_of(Parameters& parameters);

    const Context& context_;
    Parts parts_; // the first surface is the default
    Textures textures_;
    Shapes shapes_;
    std::map<std::string, uint32_t, std::less<>> named_surfaces_;
    std::map<std::string, uint32_t, std::less<>> alpha_numbers_;
    std::map<std::string, std::vector<Placed>, std::less<>> objects_;
    std::optional<std::string> open_object_;
    /// A medium may be used before the file defines it.
    struct NamedMedium {
        uint32_t index = 0; // into Parts::media
        FileLocation from;  // its first use
        bool is_defined = false;
    };
    NamedMedium& medium_called(const std::string& name, const FileLocation& from);
    std::map<std::string, NamedMedium, std::less<>> media_;
    std::string around_;
    bool has_motion_ = false; // a motion has been reported
    uint64_t shape_count_ = 0;
};

} // namespace pertev::pbrt
