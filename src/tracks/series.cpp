#include "tracks/series.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <span>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "tracks/ros_messages.h"

namespace predictor::tracks {
namespace {

using Factors = std::map<std::string, double>;

double FactorOf(const Factors& factors, const char* kind, const std::string& unit,
                const std::string& what) {
  const auto found = factors.find(unit);
  if (found != factors.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, factor] : factors) names.push_back(name);
  throw InputError(
      what, Quote(unit) + " is not a known unit of " + kind + ". Known are: " + Join(names) + ".");
}

}  // namespace

const Series* SeriesFile::Find(const std::string& channel) const {
  const auto found = std::ranges::find(series, channel, &Series::name);
  return found == series.end() ? nullptr : &*found;
}

const Series& SeriesFile::At(const std::string& channel) const {
  if (const Series* found = Find(channel)) return *found;
  std::vector<std::string> names;
  for (const Series& one : series) names.push_back(one.name);
  const std::string nearest = Nearest(channel, names);
  constexpr std::size_t kShown = 12;
  const std::string remedy =
      nearest.empty()
          ? "The file has " +
                Join({names.begin(), names.begin() + static_cast<std::ptrdiff_t>(
                                                         std::min(kShown, names.size()))}) +
                (names.size() > kShown ? ", …" : "") + "."
          : "Did you mean " + nearest + "?";
  throw InputError(name, "There is no channel " + Quote(channel) + ". " + Printable(remedy));
}

std::string ReadBytes(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || !std::filesystem::is_regular_file(file))
    throw InputError(file.string(), "The file cannot be read. Check its name.");
  if (size == 0) throw InputError(file.string(), "The file is empty.");
  if (size > kMaxFileBytes)
    throw InputError(file.string(), "The file has more than " +
                                        std::to_string(kMaxFileBytes >> 20U) +
                                        " MiB. Export a shorter part of the measurement.");
  return ReadWholeFile(file, size);
}

SeriesFile ReadSeries(const std::filesystem::path& file, const TimeColumn& time) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".csv" || ending == ".tsv" || ending == ".txt") return ReadCsv(file, time);
  if (ending == ".trc") return ReadTrc(file);
  if (ending == ".c3d") return ReadC3d(file);
  if (ending == ".mcap" || ending == ".db3" || std::filesystem::is_directory(file))
    return ReadRosBag(file, time.name == "received" ? MessageTime::kReceived : MessageTime::kStamp);
  throw InputError(file.string(),
                   "Files of this kind cannot be read. Give a table (.csv), markers "
                   "(.trc, .c3d) or a ROS 2 bag (.mcap, .db3).");
}

double LengthFactor(const std::string& unit, const std::string& what) {
  static const Factors kUnits = {
      {"m", 1}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}};
  return FactorOf(kUnits, "length", unit, what);
}

double TimeFactor(const std::string& unit, const std::string& what) {
  static const Factors kUnits = {{"s", 1},     {"ms", 1e-3}, {"us", 1e-6},
                                 {"µs", 1e-6}, {"ns", 1e-9}, {"min", 60}};
  return FactorOf(kUnits, "time", unit, what);
}

double ForceFactor(const std::string& unit, const std::string& what) {
  static const Factors kUnits = {{"N", 1}, {"kN", 1e3}, {"mN", 1e-3}, {"lbf", 4.4482216152605}};
  return FactorOf(kUnits, "force", unit, what);
}

double TorqueFactor(const std::string& unit, const std::string& what) {
  static const Factors kUnits = {{"N m", 1},     {"N·m", 1},     {"Nm", 1},
                                 {"N mm", 1e-3}, {"N·mm", 1e-3}, {"Nmm", 1e-3}};
  return FactorOf(kUnits, "torque", unit, what);
}

}  // namespace predictor::tracks
