#pragma once

// Arrays of a caller that a picture fills (`out` of pertev.render). Means and layers of the film go straight into them.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "session/session.h"

namespace pertev {

struct OutArray {
    std::string name; // that of a Result's attribute
    nanobind::object array;
    std::byte* memory = nullptr; // null: it cannot be filled
    std::string fault;           // why not
    std::vector<std::size_t> shape;
    std::string dtype; // the name in NumPy, float32
};

/// Returns the arrays of a dictionary.
std::vector<OutArray> out_arrays(const nanobind::dict& out);
/// Returns the array of this name; null if there is none.
const OutArray* find_array(std::span<const OutArray> arrays, std::string_view name);
/// Returns whether the name is that of a picture, denoised or not, and not of a layer.
bool is_picture(std::string_view name);
/// Throws Error(BadInput) unless a picture of these settings has each of `arrays`, of the same shape and type.
void check_arrays(std::span<const OutArray> arrays, const RenderSettings& settings);

/// Copies what a picture has into the arrays.
void copy_into(std::span<const OutArray> arrays, const RenderResult& result);

/// Copies what the arrays hold back to a result whose picture has its size.
void take_back(std::span<const OutArray> arrays, RenderResult& result);

/// Reads films into arrays. What a GPU needs for it stays from one picture to the next.
class FilmReader {
public:
    /// Returns whether a film has all arrays. It has no motion, no light layers and nothing denoised.
    static bool reads(std::span<const OutArray> arrays, const RenderSettings& settings);
    /// Reads the film of `session`, whose device is that of `queue`.
    void read(Session& session, const std::shared_ptr<Queue>& queue, std::span<const OutArray> arrays);

private:
    std::shared_ptr<Queue> queue_; // outlives the buffer
    Buffer<std::byte> on_device_;
};

} // namespace pertev
