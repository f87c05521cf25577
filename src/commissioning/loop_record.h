// The commands to a joint of an arm, and its motion.
#pragma once

#include <string>
#include <vector>

namespace predictor::commissioning {

// Gaps in a measurement that are caused by a busy computer or a bad network. A command acts until
// the next tick. The response of an arm to a late command is not known.
struct Gaps {
  long ticks = 0, late = 0;    // late: ticks before which at least one step was skipped
  long samples = 0, lost = 0;  // lost: samples that never arrived, according to the arm's rate
  double longest_tick = 0;     // longest time between two ticks [s]
  double longest_hole = 0;     // longest time between two samples [s]
  Gaps& operator+=(const Gaps& other);
  double late_share() const { return Share(late, ticks); }
  double lost_share() const { return Share(lost, samples + lost); }

 private:
  static double Share(long part, long whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
  }
};
// Returns a text such as "31 of 62104 ticks were late (0.0 %; longest interval 5.1 ms), 12 of 31052
// samples ...".
std::string GapsText(const Gaps& gaps);

// The record of one swing of one joint.
struct LoopRecord {
  static constexpr double kStep = 0.001;  // step of the commands [s]
  struct Sample {
    double time;  // time of the measurement, computed from the reading's age [s]
    double q;     // [rad]
  };
  int joint = 0;
  std::vector<double> u;        // command from time k · kStep onwards [rad/s]
  std::vector<Sample> samples;  // ascending
  Gaps gaps;
};

// The swings of an arm's joints, starting with the first joint. The last joints may be missing.
struct Swings {
  int joints = 0;  // number of joints of the arm; 0: not known yet
  std::vector<LoopRecord> records;
  int measured() const { return static_cast<int>(records.size()); }
  bool complete() const { return joints > 0 && measured() == joints; }
};

// Makes a record from ticks at arbitrary times. A command acts until the next command.
class LoopRecorder {
 public:
  // `period` is the sample period of the arm [s].
  LoopRecorder(int joint, double period) : period_(period) { record_.joint = joint; }
  // `due` is the scheduled time in the session. `time` is the time of the command [s]. Both times
  // must ascend. `u` is in [rad/s].
  void AddCommand(double due, double time, double u);
  // Adds a new sample measured at `time` [s].
  void AddSample(double time, double q) { record_.samples.push_back({time, q}); }
  // Times are relative to the first command.
  LoopRecord Finish() &&;

 private:
  Gaps FindGaps() const;

  double period_;
  LoopRecord record_;
  std::vector<double> dues_, times_, commands_;
};

// Returns the noise of a sample [rad]: the noise of the joint at rest before its first command, or
// the resolution of its encoder.
double NoiseOf(const LoopRecord& record);

}  // namespace predictor::commissioning
