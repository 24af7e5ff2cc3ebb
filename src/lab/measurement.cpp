#include "lab/measurement.h"

#include <algorithm>
#include <chrono>
#include <fstream>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json_text.h"
#include "base/parallel_for.h"
#include "base/processor_name.h"
#include "base/shell_word.h"
#include "base/version.h"
#include "device/device_identity.h"
#include "image/write_png.h"

namespace pertev {
namespace {

std::size_t characters(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

enum class Align { Left, Right };

/// Returns a line for each row. The first column is aligned left; each column is as wide as its longest cell (in UTF-8
/// characters), with two blanks between columns.
std::string align_columns(const std::vector<std::vector<std::string>>& rows, Align others = Align::Right) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], characters(row[i]));
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string pad(widths[i] - characters(row[i]), ' ');
            line += (i == 0 ? "" : "  ") + (i == 0 || others == Align::Left ? row[i] + pad : pad + row[i]);
        }
        line.erase(line.find_last_not_of(' ') + 1); // npos + 1 is 0, so a line of blanks becomes empty
        text += line + '\n';
    }
    return text;
}

template <class All, class Text>
std::string json_list(const All& all, const Text& text) {
    std::string list;
    for (const auto& one : all) list += (list.empty() ? "" : ",") + text(one);
    return '[' + list + ']';
}

std::string text_or_null(const std::string& text) { return text.empty() ? "null" : json_string(text); }

/// Encodes bytes in base64 (RFC 4648, section 4).
std::string base64(const std::vector<std::byte>& bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t k) { return k < bytes.size() ? std::to_integer<uint32_t>(bytes[k]) : 0u; };
        const uint32_t bits = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string json_of(const Rgba8Image& image) {
    return image.pixels.empty() ? "null" : "\"data:image/png;base64," + base64(encode_png(image)) + '"';
}

std::string json_of(const ResultPicture& p, bool has_images) {
    return fmt::format(R"({{"group":{},"title":{},"caption":{},"file":{},"exr":{}{}}})", json_string(p.group),
                       json_string(p.title), json_string(p.caption), text_or_null(p.file), text_or_null(p.exr),
                       has_images ? fmt::format(R"(,"image":{},"error":{},"svg":{})", json_of(p.image),
                                                json_of(p.error), text_or_null(p.svg))
                                  : "");
}

std::string json_of(const ResultTable& table) {
    const auto column = [](const ResultTable::Column& c) {
        return fmt::format(R"({{"key":{},"title":{},"unit":{}}})", json_string(c.key),
                           json_string(c.title.empty() ? c.key : c.title), json_string(c.unit));
    };
    const auto row = [](const std::vector<ResultCell>& cells) {
        return json_list(cells, [](const ResultCell& c) { return c.json(); });
    };
    return fmt::format(R"({{"name":{},"title":{},"columns":{},"rows":{}}})", json_string(table.name),
                       json_string(table.title), json_list(table.columns, column), json_list(table.rows, row));
}

/// Returns the command line of this process, quoted where a shell would split it.
std::string command_line() {
    std::ifstream words("/proc/self/cmdline");
    std::string line;
    for (std::string word; std::getline(words, word, '\0');) line += (line.empty() ? "" : " ") + shell_word(word);
    return line;
}

} // namespace

std::string ResultCell::json() const {
    if (const auto* number = std::get_if<int64_t>(&value_)) return fmt::format("{}", *number);
    if (const auto* number = std::get_if<double>(&value_)) return json_number(*number);
    if (const auto* text = std::get_if<std::string>(&value_)) return json_string(*text);
    if (const auto* truth = std::get_if<bool>(&value_)) return *truth ? "true" : "false";
    if (const auto* raw = std::get_if<Raw>(&value_)) return raw->json;
    return "null";
}

std::optional<double> ResultCell::number() const {
    const auto* number = std::get_if<double>(&value_);
    return number != nullptr ? std::optional(*number) : std::nullopt;
}

