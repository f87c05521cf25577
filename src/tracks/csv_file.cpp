// Reads tables.
#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "tracks/series.h"
#include "tracks/text_lines.h"

namespace predictor::tracks {
namespace {

constexpr std::size_t kMaxColumns = 2000;

// Parses "name [unit]".
Series HeadOf(std::string_view cell) {
  Series series;
  const std::size_t open = cell.rfind(" [");
  if (cell.ends_with(']') && open != std::string_view::npos) {
    series.unit = cell.substr(open + 2, cell.size() - open - 3);
    cell = cell.substr(0, open);
  }
  series.name = cell;
  return series;
}

char SeparatorOf(std::string_view header) {
  char best = ',';
  for (const char c : {';', '\t'})
    if (std::ranges::count(header, c) > std::ranges::count(header, best)) best = c;
  return best;
}

class CsvReader {
 public:
  CsvReader(const std::string& name, const TimeColumn& time) : time_(time) { file_.name = name; }

  SeriesFile Read(std::string_view text) {
    TextLines lines(text);
    for (std::string_view line; lines.Next(&line);) {
      line_ = lines.number();
      if (Trimmed(line).empty()) continue;
      if (file_.series.empty() && line.starts_with('#'))
        file_.comments.emplace_back(line.substr(1));
      else
        ReadLine(line);
    }
    return Finish();
  }

 private:
  [[noreturn]] void Fail(const std::string& sentence) const {
    throw InputError(LineOf(file_.name, line_), sentence);
  }

  // Some programs write the names of the columns as a comment.
  void ReadLine(std::string_view line) {
    if (!file_.series.empty()) return ReadRow(line);
    separator_ = SeparatorOf(line);
    const std::vector<std::string_view> cells = CellsOf(line, separator_);
    if (!std::ranges::all_of(cells,
                             [](std::string_view cell) { return NumberIn(cell).has_value(); }))
      return ReadHeader(line);
    const std::string names = file_.comments.empty() ? "" : file_.comments.back();
    if (names.empty() || CellsOf(names, separator_).size() != cells.size())
      Fail("The first line has only numbers. Insert a line before it that names the columns.");
    file_.comments.pop_back();
    ReadHeader(names);
    ReadRow(line);
  }

  void ReadHeader(std::string_view line) {
    separator_ = SeparatorOf(line);
    for (const std::string_view cell : CellsOf(line, separator_))
      file_.series.push_back(HeadOf(cell));
    if (file_.series.size() < 2 || file_.series.size() > kMaxColumns)
      Fail("The first line has " + std::to_string(file_.series.size()) +
           " columns. Give a table whose first line names its columns, which must be time and at "
           "least one other column.");
    words_.assign(file_.series.size(), false);
    if (time_.rate > 0) return;
    const auto is_time = [this](const Series& s) {
      if (!time_.name.empty()) return s.name == time_.name;
      std::string lower = s.name;
      std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
      return lower == "time" || lower == "timestamp";
    };
    const auto found = std::ranges::find_if(file_.series, is_time);
    if (found == file_.series.end())
      Fail(time_.name.empty()
               ? "No column is called time. Name the column of the times in the mapping (time), or "
                 "give the rate of the rows (rate)."
               : "There is no column " + Quote(time_.name) + ", which the mapping names as time.");
    time_at_ = static_cast<std::size_t>(found - file_.series.begin());
    const std::string unit = !time_.unit.empty() ? time_.unit : found->unit;
    factor_ = TimeFactor(unit.empty() ? "s" : unit, LineOf(file_.name, line_));
  }

  void ReadRow(std::string_view line) {
    const std::vector<std::string_view> cells = CellsOf(line, separator_);
    if (cells.size() != file_.series.size())
      Fail("This row has " + std::to_string(cells.size()) + " cells; the header has " +
           std::to_string(file_.series.size()) + ".");
    const double now = TimeOf(cells);
    if (!times_.empty() && now < times_.back())
      Fail(
          Formatted("The clock goes back from %.6g to %.6g s. Cut the file at this place, or "
                    "export it again.",
                    times_.back(), now));
    if (!times_.empty() && now == times_.back()) {
      ++repeated_;
      return;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) AddCell(i, cells[i]);
    times_.push_back(now);
  }

  double TimeOf(const std::vector<std::string_view>& cells) const {
    if (time_.rate > 0) return static_cast<double>(times_.size()) / time_.rate;
    const std::optional<double> time = NumberIn(cells[time_at_]);
    if (!time || !(*time - *time == 0))
      Fail("The time is " + Quote(cells[time_at_]) + ", which is not a number.");
    return factor_ * *time;
  }

  void AddCell(std::size_t i, std::string_view cell) {
    Series& series = file_.series[i];
    const std::optional<double> value = NumberIn(cell);
    if (!value && !words_[i]) {
      // In a column of words, the first cell that is not empty must contain a word.
      if (std::ranges::any_of(series.values, [](double x) { return x - x == 0; }))
        Fail("Column " + Quote(series.name) + " has " + Quote(cell) + ", which is not a number.");
      words_[i] = true;
    }
    series.values.push_back(value.value_or(0));
  }

  SeriesFile Finish() {
    if (file_.series.empty()) throw InputError(file_.name, "The file has no table.");
    if (times_.size() < 2)
      throw InputError(file_.name, "The table has " + std::to_string(times_.size()) +
                                       " rows; at least two are needed.");
    const auto times = std::make_shared<const std::vector<double>>(std::move(times_));
    std::vector<Series> kept;
    for (std::size_t i = 0; i < file_.series.size(); ++i) {
      if (words_[i] || (time_.rate == 0 && i == time_at_)) continue;
      kept.push_back(std::move(file_.series[i]));
      kept.back().times = times;
    }
    file_.series = std::move(kept);
    if (repeated_ > 0)
      file_.warnings.push_back(std::to_string(repeated_) +
                               " rows repeat the time of the previous row and are left out.");
    return std::move(file_);
  }

  TimeColumn time_;
  SeriesFile file_;
  int line_ = 0;
  char separator_ = ',';
  std::size_t time_at_ = 0;
  double factor_ = 1;
  std::vector<double> times_;
  std::vector<bool> words_;
  std::size_t repeated_ = 0;
};

}  // namespace

SeriesFile ReadCsv(const std::filesystem::path& file, const TimeColumn& time) {
  const std::string text = ReadBytes(file);
  return CsvReader(file.string(), time).Read(text);
}

}  // namespace predictor::tracks
