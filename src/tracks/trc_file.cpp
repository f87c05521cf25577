// Reads markers in text form (TRC).
#include <cmath>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "tracks/series.h"
#include "tracks/text_lines.h"

namespace predictor::tracks {
namespace {

class TrcReader {
 public:
  explicit TrcReader(const std::string& name) { file_.name = name; }

  SeriesFile Read(std::string_view text) {
    TextLines lines(text);
    for (std::string_view line; lines.Next(&line);) {
      line_ = lines.number();
      switch (line_) {
        case 1:
          if (!line.starts_with("PathFileType"))
            Fail("This is not a TRC file: it does not begin with PathFileType.");
          break;
        case 2:
          names_ = CellsOf(line, '\t');
          break;
        case 3:
          ReadSettings(CellsOf(line, '\t'));
          break;
        case 4:
          ReadMarkers(CellsOf(line, '\t'));
          break;
        case 5:  // X1, Y1, Z1, ...
          break;
        default:
          if (!Trimmed(line).empty()) ReadRow(CellsOf(line, '\t'));
      }
    }
    if (line_ < 5) Fail("The file ends within its header. Export it again.");
    if (times_.size() < 2) Fail("The file has fewer than two frames. Export it again.");
    const auto times = std::make_shared<const std::vector<double>>(std::move(times_));
    for (Series& series : file_.series) series.times = times;
    return std::move(file_);
  }

 private:
  [[noreturn]] void Fail(const std::string& sentence) const {
    throw InputError(LineOf(file_.name, line_), sentence);
  }

  void ReadSettings(const std::vector<std::string_view>& values) {
    for (std::size_t i = 0; i < std::min(names_.size(), values.size()); ++i) {
      if (names_[i] == "Units") unit_ = values[i];
      if (names_[i] == "DataRate") rate_ = NumberIn(values[i]).value_or(NAN);
    }
    LengthFactor(unit_, LineOf(file_.name, line_));
    if (!(rate_ > 0)) Fail("DataRate is missing or not a positive number.");
  }

  void ReadMarkers(const std::vector<std::string_view>& cells) {
    if (cells.size() < 3 || cells[0] != "Frame#" || cells[1] != "Time")
      Fail("This line must begin with Frame#, Time and the name of the first marker.");
    for (std::size_t i = 2; i < cells.size(); i += 3) {
      if (cells[i].empty()) continue;
      for (const char* axis : {".x", ".y", ".z"})
        file_.series.push_back({std::string(cells[i]) + axis, unit_, nullptr, {}});
    }
  }

  void ReadRow(const std::vector<std::string_view>& cells) {
    const std::size_t needed = 2 + file_.series.size();
    const auto frame = NumberIn(cells[0]);
    const auto time = cells.size() > 1 ? NumberIn(cells[1]) : std::nullopt;
    if (!frame || !time || !std::isfinite(*time) || !std::isfinite(*frame))
      Fail("Frame number and time are not numbers.");
    if (!times_.empty()) CheckClock(*frame, *time);
    frame_ = *frame;
    times_.push_back(*time);
    for (std::size_t i = 2; i < needed; ++i) {
      // Markers that are missing at the end of a line may be omitted.
      const auto value = i < cells.size() ? NumberIn(cells[i]) : NAN;
      if (!value)
        Fail("Marker " + Quote(file_.series[i - 2].name) + " is " + Quote(cells[i]) +
             ", which is not a number.");
      file_.series[i - 2].values.push_back(*value);
    }
  }

  // Frames have a constant rate, so a jump of the clock is noticed.
  void CheckClock(double frame, double time) const {
    const double step = time - times_.back(), expected = (frame - frame_) / rate_;
    if (!(frame > frame_) || !(step > 0))
      Fail(Formatted("The clock goes back from %.6g to %.6g s. Export the file again.",
                     times_.back(), time));
    constexpr double kRounding = 0.6;  // in frames: times are written with few digits
    if (std::abs(step - expected) > kRounding / rate_)
      Fail(
          Formatted("The clock jumps by %.4g s within %.0f frames at %.4g Hz. Export the file "
                    "again, or cut it at this place.",
                    step, frame - frame_, rate_));
  }

  SeriesFile file_;
  int line_ = 0;
  std::vector<std::string_view> names_;
  std::string unit_;
  double rate_ = NAN, frame_ = 0;
  std::vector<double> times_;
};

}  // namespace

SeriesFile ReadTrc(const std::filesystem::path& file) {
  const std::string text = ReadBytes(file);
  return TrcReader(file.string()).Read(text);
}

}  // namespace predictor::tracks