std::string ResultCell::csv() const {
    if (const auto* truth = std::get_if<bool>(&value_)) return *truth ? "1" : "0";
    const auto* said = std::get_if<std::string>(&value_);
    const std::string text = said != nullptr ? *said : json();
    if (said == nullptr && text == "null") return {};
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

std::string ResultCell::text(const std::string& format) const {
    if (const auto* text = std::get_if<std::string>(&value_)) return *text;
    if (const auto* number = std::get_if<int64_t>(&value_)) return fmt::format("{}", *number);
    if (const auto* truth = std::get_if<bool>(&value_)) return *truth ? "yes" : "no";
    const auto* number = std::get_if<double>(&value_);
    if (number == nullptr) return is_there() ? json() : "-";
    const std::string text = fmt::format(fmt::runtime(format.empty() ? "{:.4g}" : format), *number);
    const bool is_lost = *number != 0 && text.find_first_of("123456789") == std::string::npos; // 0.00003 is not "0.000"
    return is_lost ? fmt::format("{:.2g}", *number) : text;
}

void ResultTable::add(const Fields& fields) {
    if (columns.empty()) {
        for (const ResultField& f : fields) columns.push_back({f.key, f.title, f.unit, f.format});
    }
    PERTEV_CHECK(fields.size() == columns.size());
    std::vector<ResultCell>& row = rows.emplace_back();
    for (const ResultField& f : fields) row.push_back(f.value);
}

const ResultTable::Column& ResultTable::column(std::string_view key) const {
    const auto found = std::ranges::find(columns, key, &Column::key);
    PERTEV_CHECK(found != columns.end());
    return *found;
}

const ResultCell& ResultTable::at(std::size_t row, std::string_view key) const {
    PERTEV_CHECK(row < rows.size());
    return rows[row][static_cast<std::size_t>(&column(key) - columns.data())];
}

const ResultTable& Measurement::table(std::string_view name) const {
    const auto found = std::ranges::find(tables, name, &ResultTable::name);
    PERTEV_CHECK(found != tables.end());
    return *found;
}

Measurement start_measurement(const Queue& queue, std::string title) {
    Measurement m = {.title = std::move(title), .program = fmt::format("pertev {} {}", version(), git_commit())};
    const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
    m.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
    m.command = command_line();
    m.processor = processor_name();
    m.threads = static_cast<uint32_t>(thread_count());
    if (!queue.is_cuda()) return m;
    m.device = queue.device_name();
    m.driver = driver_version();
    return m;
}

std::string json_of(const Measurement& m, std::string_view event, bool has_images) {
    return fmt::format(
        R"({{{}"format":"pertev-measurement","version":1,"kind":{},"title":{},"program":{},"date":{},"command":{},"processor":{},"threads":{},"device":{},"driver":{},"interrupted":{},"tables":{},"notes":{},"pictures":{}}})",
        event.empty() ? "" : fmt::format(R"("event":"{}",)", event), text_or_null(m.kind), json_string(m.title),
        json_string(m.program), json_string(m.date), json_string(m.command), text_or_null(m.processor), m.threads,
        text_or_null(m.device), text_or_null(m.driver), m.interrupted,
        json_list(m.tables, [](const ResultTable& t) { return json_of(t); }), json_strings(m.notes),
        json_list(m.pictures, [&](const ResultPicture& p) { return json_of(p, has_images); }));
}

std::string json_of(std::string_view event, const Fields& fields) {
    std::string members;
    if (!event.empty()) members = fmt::format(R"("event":"{}")", event);
    for (const ResultField& f : fields) {
        members += fmt::format(R"({}"{}":{})", members.empty() ? "" : ",", f.key, f.value.json());
    }
    return '{' + members + '}';
}

std::string csv_of(const Measurement& m, std::string_view name) {
    const ResultTable& table = m.table(name);
    std::vector<std::string> head = {"program", "date", "processor", "threads", "device"}, common;
    for (const ResultCell& cell : {ResultCell(m.program), ResultCell(m.date), ResultCell(m.processor),
                                   ResultCell(m.threads), ResultCell(m.device.empty() ? "CPU" : m.device)}) {
        common.push_back(cell.csv());
    }
    const auto scene = std::ranges::find(m.tables, "scene", &ResultTable::name);
    if (scene != m.tables.end()) {
        for (const ResultTable::Column& column : scene->columns) head.push_back(column.key);
        for (const ResultCell& cell : scene->rows.front()) common.push_back(cell.csv());
    }
    for (const ResultTable::Column& column : table.columns) head.push_back(column.key);
    std::string csv = fmt::format("{}\n", fmt::join(head, ","));
    for (const std::vector<ResultCell>& row : table.rows) {
        std::vector<std::string> cells = common;
        for (const ResultCell& cell : row) cells.push_back(cell.csv());
        csv += fmt::format("{}\n", fmt::join(cells, ","));
    }
    return csv;
}

ResultTable pivot(const ResultTable& table, std::string_view row, std::string_view across, std::string_view y) {
    ResultTable made = {table.name, table.title, {table.column(row)}};
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        if (!table.at(i, across).is_there() || !table.at(i, y).is_there()) continue;
        const std::string title = table.at(i, across).text("");
        const auto column =
            std::ranges::find(made.columns.begin() + 1, made.columns.end(), title, &ResultTable::Column::key);
        const auto at = static_cast<std::size_t>(column - made.columns.begin());
        if (at == made.columns.size()) made.columns.push_back({title, title, "", table.column(y).format});
        auto found = std::ranges::find(made.rows, table.at(i, row), [](const auto& cells) { return cells.front(); });
        if (found == made.rows.end()) found = made.rows.insert(found, {table.at(i, row)});
        found->resize(std::max(found->size(), at + 1));
        (*found)[at] = table.at(i, y);
    }
    for (std::vector<ResultCell>& cells : made.rows) cells.resize(made.columns.size());
    return made;
}

std::string text_of(const ResultTable& table) {
    std::vector<std::vector<std::string>> lines(1 + table.rows.size());
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const ResultTable::Column& column = table.columns[i];
        if (column.title.empty()) continue;
        lines[0].push_back(column.unit.empty() ? column.title : column.title + ' ' + column.unit);
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            lines[row + 1].push_back(table.rows[row][i].text(column.format));
        }
    }
    return align_columns(lines);
}

std::string line_of(const ResultTable& table, std::optional<std::size_t> row) {
    std::string line;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const ResultTable::Column& column = table.columns[i];
        if (column.title.empty()) continue;
        const std::string title = column.unit.empty() ? column.title : column.title + ' ' + column.unit;
        const std::string text = row ? table.rows[*row][i].text(column.format) : title;
        line += line.empty() ? fmt::format("{:16}", text)
                             : fmt::format(" {:>{}}", text, std::max<std::size_t>(title.size(), 8));
    }
    return line + '\n';
}

std::string text_of(const Fields& fields) {
    std::vector<std::vector<std::string>> lines;
    for (const ResultField& f : fields) {
        if (*f.title == '\0' || !f.value.is_there()) continue;
        const std::string value = f.value.text(f.format);
        lines.push_back({f.title, *f.unit != '\0' ? value + ' ' + f.unit : value});
    }
    return align_columns(lines, Align::Left);
}

} // namespace pertev
