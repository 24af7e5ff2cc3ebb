#pragma once

// All objects of a Mitsuba file with what it includes, by number and by id.

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/sink.h"
#include "formats/mitsuba/object.h"

namespace pertev::mitsuba {

class Objects {
public:
    Object& add(std::string tag, std::string type, std::string id, FileLocation location, std::string what);
    /// Lets `as` be another name of the object `id`.
    void add_alias(const std::string& id, const std::string& as) { aliases_[as] = id; }
    /// The id by which find() knows an object that may have none of its own.
    static std::string id_of(const Object& object);

    /// Returns whether an object has this id, which is not empty.
    bool has(const std::string& id) const { return ids_.contains(id); }
    /// Returns the object with this id. Throws Error(BadInput) that names `from` if there is none.
    Object& find(const std::string& id, const FileLocation& from);

    std::vector<uint32_t>& top() { return top_; } // objects directly in <scene>, in order
    Object& at(uint32_t number) { return all_[number]; }
    std::size_t size() const { return all_.size(); }

private:
    std::deque<Object> all_;
    std::map<std::string, uint32_t, std::less<>> ids_;
    std::map<std::string, std::string, std::less<>> aliases_;
    std::vector<uint32_t> top_;
    std::size_t missing_ = 0; // ids that were looked up in vain
};

/// Counts how deep objects name each other, so that a cycle ends with an error.
class Depth {
public:
    /// Throws Error(BadInput) at `from` beyond kMostDepth.
    Depth(int& depth, const Object& from);
    ~Depth() { --depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;

private:
    static constexpr int kMostDepth = 32;
    int& depth_;
};

} // namespace pertev::mitsuba
