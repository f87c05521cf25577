// Predicts what would have happened if the emulator had not stopped a run. The prediction continues
// the run from the tick of the stop, for many possible operators.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/continuation/arm_distribution.h"
#include "analysis/continuation/estimated_operator.h"
#include "analysis/continuation/stopped_run.h"
#include "core/status.h"
#include "evaluation/censored.h"
#include "evaluation/statistics_samples.h"

namespace predictor {

// The way in which a continued run ended.
enum class Ending {
  kSettles,       // in the last third, no hand exceeds the scenario's limits of force and torque
  kStaysAbove,    // in the last third, the limits are still exceeded
  kDiverges,      // the same, and the largest force occurs in the last third and is still growing
  kCobotStopped,  // a safety function of the virtual cobot stopped it
  kFault,         // the emulator stopped for another reason: what follows is not known
};
inline constexpr int kEndings = 5;
// Returns the name of an ending: "settles", "stays_above", "diverges", "cobot_stops" or "fault".
const char* Name(Ending ending);

// One continued run, beginning at the stop. Forces are readings of the sensors, because the stop is
// decided from the same readings.
struct ContinuedRun {
  double peak_force = 0, peak_torque = 0;  // largest of a hand [N], [N·m]
  double peak_speed = 0;                   // of a handle [m/s]
  double energy = 0;                       // energy that the handles transferred to the hands [J]
  double peak_power = 0;                   // largest power of that transfer at one hand [W]
  Ending ending = Ending::kSettles;
  StopCause fault = StopCause::kNone;  // cause, for Ending::kFault
  CobotStop cobot_stop = CobotStop::kNone;
  double duration = 0;        // from the stop to the end [s]
  std::vector<double> force;  // largest force of a hand in each interval of kCurveStep [N]
  TickRecord at_peak{};       // the tick with the largest force
  OperatorDraw person;        // not set for the reference
  // The largest torque of elbows and shoulders at the time of the largest force, as a multiple of
  // the mean strength for the person's sex. The value is NaN if the posture is unknown or does not
  // reach the handles.
  double joint_use = kUndefined;
};
inline constexpr double kCurveStep = 0.01;  // [s]

// A 90 % interval.
struct Interval90 {
  CensoredValue low, median, high;  // 5 %, 50 %, 95 %
};

struct Continuation {
  std::string scenario, operator_type;
  Status cause;            // cause of the stop
  double time = 0;         // time of the stop in the run [s]
  double peak_before = 0;  // largest force of a hand until the stop, including it [N]
  double horizon = 0;      // [s]
  double force_limit = 0, torque_limit = 0;  // [N], [N·m]
  std::string arm_source;
  std::vector<double> past_times,
      past_force;                  // before the stop: time relative to the stop, largest force
  std::vector<ContinuedRun> runs;  // one per draw, in order
  // The run as the recorded operator would have continued it, if this operator was simulated.
  std::optional<ContinuedRun> reference;
  std::string no_joint_use;  // why no posture could be judged; empty: it could

  // Returns the interval of a quantity over the draws in which it is known. For a run that ended
  // with another fault, the value is a lower bound.
  Interval90 IntervalOf(double ContinuedRun::*value) const;
  int CountOf(Ending ending) const;
};

using OperatorMaker = std::function<std::unique_ptr<Operator>(const Scenario&)>;

struct ContinueOptions {
  int draws = 200;
  double horizon = 1.5;    // duration after the stop [s]
  std::uint64_t seed = 1;  // seed of the draws
  int workers = 0;         // 0: the number of cores
  IntentModel intent;
  bool reference = false;   // also continue with the simulated operator's own state
  bool joint_loads = true;  // needs body and stance in the scenario
  // Makes an operator that can load the saved state of the recorded operator.
  OperatorMaker recorded_operator = [](const Scenario& scenario) {
    return MakeOperator(scenario, HandInertia::kInWrench);
  };
  // Only the caller's thread calls this function.
  std::function<void(double share)> progress = [](double) {};
};

// Continues the run in virtual time without the limits of force, torque, coupling, tracking and
// handle speed. All other faults still stop the run. Throws InputError.
Continuation Continue(const StoppedRun& run, const ArmDistribution& arms,
                      const ContinueOptions& options);

// `recording` is the name of the file.
std::string ContinuationText(const Continuation& c);
std::string ContinuationJson(const Continuation& c, const std::string& recording);
std::string ContinuationPage(const Continuation& c, const std::string& recording,
                             const std::string& program_version);
// Returns the JSON Schema (draft-07) of ContinuationJson.
std::string ContinuationSchema();
// Returns sentences that state the assumptions and omissions of the prediction.
std::vector<std::string> ContinuationAssumptions(const Continuation& c);
// Returns the shares of the endings over the draws, such as "settles in 71 %, ...".
std::string EndingWords(const Continuation& c);

// The results over the draws that the text, the page and the JSON show, in the order of the JSON.
struct ContinuationQuantity {
  const char *key, *label, *format;
  double ContinuedRun::*value;
};
extern const std::array<ContinuationQuantity, 6> kContinuationQuantities;

}  // namespace predictor
