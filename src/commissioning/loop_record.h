// What a joint of an arm was told, and where it went.
#pragma once

#include <string>
#include <vector>

namespace predictor {

// What a busy computer or a bad network makes of a measurement. What was told holds until the next
// tick, and that is known; what an arm makes of a command that comes late is not.
struct Gaps {
  long ticks = 0, late = 0;    // late: a step or more was passed over before it
  long samples = 0, lost = 0;  // lost: never seen, of those that the arm sends at its rate
  double longest_tick = 0;     // between two ticks [s]
  double longest_hole = 0;     // between two samples [s]
  Gaps& operator+=(const Gaps& other);
  double late_share() const { return Share(late, ticks); }
  double lost_share() const { return Share(lost, samples + lost); }

 private:
  static double Share(long part, long whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
  }
};
// "31 of 62104 ticks came late (0.0 %, at worst 5.1 ms apart), 12 of 31052 samples ..."
std::string GapsText(const Gaps& gaps);

// Of one swing of one joint.
struct LoopRecord {
  static constexpr double kStep = 0.001;  // of the commands [s]
  struct Sample {
    double time;  // when it was measured: by the reading's age [s]
    double q;     // [rad]
  };
  int joint = 0;
  std::vector<double> u;        // command from k · kStep on [rad/s]
  std::vector<Sample> samples;  // ascending
  Gaps gaps;
};

// Of an arm's joints, from the first one on; some may be missing at the end.
struct Swings {
  int joints = 0;  // of the arm; 0: not known yet
  std::vector<LoopRecord> records;
  int measured() const { return static_cast<int>(records.size()); }
  bool complete() const { return joints > 0 && measured() == joints; }
};

// Makes a record out of ticks at any times: a command holds until the next.
class LoopRecorder {
 public:
  // period: at which the arm sends samples [s].
  LoopRecorder(int joint, double period) : period_(period) { record_.joint = joint; }
  // due: of the session; time: when it was told [s]; both ascending. u [rad/s].
  void Told(double due, double time, double u);
  // A fresh sample that was measured at `time` [s].
  void Seen(double time, double q) { record_.samples.push_back({time, q}); }
  // Times from the first command on.
  LoopRecord Finish() &&;

 private:
  Gaps FindGaps() const;

  double period_;
  LoopRecord record_;
  std::vector<double> dues_, times_, commands_;
};

// Of a sample: what the joint at rest shows before its first command, or its quantum [rad].
double NoiseOf(const LoopRecord& record);

}  // namespace predictor
