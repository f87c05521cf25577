// What a joint of an arm was told, and where it went.
#pragma once

#include <vector>

namespace predictor {

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
};

// Makes a record out of ticks at any times: a command holds until the next.
class LoopRecorder {
 public:
  explicit LoopRecorder(int joint) { record_.joint = joint; }
  // [s], ascending; [rad/s].
  void Told(double time, double u);
  // A fresh sample that was measured at `time` [s].
  void Seen(double time, double q) { record_.samples.push_back({time, q}); }
  // Times from the first command on.
  LoopRecord Finish() &&;

 private:
  LoopRecord record_;
  std::vector<double> times_, commands_;
};

// Of a sample: what the joint at rest shows before its first command, or its quantum [rad].
double NoiseOf(const LoopRecord& record);

}  // namespace predictor
