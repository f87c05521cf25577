#include "ergonomics/limit_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace predictor::ergonomics {
namespace {

constexpr std::string_view kEdition = "edition";
constexpr std::size_t kMaxBytes = 1u << 20;

void CheckCount(const std::vector<std::string>& cells, std::string_view columns,
                const std::string& place) {
  const std::size_t count = CellsOf(columns).size();
  if (cells.size() != count)
    throw InputError(place, "this row has " + std::to_string(cells.size()) +
                                " values. Give one for each of the " + std::to_string(count) +
                                " columns: " + std::string(columns) + ".");
}

}  // namespace

LimitTable ParseLimitTable(const std::string& text, const std::string& name,
                           std::string_view columns) {
  LimitTable table;
  bool header = false;
  std::istringstream lines(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = name + ":" + std::to_string(++number);
    const std::string_view content = Trimmed(line);
    if (content.empty() || content.starts_with('#')) continue;
    const std::vector<std::string_view> views = CellsOf(content);
    const std::vector<std::string> cells(views.begin(), views.end());
    if (table.edition.empty()) {
      if (cells.size() < 2 || cells[0] != kEdition || cells[1].empty())
        throw InputError(place,
                         "the file does not name its edition. Begin the file with a line such as "
                         "\"edition,ISO/TS 15066:2016 Annex A\".");
      table.edition = std::string(Trimmed(content.substr(content.find(',') + 1)));
    } else if (!header) {
      if (Join(cells, ",") != columns)
        throw InputError(place, "the header is " + Quote(content) + "; it must be " +
                                    std::string(columns) + ".");
      header = true;
    } else {
      CheckCount(cells, columns, place);
      table.rows.push_back({place, cells});
    }
  }
  if (table.rows.empty())
    throw InputError(name, "the file contains no limits. Give the edition, then the header " +
                               std::string(columns) + ", then a row for each limit.");
  return table;
}

std::string ReadLimitFile(const std::filesystem::path& file) {
  const std::string text = ReadWholeFile(file, kMaxBytes + 1);
  if (text.size() > kMaxBytes)
    throw InputError(file.string(), "the file is larger than 1 MiB. Give a table of limits.");
  return text;
}

double NumberInCell(const std::string& cell, std::string_view name, double least, bool or_equal,
                    const std::string& place) {
  double x = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
  const bool number = error == std::errc() && end == cell.data() + cell.size() && std::isfinite(x);
  if (!number || x < least || (x == least && !or_equal))
    throw InputError(place, std::string(name) + " is " + Quote(cell) + ". Give a number " +
                                (or_equal ? "of at least " : "above ") + FormatNumber(least) +
                                ", with a point and without a unit.");
  return x;
}

}  // namespace predictor::ergonomics
