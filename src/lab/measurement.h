#pragma once

// The one output of everything that is measured: which machine ran which command, and tables of what came out. Text for
// a terminal, CSV, JSON, and the page (lab/report_page.h) are all made from it.
//
// The JSON is an object: format "pertev-measurement", version 1, title, program, date, command, processor, threads,
// device and driver (null on the CPU), tables [{name, title, columns [{key, title, unit}], rows [[...]]}], notes
// [text], and for the page: kind, which chooses plots in page/views.json, and pictures. A value that was not measured
// is null there and empty in CSV, never 0.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "device/queue.h"
#include "image/image.h"

namespace pertev {

/// A value of a table: none, true or false, a number, or a text.
class ResultCell {
public:
    ResultCell() = default;
    ResultCell(bool value) : value_(value) {}
    template <std::integral Number>
    ResultCell(Number value) : value_(static_cast<int64_t>(value)) {}
    ResultCell(double value) : value_(value) {}
    ResultCell(std::string value) : value_(std::move(value)) {}
    ResultCell(std::string_view value) : value_(std::string(value)) {}
    ResultCell(const char* value) : value_(std::string(value)) {}
    template <class Value>
    ResultCell(const std::optional<Value>& value) {
        if (value) *this = ResultCell(*value);
    }

    /// A JSON object or array as a value.
    static ResultCell raw(std::string json) {
        ResultCell cell;
        cell.value_ = Raw{std::move(json)};
        return cell;
    }

    bool is_there() const { return !std::holds_alternative<std::monostate>(value_); }
    bool operator==(const ResultCell&) const = default;
    std::string json() const;
    /// Returns the value for CSV (RFC 4180): quoted if necessary, true as 1.
    std::string csv() const;
    /// For a terminal. `format` is that of a number, "" for the usual one; "-" if there is no value.
    std::string text(const std::string& format) const;

private:
    struct Raw {
        std::string json;
        bool operator==(const Raw&) const = default;
    };
    std::variant<std::monostate, bool, int64_t, double, std::string, Raw> value_;
};

/// A number, unless it is 0 because nothing was timed.
inline std::optional<double> if_timed(double value) { return value > 0 ? std::optional(value) : std::nullopt; }
/// A text, unless it is empty.
inline std::optional<std::string> if_not_empty(const std::string& text) {
    return text.empty() ? std::nullopt : std::optional(text);
}

/// A value with the column that it stands in.
struct ResultField {
    const char* key;
    const char* title; // for people; empty: the key alone, and a terminal leaves the column out
    ResultCell value;
    const char* unit = "";
    const char* format = ""; // fmt's format for numbers on a terminal
};
using Fields = std::vector<ResultField>;

struct ResultTable {
    struct Column {
        std::string key, title, unit, format;
    };
    std::string name, title;
    std::vector<Column> columns = {};
    std::vector<std::vector<ResultCell>> rows = {};

    /// Appends a row. The first row makes the columns; all have the same.
    void add(const Fields& fields);
    /// Throws Error(DeviceFault) if there is no such column.
    const ResultCell& at(std::size_t row, std::string_view key) const;
};

/// A picture of the page. `file`, `exr` and `error` are shown as links and beside it.
struct ResultPicture {
    std::string group, title, caption; // pictures of one group stand side by side
    Rgba8Image image = {};
    Rgba8Image error = {};   // differences from the group's reference, in false colours; empty: there are none
    std::string svg = {};    // in place of `image`
    Image linear = {};       // radiance, for an EXR file beside the page
    std::string file, exr{}; // names beside the page; empty: not written
};

struct Measurement {
    std::string kind = {}; // key in page/views.json; empty: tables only
    std::string title, program, date, command, processor;
    uint32_t threads = 0;       // CPU threads
    std::string device, driver; // empty: the CPU's
    bool interrupted = false;
    std::vector<ResultTable> tables = {};
    std::vector<std::string> notes = {};
    std::vector<ResultPicture> pictures = {};

    const ResultTable& table(std::string_view name) const;
};

/// A measurement of this program on this machine and this queue's device, now, by the command that runs.
Measurement start_measurement(const Queue& queue, std::string title);

/// With `event` the object says so first. With `has_images` pictures carry their bytes, as a page needs them.
std::string json_of(const Measurement& measurement, std::string_view event = "", bool has_images = false);
/// A row as an object of its own; without an event it says none.
std::string json_of(std::string_view event, const Fields& fields);
/// With a header line; `common` stands in front of each row.
std::string csv_of(const ResultTable& table, const Fields& common = {});
/// Columns with a title, aligned; with `keys` those of them alone, in that order.
std::string text_of(const ResultTable& table, const std::vector<std::string_view>& keys = {});
/// Returns one row alone, in columns as wide as its title or 8 characters (the first 16), so that rows can be
/// printed as they come; `row` is the head's if it is none.
std::string line_of(const ResultTable& table, std::optional<std::size_t> row);
/// A line a field, for a result of one row.
std::string text_of(const Fields& fields);

} // namespace pertev
