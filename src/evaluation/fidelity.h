// How alike two recordings are: a real run and its emulation, or the same task on two devices.
// What the figures mean, and what they do not, is told in docs/fidelity.md.
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

// Of everything that is compared [Hz]: what hands do ends far below.
inline constexpr double kFidelityRate = 100;

struct FidelityChannel {
  std::string name;  // "left force x"
  std::string unit;  // "N"
  std::vector<double> samples;
};

// One run, at steady steps of 1 / kFidelityRate.
struct FidelitySignals {
  std::vector<FidelityChannel> channels;
  // Where the object is led in the horizontal plane of W [m]: cycles are counted by it. May be
  // empty.
  std::vector<double> path_x, path_y;
  std::size_t filled = 0;  // samples for which there was no record: interpolated
};

// Makes signals of records, in order: the position of the end-effector and the force of each hand
// that is present, axes of W, each the mean over a step. Only ticks in which simulated time passed
// count; when a run begins anew, what came before is forgotten. A millionth of a step at the edges
// keeps rounded times in their step.
class FidelityCollector {
 public:
  // Throws InputError beyond six hours: memory grows with the run's time, which a file only claims.
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

// Of one channel, b held against a. What needs cycles or repeats that are not there is NaN.
struct ChannelFidelity {
  std::string name, unit;
  double range = 0;               // of a, largest less smallest [unit]
  double mean_a = 0, mean_b = 0;  // [unit]
  double std_a = 0, std_b = 0;    // about that [unit]
  double rmse = 0;                // [unit]
  double relative_rmse = 0;       // rmse / range
  double correlation = 0;         // Pearson's
  double lag = 0;                 // [s]; positive: b comes after a
  double lag_correlation = 0;     // at that lag
  double warped = 0;              // per sample, after dynamic time warping [unit]
  double peak_a = 0, peak_b = 0;  // largest size in a cycle, mean over the cycles [unit]
  Coherence coherence;            // up to kHighestCoherence
  RepeatComparison repeats;       // cycles, or whole runs, as repeats
};
inline constexpr double kHighestCoherence = 3;  // [Hz]

// A just noticeable difference, as a share of the first of two stimuli. Between the two figures,
// studies differ.
struct NoticeableDifference {
  double low = 0, high = 0;
};

enum class Noticed { kNo, kPerhaps, kYes, kUndecided };
const char* Name(Noticed noticed);  // "not noticeable" and so on

// Something that a person would feel, in both.
struct PerceivedQuantity {
  std::string name, unit;
  double a = 0, b = 0;              // means over the cycles (of the whole run, if there are none)
  double error_a = 0, error_b = 0;  // their standard errors over the cycles; NaN of fewer than two
  double difference = 0;            // (b − a) / |a|
  double error = 0;                 // standard error of that
  NoticeableDifference jnd;
  // kUndecided if a's own standard error, or that of the difference, reaches the JND. Where these
  // are not known the figures alone decide, and the report warns.
  Noticed noticed = Noticed::kUndecided;
};

// It is judged, though how sure its figures are is not known.
bool ErrorUnknown(const PerceivedQuantity& quantity);

struct FidelityReport {
  bool by_phase = false;                   // else from the start, in seconds
  std::size_t cycles_a = 0, cycles_b = 0;  // of the first runs
  std::size_t cycles = 0;                  // that are compared
  double period_a = 0, period_b = 0;       // mean time of a cycle [s]
  double duration = 0;                     // compared, if not by phase [s]
  std::size_t repeats_a = 0, repeats_b = 0;
  std::vector<ChannelFidelity> channels;
  std::vector<PerceivedQuantity> perceived;
  std::vector<std::string> warnings;  // sentences: why the figures may say less than they seem to
};

// Compares the first of `a` with the first of `b`, channel by channel of the same name; the others
// of each, which are runs of the same kind, say how much repeats differ. By phase if the paths of
// all go round at least twice (`by_phase` decides otherwise). Throws InputError if a side is empty,
// nothing has the same name, or a run is shorter than a second.
FidelityReport CompareFidelity(std::span<const FidelitySignals> a,
                               std::span<const FidelitySignals> b,
                               std::optional<bool> by_phase = {});

// For a person; `name_a` and `name_b` as in "real", "emulated".
std::string FidelityText(const FidelityReport& report, const std::string& name_a,
                         const std::string& name_b);
// The same for scripts, all of it in SI units; null where there is no figure.
std::string FidelityJson(const FidelityReport& report, const std::string& name_a,
                         const std::string& name_b);

}  // namespace predictor
