// Reads binary points and analog channels (C3D). The layout is described at
// https://www.c3d.org/HTML/default.htm.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>

#include "core/error.h"
#include "core/text.h"
#include "tracks/series.h"

namespace predictor::tracks {
namespace {

constexpr std::size_t kBlock = 512;
constexpr int kIntel = 84;

// A parameter with its numbers or its texts. The first entry of `dims` belongs to the fastest
// index.
struct Parameter {
  std::vector<double> numbers;
  std::vector<std::string> texts;
};

std::string Unpadded(std::string_view text) {
  const std::size_t end = text.find_last_not_of(std::string_view(" \0", 2));
  return std::string(text.substr(0, end == std::string_view::npos ? 0 : end + 1));
}

class C3dReader {
 public:
  C3dReader(const std::string& name, std::string_view bytes) : bytes_(bytes) { file_.name = name; }

  SeriesFile Read() {
    if (bytes_.size() < 2 * kBlock || static_cast<unsigned char>(bytes_[1]) != 0x50)
      Fail("This is not a C3D file.");
    ReadParameters((Byte(0) - 1) * kBlock);
    ReadSettings();
    AddPoints();
    AddAnalogs();
    ReadFrames();
    return std::move(file_);
  }

 private:
  [[noreturn]] void Fail(const std::string& sentence) const {
    throw InputError(file_.name, sentence);
  }
  template <class T>
  T Get(std::size_t at) const {
    if (at > bytes_.size() || bytes_.size() - at < sizeof(T)) Fail("The file is cut off.");
    T value;
    std::memcpy(&value, bytes_.data() + at, sizeof(T));
    return value;
  }
  std::size_t Byte(std::size_t at) const { return Get<std::uint8_t>(at); }
  std::string_view Text(std::size_t at, std::size_t n) const {
    if (at > bytes_.size() || bytes_.size() - at < n) Fail("The file is cut off.");
    return bytes_.substr(at, n);
  }

  void ReadParameters(std::size_t start) {
    const int processor = static_cast<int>(Byte(start + 3));
    if (processor != kIntel)
      Fail("The file has the byte order of another kind of computer (" + std::to_string(processor) +
           "). Save the file again on a PC (Intel).");
    std::map<int, std::string> groups;
    std::map<std::pair<int, std::string>, Parameter> found;
    for (std::size_t at = start + 4;;) {
      const auto length = static_cast<std::size_t>(std::abs(int{Get<std::int8_t>(at)}));
      const int id = Get<std::int8_t>(at + 1);
      if (length == 0 || id == 0) break;
      std::string name(Text(at + 2, length));
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
      const std::size_t link = at + 2 + length;
      const std::size_t next = Get<std::uint16_t>(link);
      if (id < 0)
        groups[-id] = name;
      else
        found[{id, name}] = ReadParameter(link + 2);
      if (next == 0) break;
      at = link + next;
    }
    for (auto& [key, parameter] : found)
      parameters_[groups[key.first] + ":" + key.second] = std::move(parameter);
  }

  Parameter ReadParameter(std::size_t at) const {
    const int type = Get<std::int8_t>(at);
    const std::size_t dimensions = Byte(at + 1);
    std::size_t count = 1, first = 1;
    for (std::size_t d = 0; d < dimensions; ++d) {
      const std::size_t n = Byte(at + 2 + d);
      if (d == 0) first = n;
      count *= n;
      if (count > bytes_.size()) Fail("A parameter is larger than the file.");
    }
    const std::size_t data = at + 2 + dimensions;
    Parameter parameter;
    if (type == -1) {
      for (std::size_t i = 0; first > 0 && i < count; i += first)
        parameter.texts.push_back(Unpadded(Text(data + i, first)));
      return parameter;
    }
    for (std::size_t i = 0; i < count; ++i)
      parameter.numbers.push_back(type == 1   ? static_cast<double>(Byte(data + i))
                                  : type == 2 ? static_cast<double>(Get<std::int16_t>(data + 2 * i))
                                              : double{Get<float>(data + 4 * i)});
    return parameter;
  }

  double Number(const std::string& name, std::size_t i = 0) const {
    const auto found = parameters_.find(name);
    return found == parameters_.end() || i >= found->second.numbers.size()
               ? kMissing
               : found->second.numbers[i];
  }
  // The format stores whole numbers up to 65535 in signed 16-bit numbers.
  std::size_t Unsigned(const std::string& name, std::size_t i = 0) const {
    const double x = Number(name, i);
    return x >= 0 ? static_cast<std::size_t>(x) : x < 0 ? static_cast<std::size_t>(x + 65536) : 0;
  }
  // Returns the texts of NAME, NAME2, NAME3, ...
  std::vector<std::string> Texts(const std::string& name) const {
    std::vector<std::string> all;
    for (int i = 1; i < 100; ++i) {
      const auto found = parameters_.find(name + (i == 1 ? "" : std::to_string(i)));
      if (found == parameters_.end()) break;
      all.insert(all.end(), found->second.texts.begin(), found->second.texts.end());
    }
    return all;
  }

