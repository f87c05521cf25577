// Reads tables of limits that a user copies from a standard: a line that names the edition, a line
// that names the columns, and a row for each limit. Cells are separated by commas. Lines that begin
// with # are comments.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace predictor::ergonomics {

struct LimitRow {
  std::string place;               // "FILE:LINE", for messages
  std::vector<std::string> cells;  // as many as there are columns
};

struct LimitTable {
  std::string edition;
  std::vector<LimitRow> rows;  // at least one
};

// `columns` is the header that the file must have. `name` is the file for messages. Throws
// InputError with file and line.
LimitTable ParseLimitTable(const std::string& text, const std::string& name,
                           std::string_view columns);

// Returns the contents of a file of at most 1 MiB. Throws InputError.
std::string ReadLimitFile(const std::filesystem::path& file);

// Returns the number in a cell of the column `name`. `least` is its smallest allowed value; without
// `or_equal`, it must be larger. Throws InputError.
double NumberInCell(const std::string& cell, std::string_view name, double least, bool or_equal,
                    const std::string& place);

}  // namespace predictor::ergonomics
