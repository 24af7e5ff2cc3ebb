#include "formats/mitsuba/read_serialized.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "formats/files/gunzip.h"

namespace pertev::mitsuba {
namespace {

constexpr uint16_t kMagic = 0x041C;
constexpr std::size_t kHeader = 4; // magic number and version
enum Flag : uint32_t { kNormals = 1, kCoordinates = 2, kColors = 8, kFaceNormals = 16, kDoubles = 0x2000 };

/// Takes little-endian values from the front of bytes.
class Taken {
public:
    Taken(std::span<const std::byte> bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    template <class T>
    T take() {
        T value;
        std::memcpy(&value, some(sizeof(T)).data(), sizeof(T));
        return value;
    }
    std::span<const std::byte> some(uint64_t size) {
        if (size > bytes_.size()) throw Error(ErrorCode::BadInput, FileLocation{file_}, "the mesh is cut off");
        const auto front = bytes_.first(static_cast<std::size_t>(size));
        bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
        return front;
    }
    uint64_t left() const { return bytes_.size(); }

private:
    std::span<const std::byte> bytes_;
    const std::string& file_;
};

template <class T>
T value_at(std::span<const std::byte> bytes, std::size_t i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    return value;
}

/// The bytes of a mesh with its header, by the table at the end.
std::span<const std::byte> piece_of(std::span<const std::byte> bytes, uint32_t index, const std::string& file) {
    const auto refuse = [&](std::string reason) {
        throw Error(ErrorCode::BadInput, FileLocation{file}, std::move(reason));
    };
    if (bytes.size() < kHeader + 4 || value_at<uint16_t>(bytes, 0) != kMagic)
        refuse("not a serialized mesh of Mitsuba");
    const auto version = value_at<uint16_t>(bytes, 1);
    if (version != 3 && version != 4) refuse(fmt::format("version {} of serialized meshes; expected 3 or 4", version));
    const uint64_t entry = version == 4 ? 8 : 4;
    const auto count = value_at<uint32_t>(bytes.last(4), 0);
    const uint64_t table = entry * count + 4;
    if (count == 0 || table > bytes.size()) refuse("the table at the end of the file is damaged");
    if (index >= count)
        refuse(fmt::format("there is no mesh {}; the file has {}, counted from 0", index, counted(count, "mesh")));
    const auto rows = bytes.subspan(static_cast<std::size_t>(bytes.size() - table));
    const auto offset = [&](std::size_t i) {
        return entry == 8 ? value_at<uint64_t>(rows, i) : uint64_t(value_at<uint32_t>(rows, i));
    };
    const uint64_t begin = offset(index), end = index + 1 < count ? offset(index + 1) : bytes.size() - table;
    if (begin > end || end > bytes.size() - table || end - begin < kHeader)
        refuse("the table at the end of the file is damaged");
    return bytes.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
}

template <class Float>
void read_vertices(Taken& taken, uint64_t vertices, uint32_t flags, SerializedMesh& to) {
    const auto each = [&](std::size_t numbers, const auto& add) {
        const auto bytes = taken.some(vertices * numbers * sizeof(Float));
        for (std::size_t i = 0; i < vertices; ++i)
            add([&](std::size_t k) { return value_at<Float>(bytes, numbers * i + k); });
    };
    each(3, [&](const auto& number) {
        const DoubleVec3 p = {double(number(0)), double(number(1)), double(number(2))};
        to.mesh.positions.push_back(to_float(p));
        if (std::is_same_v<Float, double>) to.exact.push_back(p);
    });
    if ((flags & kNormals) != 0)
        each(3, [&](const auto& number) {
            to.mesh.normals.push_back(
                {static_cast<float>(number(0)), static_cast<float>(number(1)), static_cast<float>(number(2))});
        });
    if ((flags & kCoordinates) != 0)
        each(2, [&](const auto& number) {
            to.mesh.uv[0].push_back({static_cast<float>(number(0)), static_cast<float>(number(1))});
        });
    if ((flags & kColors) != 0) (void)taken.some(vertices * 3 * sizeof(Float));
}

} // namespace

SerializedMesh read_serialized(std::span<const std::byte> bytes, uint32_t index, const std::string& file) {
    const std::span<const std::byte> piece = piece_of(bytes, index, file);
    if (value_at<uint16_t>(piece, 0) != kMagic)
        throw Error(ErrorCode::BadInput, FileLocation{file},
                    fmt::format("mesh {} does not begin where the table says", index));
    const auto version = value_at<uint16_t>(piece, 1);
    const std::vector<std::byte> content = inflate_zlib(piece.subspan(kHeader), file);
    Taken taken(content, file);
    SerializedMesh read;
    const auto flags = taken.take<uint32_t>();
    if (version >= 4) {
        for (char c = taken.take<char>(); c != 0; c = taken.take<char>()) read.mesh.name += c;
    }
    const auto vertices = taken.take<uint64_t>(), triangles = taken.take<uint64_t>();
    const uint64_t number = (flags & kDoubles) != 0 ? 8 : 4;
    // Before anything is allocated: so many cannot be in the bytes that are left.
    if (vertices > taken.left() / (3 * number) || triangles > taken.left() / 12)
        throw Error(ErrorCode::BadInput, FileLocation{file},
                    fmt::format("mesh {} has {} vertices and {} triangles in {} bytes", index, vertices, triangles,
                                taken.left()));
    if (triangles > kMaxTrianglesPerMesh || vertices > UINT32_MAX)
        throw Error(ErrorCode::OverLimit, FileLocation{file},
                    fmt::format("more than {} triangles", kMaxTrianglesPerMesh));
    read.has_face_normals = (flags & kFaceNormals) != 0;
    if (number == 8) {
        read_vertices<double>(taken, vertices, flags, read);
    } else {
        read_vertices<float>(taken, vertices, flags, read);
    }
    const auto corners = taken.some(triangles * 12);
    read.mesh.indices.resize(static_cast<std::size_t>(triangles * 3));
    std::memcpy(read.mesh.indices.data(), corners.data(), corners.size());
    if (std::ranges::any_of(read.mesh.indices, [&](uint32_t i) { return i >= vertices; }))
        throw Error(ErrorCode::BadInput, FileLocation{file}, "a triangle has a corner beyond the vertices of its mesh");
    return read;
}

} // namespace pertev::mitsuba