  void ReadSettings() {
    points_ = Unsigned("POINT:USED");
    scale_ = Number("POINT:SCALE");
    rate_ = Number("POINT:RATE");
    data_ = (Unsigned("POINT:DATA_START") - 1) * kBlock;
    if (points_ == 0) Fail("The file has no points.");
    if (!std::isfinite(scale_) || scale_ == 0 || !(rate_ > 0))
      Fail("POINT:SCALE or POINT:RATE is missing.");
    const auto first = Get<std::uint16_t>(6), last = Get<std::uint16_t>(8);
    frames_ = last >= first ? std::size_t{last} - first + 1 : 0;
    // 16 bits are not sufficient for long recordings.
    const auto actual = [this](const char* name) {
      return static_cast<double>(Unsigned(name)) + 65536 * static_cast<double>(Unsigned(name, 1));
    };
    if (last == 65535 && parameters_.contains("TRIAL:ACTUAL_END_FIELD"))
      frames_ = static_cast<std::size_t>(
          std::max(0.0, actual("TRIAL:ACTUAL_END_FIELD") - actual("TRIAL:ACTUAL_START_FIELD") + 1));
    number_bytes_ = scale_ < 0 ? 4 : 2;
    const std::size_t analogs = Unsigned("ANALOG:USED");
    if (analogs > 0) {
      per_frame_ = static_cast<std::size_t>(std::lround(Number("ANALOG:RATE") / rate_));
      if (per_frame_ == 0 || per_frame_ * analogs != Get<std::uint16_t>(4))
        Fail("The header and the parameters disagree about the number of analog values per frame.");
      analogs_ = analogs;
    }
    const std::size_t frame = number_bytes_ * (4 * points_ + per_frame_ * analogs_);
    if (data_ < kBlock || data_ > bytes_.size() || (bytes_.size() - data_) / frame < frames_)
      Fail("The file is truncated: it has fewer frames than its header states. Export it again.");
    if (frames_ < 2) Fail("The file has fewer than two frames.");
  }

  std::shared_ptr<const std::vector<double>> Times(std::size_t count, double rate) const {
    std::vector<double> times;
    times.reserve(count);
    for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<double>(i) / rate);
    return std::make_shared<const std::vector<double>>(std::move(times));
  }

  void AddPoints() {
    const std::vector<std::string> labels = Texts("POINT:LABELS"), units = Texts("POINT:UNITS");
    const std::string unit = units.empty() ? "" : units.front();
    const auto times = Times(frames_, rate_);
    for (std::size_t k = 0; k < points_; ++k) {
      const std::string name =
          k < labels.size() && !labels[k].empty() ? labels[k] : "point" + std::to_string(k + 1);
      for (const char* axis : {".x", ".y", ".z"})
        file_.series.push_back({name + axis, unit, times, {}});
    }
  }

  void AddAnalogs() {
    if (analogs_ == 0) return;
    const std::vector<std::string> labels = Texts("ANALOG:LABELS"), units = Texts("ANALOG:UNITS");
    const auto times = Times(frames_ * per_frame_, rate_ * static_cast<double>(per_frame_));
    for (std::size_t k = 0; k < analogs_; ++k)
      file_.series.push_back(
          {k < labels.size() && !labels[k].empty() ? labels[k] : "analog" + std::to_string(k + 1),
           k < units.size() ? units[k] : "",
           times,
           {}});
  }

  double Value(std::size_t at) const {
    return scale_ < 0 ? double{Get<float>(at)} : static_cast<double>(Get<std::int16_t>(at));
  }

  void ReadFrames() {
    const double scale = scale_ < 0 ? 1 : scale_;
    const double general =
        std::isfinite(Number("ANALOG:GEN_SCALE")) ? Number("ANALOG:GEN_SCALE") : 1;
    std::size_t at = data_;
    for (std::size_t f = 0; f < frames_; ++f) {
      for (std::size_t k = 0; k < points_; ++k, at += 4 * number_bytes_) {
        // A negative residual marks a point that the cameras did not see.
        const bool seen = Value(at + 3 * number_bytes_) >= 0;
        for (std::size_t i = 0; i < 3; ++i) {
          const double x = scale * Value(at + i * number_bytes_);
          file_.series[3 * k + i].values.push_back(seen && std::isfinite(x) ? x : kMissing);
        }
      }
      for (std::size_t s = 0; s < per_frame_; ++s)
        for (std::size_t k = 0; k < analogs_; ++k, at += number_bytes_) {
          const double offset = Number("ANALOG:OFFSET", k), factor = Number("ANALOG:SCALE", k);
          file_.series[3 * points_ + k].values.push_back(
              (Value(at) - (std::isfinite(offset) ? offset : 0)) *
              (std::isfinite(factor) ? factor : 1) * general);
        }
    }
  }

  std::string_view bytes_;
  SeriesFile file_;
  std::map<std::string, Parameter> parameters_;  // "POINT:RATE"
  std::size_t points_ = 0, analogs_ = 0, per_frame_ = 0, frames_ = 0, data_ = 0, number_bytes_ = 4;
  double scale_ = 0, rate_ = 0;
};

}  // namespace

SeriesFile ReadC3d(const std::filesystem::path& file) {
  const std::string bytes = ReadBytes(file);
  return C3dReader(file.string(), bytes).Read();
}

}  // namespace predictor::tracks
