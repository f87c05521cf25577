#include "commissioning/swing_file.h"

#include <fstream>
#include <string_view>
#include <system_error>

#include "commissioning/machine_file.h"
#include "core/format.h"

namespace predictor::commissioning {
namespace {

constexpr std::size_t kMaxNumbers = 1'000'000;  // numbers per record: a quarter of an hour
constexpr double kLongest = 1e4;                // duration of a swing [s]
constexpr int kMaxSwingJoints = 64;

bool ReadWord(std::istream& in, std::string_view expected) {
  std::string word;
  return in >> word && word == expected;
}

bool Ascend(const std::vector<LoopRecord::Sample>& samples) {
  double before = -kLongest;
  for (const LoopRecord::Sample& sample : samples) {
    if (!(sample.time > before && sample.time < kLongest)) return false;
    before = sample.time;
  }
  return true;
}

bool ReadRecord(std::istream& in, int joint, LoopRecord* record) {
  std::size_t ticks = 0, samples = 0;
  Gaps& gaps = record->gaps;
  if (!ReadWord(in, "joint") ||
      !(in >> record->joint >> ticks >> samples >> gaps.ticks >> gaps.late >> gaps.samples >>
        gaps.lost >> gaps.longest_tick >> gaps.longest_hole))
    return false;
  if (record->joint != joint || ticks < 1 || ticks > kMaxNumbers || samples > kMaxNumbers)
    return false;
  record->u.resize(ticks);
  for (double& u : record->u) in >> u;
  record->samples.resize(samples);
  for (LoopRecord::Sample& sample : record->samples) in >> sample.time >> sample.q;
  return !in.fail() && Ascend(record->samples);
}

// Reads everything after the header, including the last word of the file.
bool ReadSwings(std::istream& in, Swings* swings) {
  int measured = 0;
  if (!(in >> swings->joints >> measured) || swings->joints > kMaxSwingJoints || measured < 1 ||
      measured > swings->joints)
    return false;
  swings->records.resize(static_cast<std::size_t>(measured));
  for (int joint = 0; joint < measured; ++joint)
    if (!ReadRecord(in, joint, &swings->records[static_cast<std::size_t>(joint)])) return false;
  return ReadWord(in, "end");
}

void AppendRecord(const LoopRecord& record, std::string* text) {
  const Gaps& gaps = record.gaps;
  Append(text, "joint %d %zu %zu %ld %ld %ld %ld %.17g %.17g\n", record.joint, record.u.size(),
         record.samples.size(), gaps.ticks, gaps.late, gaps.samples, gaps.lost, gaps.longest_tick,
         gaps.longest_hole);
  for (const double u : record.u) Append(text, "%.17g\n", u);
  for (const LoopRecord::Sample& sample : record.samples)
    Append(text, "%.17g %.17g\n", sample.time, sample.q);
}

}  // namespace

SwingFile::Kept SwingFile::Load() const {
  std::ifstream in(path_);
  if (!in) return {};
  Kept kept;
  std::string of;
  const bool known =
      ReadWord(in, "predictor_swings") && ReadWord(in, "1") && (in >> of >> kept.date);
  if (known && of != of_)
    return {{}, "", "was measured before the arm's settings in the machine file changed"};
  if (!known || !ReadSwings(in, &kept.swings)) return {{}, "", "is damaged"};
  return kept;
}

void SwingFile::Save(const Swings& swings, const std::string& date) const {
  std::string text = "predictor_swings 1 " + of_ + " " + date + "\n";
  Append(&text, "%d %d\n", swings.joints, swings.measured());
  for (const LoopRecord& record : swings.records) AppendRecord(record, &text);
  ReplaceFile(path_, text + "end\n", 0644);
}

void SwingFile::Remove() const noexcept {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace predictor::commissioning
