#include "analysis/hazard_study/run_store.h"

#include <charconv>
#include <span>
#include <sstream>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor {
namespace {

constexpr const char* kHeader =
    "key,scenario,controller,hazard,seed,begin_s,force_before_N,force_after_N,torque_Nm,speed_m_s,"
    "until_stop_s,cause,detection_s,travel_m,cobot_stop,excess_N,"
    "clear_detection_s,commanded_share";
constexpr std::size_t kColumns = 18, kOfRun = 14;  // in all, and those of TextOf

std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

bool ReadNumber(const std::string& text, double* x) {
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, *x);
  return error == std::errc() && last == end;
}

// Returns the value of the enumeration whose name is `name`.
template <class E>
bool ReadName(const std::string& name, int count, E* value) {
  for (int k = 0; k < count; ++k) {
    *value = static_cast<E>(k);
    if (name == Name(*value)) return true;
  }
  return false;
}

std::string Short(double x) { return Formatted("%.6g", x); }

std::string KeyOf(const std::string& key, const std::string& seed) { return key + "/" + seed; }

// Reads the last cells of the row, which TextOf wrote. If a name before these cells contains a
// comma, the row has an additional cell.
bool ReadRun(const std::vector<std::string>& cells, HazardRun* run) {
  if (cells.size() < kColumns) return false;
  const std::span at = std::span(cells).last(kOfRun);
  double seed = 0;
  bool read = ReadNumber(at[0], &seed);
  double* const numbers[] = {&run->begin,  &run->before, &run->after,
                             &run->torque, &run->speed,  &run->until_stop};
  for (std::size_t k = 0; read && k < std::size(numbers); ++k)
    read = ReadNumber(at[1 + k], numbers[k]);
  run->seed = static_cast<std::uint64_t>(seed);
  return read && ReadName(at[7], kStopCauses, &run->cause) && ReadNumber(at[8], &run->detection) &&
         ReadNumber(at[9], &run->travel) && ReadName(at[10], kCobotStops, &run->cobot_stop) &&
         ReadNumber(at[11], &run->excess) && ReadNumber(at[12], &run->clear_detection) &&
         ReadNumber(at[13], &run->commanded);
}

}  // namespace

std::string TextOf(const HazardRun& run) {
  return Join({std::to_string(run.seed), Short(run.begin), Short(run.before), Short(run.after),
               Short(run.torque), Short(run.speed), Short(run.until_stop), Name(run.cause),
               Short(run.detection), Short(run.travel), Name(run.cobot_stop), Short(run.excess),
               Short(run.clear_detection), Short(run.commanded)},
              ",");
}

HazardRunStore::HazardRunStore(const std::filesystem::path& file) : file_(file) {
  Read();
  std::error_code error;
  const bool is_new = std::filesystem::file_size(file, error) == 0 || error;
  out_.open(file, std::ios::app);
  Write(is_new ? std::string(kHeader) + "\n" : "");
}

// Removes the beginning of a line that was not completed. Such a line may look complete although
// its last number lacks digits.
void HazardRunStore::Read() {
  std::ifstream in(file_);
  std::uintmax_t end = 0;  // of the last complete line
  for (std::string line; std::getline(in, line) && !in.eof(); end += line.size() + 1) {
    const std::vector<std::string> cells = Split(line);
    HazardRun run;
    if (ReadRun(cells, &run)) runs_[KeyOf(cells[0], std::to_string(run.seed))] = run;
  }
  std::error_code error;
  if (std::filesystem::file_size(file_, error) > end && !error)
    std::filesystem::resize_file(file_, end, error);
}

bool HazardRunStore::Find(const std::string& key, std::uint64_t seed, HazardRun* run) const {
  const auto found = runs_.find(KeyOf(key, std::to_string(seed)));
  if (found == runs_.end()) return false;
  *run = found->second;
  return true;
}

void HazardRunStore::Add(const std::string& key, const HazardCell& cell, const HazardRun& run) {
  const std::string line = Join(
      {key, CsvCell(cell.scenario), CsvCell(cell.controller), CsvCell(cell.hazard), TextOf(run)},
      ",");
  const std::lock_guard lock(mutex_);
  Write(line + "\n");
}

void HazardRunStore::Write(const std::string& line) {
  out_ << line;
  if (!out_.flush())
    throw InputError("'" + file_.string() +
                     "' could not be written. Give a writable folder on a disk with free space.");
}

}  // namespace predictor
