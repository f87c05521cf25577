// Measures how similar two recordings are. They may be a real run and its emulation, or the same
// task on two devices. The page docs/how-to/compare-runs.md explains the meaning and the limits of
// the results.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/record.h"
#include "evaluation/fidelity_signals.h"

namespace predictor {

// The sampling rate of all compared signals [Hz]. The frequencies of hand motion are far below this
// rate.
inline constexpr double kFidelityRate = 100;

struct FidelityChannel {
  std::string name;  // "left force x"
  std::string unit;  // "N"
  std::vector<double> samples;
};

// One run, sampled in steps of 1 / kFidelityRate.
struct FidelitySignals {
  std::vector<FidelityChannel> channels;
  // The horizontal path of the object in W [m], which is used to count cycles. It may be empty.
  std::vector<double> path_x, path_y;
  std::size_t filled = 0;  // number of samples without a record, which are interpolated
};
// Returns the channel of this name, or null if no channel has it.
const FidelityChannel* FindChannel(const FidelitySignals& signals, const std::string& name);

// Converts records, in order, to signals. The signals are the position of the end-effector and the
// force of each present hand in the axes of W, averaged over each step. Only ticks in which
// simulated time passed count. If the run starts again, the earlier samples are discarded. At the
// edges of a step, there is a tolerance of one millionth of a step, so that times with rounding
// errors remain in their step.
class FidelityCollector {
 public:
  // Throws InputError if the run time exceeds six hours. The limit exists because the required
  // memory grows with the run time, and an untrusted file may contain an excessive run time.
  void Add(const TickRecord& record);
  FidelitySignals signals() const;

 private:
  static constexpr std::size_t kValues = 3 + 3 * kHands;
  struct Step {
    std::array<double, kValues> sums{};
    std::uint32_t count = 0;
  };

  std::vector<Step> steps_;
  double last_time_ = 0;  // [s]
  std::array<bool, kHands> present_ = {};
};

// One channel of run b, compared with the same channel of run a. A result is NaN if it needs more
// cycles or repeats than exist.
struct ChannelFidelity {
  std::string name, unit;
  double range = 0;               // largest minus smallest value of a [unit]
  double mean_a = 0, mean_b = 0;  // [unit]
  double std_a = 0, std_b = 0;    // standard deviation [unit]
  double rmse = 0;                // [unit]
  double relative_rmse = 0;       // rmse / range
  double correlation = 0;         // Pearson's correlation
  double lag = 0;                 // [s]; positive: b is later than a
  double lag_correlation = 0;     // correlation at that lag
  double warped = 0;              // per sample, after dynamic time warping [unit]
  double peak_a = 0, peak_b = 0;  // largest absolute value in a cycle, averaged over the cycles
                                  // [unit]
  Coherence coherence;            // up to kHighestCoherence
  RepeatComparison repeats;       // cycles, or whole runs, are the repeats
};
inline constexpr double kHighestCoherence = 3;  // [Hz]

// The just noticeable difference (JND), as a share of the first of two stimuli. Published values
// lie between these two numbers.
struct NoticeableDifference {
  double low = 0, high = 0;
};

enum class Noticed { kNo, kPerhaps, kYes, kUndecided };
const char* Name(Noticed noticed);  // "not noticeable", for example

// A quantity that a person would feel, measured in both runs.
struct PerceivedQuantity {
  std::string name, unit;
  double a = 0, b = 0;              // mean over the cycles, or over the whole run if there are none
  double error_a = 0, error_b = 0;  // standard errors over the cycles; NaN for fewer than two
  double difference = 0;            // (b − a) / |a|
  double error = 0;                 // standard error of the difference
  NoticeableDifference jnd;
  // Based on the 90 % interval of the difference's size, ± 1.645 standard errors: kNo if the whole
  // interval is below the JND, kYes if it is above the JND, kUndecided if it begins below the JND
  // and ends above it, otherwise kPerhaps. If the standard errors are unknown, the verdict is based
  // only on the values, and the report contains a warning.
  Noticed noticed = Noticed::kUndecided;
};

// Returns whether a verdict was reached although the standard errors are unknown.
bool ErrorUnknown(const PerceivedQuantity& quantity);

struct FidelityReport {
  bool by_phase = false;                   // compared by phase; otherwise by time from the start
  std::size_t cycles_a = 0, cycles_b = 0;  // cycles in the first run of each side
  std::size_t cycles = 0;                  // number of compared cycles
  double period_a = 0, period_b = 0;       // mean time of a cycle [s]
  double duration = 0;                     // compared time, if not by phase [s]
  std::size_t repeats_a = 0, repeats_b = 0;
  std::vector<ChannelFidelity> channels;
  std::vector<PerceivedQuantity> perceived;
  std::vector<std::string> warnings;  // sentences that explain why the results may be less reliable
                                      // than they seem
};

// Compares the first run of `a` with the first run of `b`. Each channel is compared with the
// channel of the same name. The other runs of each side must be repeats of the same task. These
// repeats show how much runs differ. `by_phase` states whether the runs are compared by phase.
// Without this argument, they are compared by phase if the path of every run has at least two
// cycles. Throws InputError if a side is empty, if no channel name occurs on both sides, or if a
// run is shorter than one second.
FidelityReport CompareFidelity(std::span<const FidelitySignals> a,
                               std::span<const FidelitySignals> b,
                               std::optional<bool> by_phase = {});

// Returns the report as text for the user. `name_a` and `name_b` are names such as "real" and
// "emulated".
std::string FidelityText(const FidelityReport& report, const std::string& name_a,
                         const std::string& name_b);
// Returns the report as JSON for scripts, in SI units, with null for undefined values.
std::string FidelityJson(const FidelityReport& report, const std::string& name_a,
                         const std::string& name_b);

}  // namespace predictor
