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

    std::optional<double> number() const;
    bool is_there() const { return !std::holds_alternative<std::monostate>(value_); }
    bool operator==(const ResultCell&) const = default;
    std::string json() const;
    /// Returns the value for CSV (RFC 4180): quoted if necessary, true as 1.
    std::string csv() const;
    /// Returns the value for a terminal; "-" if there is none. `format` is that of a number, "" for the usual one.
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

/// A value with its column.
struct ResultField {
    const char* key;
    const char* title; // for people; empty: the page shows the key, and a terminal leaves the column out
    ResultCell value;
    const char* unit = "";
    const char* format = ""; // fmt's format for numbers on a terminal
};
using Fields = std::vector<ResultField>;
/// Returns the fields of both, one after the other.
inline Fields operator+(Fields first, const Fields& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

struct ResultTable {
    struct Column {
        std::string key, title, unit, format;
    };
    std::string name, title;
    std::vector<Column> columns = {};
    std::vector<std::vector<ResultCell>> rows = {};

    /// Appends a row. The first row defines the columns, which all other rows must have.
    void add(const Fields& fields);
    /// Returns the column with this key. Throws Error(DeviceFault) if there is none.
    const Column& column(std::string_view key) const;
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

/// Starts a measurement: fills in the program, machine, device of `queue`, date and command line.
Measurement start_measurement(const Queue& queue, std::string title);

/// Returns the measurement as a JSON object, which begins with the member "event" unless `event` is empty. With
/// `has_images` pictures carry their bytes, as a page needs them.
std::string json_of(const Measurement& measurement, std::string_view event = "", bool has_images = false);
/// Returns a row as a JSON object, which begins with the member "event" unless `event` is empty.
std::string json_of(std::string_view event, const Fields& fields);
/// Returns a table of the measurement as CSV with a header line. Each row begins with program, date, processor, threads
/// and device, and with the row of the table "scene" if there is such a table.
std::string csv_of(const Measurement& measurement, std::string_view table);
/// Returns the values of column `y`, with a row for each value of column `row` and a column for each value of column
/// `across`, in the order in which they appear. Rows without the latter are left out.
ResultTable pivot(const ResultTable& table, std::string_view row, std::string_view across, std::string_view y);
/// Returns the columns with a title, aligned.
std::string text_of(const ResultTable& table);
/// Returns one row, or the titles if `row` is nothing, in columns as wide as their titles but at least 8 characters
/// (the first 16), so that rows can be printed as they come.
std::string line_of(const ResultTable& table, std::optional<std::size_t> row);
/// Returns a line per field with a title, for a result of one row.
std::string text_of(const Fields& fields);

} // namespace pertev
