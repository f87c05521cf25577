#include "evaluation/fidelity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "evaluation/fidelity_perceived.h"
#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

constexpr std::size_t kPoints = 400;      // points per cycle when cycles are compared by phase
constexpr std::size_t kMinCycles = 2;     // with fewer cycles, there are no repeats
constexpr double kLongestLag = 0.25;      // share of a cycle or of the run
constexpr double kSegment = 8;            // segment of Welch's estimate without cycles [s]
constexpr double kEdge = 1e-6;            // rounding tolerance as a share of a step
constexpr double kLongestRun = 6 * 3600;  // [s]; the samples of such a run take 180 MB
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

struct Run {
  const FidelitySignals* signals = nullptr;
  std::vector<double> phase;
  std::size_t cycles = 0;
};

std::size_t LengthOf(const FidelitySignals& signals) {
  std::size_t length = signals.channels.empty() ? 0 : signals.channels[0].samples.size();
  for (const FidelityChannel& channel : signals.channels)
    length = std::min(length, channel.samples.size());
  return length;
}

std::vector<Run> RunsOf(std::span<const FidelitySignals> all) {
  if (all.empty()) throw InputError("There is no run to compare.");
  std::vector<Run> runs;
  for (const FidelitySignals& signals : all) {
    if (static_cast<double>(LengthOf(signals)) < kFidelityRate)
      throw InputError("A run is shorter than one second and therefore too short to be compared.");
    Run run{&signals, CyclePhase(signals.path_x, signals.path_y), 0};
    run.cycles = CyclesIn(run.phase);
    runs.push_back(std::move(run));
  }
  return runs;
}

bool GoRound(const std::vector<Run>& runs) {
  return std::all_of(runs.begin(), runs.end(),
                     [](const Run& run) { return run.cycles >= kMinCycles; });
}

// Returns the mean duration of the compared cycles [s].
double PeriodOf(const Run& run, std::size_t cycles) {
  const double samples =
      PlaceOfPhase(run.phase, static_cast<double>(cycles)) - PlaceOfPhase(run.phase, 0);
  return samples / kFidelityRate / static_cast<double>(cycles);
}

using Repeats = std::vector<std::vector<double>>;

// Returns the parts of one channel of one run that are compared. The parts are the cycles, or the
// first `length` samples as a single part.
Repeats RepeatsOf(const Run& run, const std::string& name, bool by_phase, std::size_t length) {
  const FidelityChannel* channel = FindChannel(*run.signals, name);
  if (!channel) return {};
  Repeats repeats;
  if (!by_phase) {
    repeats.emplace_back(channel->samples.begin(),
                         channel->samples.begin() + static_cast<std::ptrdiff_t>(length));
    return repeats;
  }
  for (std::size_t k = 0; k < run.cycles; ++k)
    repeats.push_back(CutCycle(channel->samples, run.phase, k, kPoints));
  return repeats;
}

Repeats RepeatsOf(const std::vector<Run>& runs, const std::string& name, bool by_phase,
                  std::size_t length) {
  Repeats all;
  for (const Run& run : runs)
    for (auto& one : RepeatsOf(run, name, by_phase, length)) all.push_back(std::move(one));
  return all;
}

// Concatenates the first `count` repeats.
std::vector<double> Joined(const Repeats& repeats, std::size_t count) {
  std::vector<double> joined;
  for (std::size_t k = 0; k < std::min(count, repeats.size()); ++k)
    joined.insert(joined.end(), repeats[k].begin(), repeats[k].end());
  return joined;
}

double MeanPeak(const Repeats& repeats) {
  double sum = 0;
  for (const auto& one : repeats) {
    double peak = 0;
    for (const double x : one) peak = std::max(peak, std::abs(x));
    sum += peak;
  }
  return repeats.empty() ? kUndefined : sum / static_cast<double>(repeats.size());
}

// The alignment in time between the first runs of the two sides.
struct Alignment {
  bool by_phase = false;
  std::size_t cycles = 1;   // number of compared cycles
  std::size_t length = 0;   // number of compared samples, if not by phase
  double rate = 0;          // sampling rate of the compared data [Hz]
  std::size_t segment = 0;  // segment of Welch's estimate [samples]
  std::size_t longest_lag = 0;
};

Alignment Align(const std::vector<Run>& a, const std::vector<Run>& b, bool by_phase) {
  Alignment alignment;
  alignment.by_phase = by_phase;
  if (by_phase) {
    alignment.cycles = std::min(a[0].cycles, b[0].cycles);
    const double period = (PeriodOf(a[0], alignment.cycles) + PeriodOf(b[0], alignment.cycles)) / 2;
    alignment.rate = kPoints / period;
    alignment.segment = kPoints;
    alignment.longest_lag = static_cast<std::size_t>(kLongestLag * kPoints);
    return alignment;
  }
  alignment.length = LengthOf(*a[0].signals);
  for (const auto* side : {&a, &b})
    for (const Run& run : *side)
      alignment.length = std::min(alignment.length, LengthOf(*run.signals));
  alignment.rate = kFidelityRate;
  alignment.segment =
      std::min(static_cast<std::size_t>(kSegment * kFidelityRate), alignment.length / 3);
  alignment.longest_lag =
      static_cast<std::size_t>(kLongestLag * static_cast<double>(alignment.length));
  return alignment;
}

ChannelFidelity CompareChannel(const FidelityChannel& channel, const std::vector<Run>& a,
                               const std::vector<Run>& b, const Alignment& alignment) {
  const auto first = [&](const Run& run) {
    return RepeatsOf(run, channel.name, alignment.by_phase, alignment.length);
  };
  const Repeats of_a = first(a[0]), of_b = first(b[0]);
  const std::vector<double> x = Joined(of_a, alignment.cycles), y = Joined(of_b, alignment.cycles);
  ChannelFidelity f;
  f.name = channel.name;
  f.unit = channel.unit;
  const auto [least, largest] = std::minmax_element(x.begin(), x.end());
  f.range = *largest - *least;
  f.mean_a = Mean(x);
  f.mean_b = Mean(y);
  f.std_a = SampleDeviation(x);
  f.std_b = SampleDeviation(y);
  f.rmse = RootMeanSquareError(x, y);
  f.relative_rmse = f.range > 0 ? f.rmse / f.range : kUndefined;
  f.correlation = Correlation(x, y);
  const Lag lag = LagOf(x, y, alignment.longest_lag);
  f.lag = lag.samples / alignment.rate;
  f.lag_correlation = lag.correlation;
  f.warped = WarpedDistance(x, y);
  f.peak_a = MeanPeak(of_a);
  f.peak_b = MeanPeak(of_b);
  f.coherence = CoherenceOf(x, y, alignment.rate, alignment.segment, kHighestCoherence);
  f.repeats = CompareRepeats(RepeatsOf(a, channel.name, alignment.by_phase, alignment.length),
                             RepeatsOf(b, channel.name, alignment.by_phase, alignment.length));
  return f;
}

// Returns the cycles as ranges of samples, or one range of all samples.
std::vector<SampleRange> PartsOf(const Run& run, const Alignment& alignment) {
  if (!alignment.by_phase) return {{0, alignment.length}};
  std::vector<SampleRange> parts;
  for (std::size_t k = 0; k < run.cycles; ++k)
    parts.push_back(
        {static_cast<std::size_t>(PlaceOfPhase(run.phase, static_cast<double>(k))),
         static_cast<std::size_t>(PlaceOfPhase(run.phase, static_cast<double>(k + 1)))});
  return parts;
}

std::size_t CountRepeats(const std::vector<Run>& runs, bool by_phase) {
  if (!by_phase) return runs.size();
  std::size_t count = 0;
  for (const Run& run : runs) count += run.cycles;
  return count;
}

}  // namespace

const FidelityChannel* FindChannel(const FidelitySignals& signals, const std::string& name) {
  const auto found = std::find_if(signals.channels.begin(), signals.channels.end(),
                                  [&](const auto& channel) { return channel.name == name; });
  return found == signals.channels.end() ? nullptr : &*found;
}

bool ErrorUnknown(const PerceivedQuantity& quantity) {
  return quantity.noticed != Noticed::kUndecided && std::isnan(quantity.error);
}

const char* Name(Noticed noticed) {
  switch (noticed) {
    case Noticed::kNo:
      return "not noticeable";
    case Noticed::kPerhaps:
      return "perhaps noticeable";
    case Noticed::kYes:
      return "noticeable";
    case Noticed::kUndecided:
      break;
  }
  return "undecided";
}

void FidelityCollector::Add(const TickRecord& record) {
  if (!record.ran || !(record.run_time >= 0)) return;
  if (!(record.run_time < kLongestRun))
    throw InputError(
        "The times of a run span more than six hours. Either the run is too long to be compared, "
        "or its times are damaged. Compare a shorter one.");
  if (record.run_time < last_time_) steps_.clear(), present_ = {};
  last_time_ = record.run_time;
  const auto step = static_cast<std::size_t>(record.run_time * kFidelityRate + kEdge);
  if (step >= steps_.size()) steps_.resize(step + 1);
  Step& to = steps_[step];
  ++to.count;
  for (std::size_t i = 0; i < 3; ++i) to.sums[i] += record.end_effector.pose.p[i];
  for (std::size_t h = 0; h < kHands; ++h) {
    if (!record.hands[h].present) continue;
    present_[h] = true;
    for (std::size_t i = 0; i < 3; ++i) to.sums[3 + 3 * h + i] += record.hands[h].wrench[i];
  }
}

FidelitySignals FidelityCollector::signals() const {
  FidelitySignals signals;
  std::array<std::vector<double>, kValues> values;
  std::size_t first = 0;  // a recording may start late
  while (first < steps_.size() && steps_[first].count == 0) ++first;
  std::size_t next = first;  // first step at or after i that has a record
  for (std::size_t i = first; i < steps_.size(); ++i) {
    const Step& step = steps_[i];
    next = std::max(next, i);
    while (steps_[next].count == 0) ++next;  // the last step always has a record
    for (std::size_t k = 0; k < kValues; ++k) {
      const double there = steps_[next].sums[k] / steps_[next].count;
      const double share = 1 / static_cast<double>(next - i + 1);
      values[k].push_back(step.count > 0 ? there : std::lerp(values[k].back(), there, share));
    }
    signals.filled += step.count > 0 ? 0 : 1;
  }
  signals.path_x = values[0];
  signals.path_y = values[1];
  for (std::size_t i = 0; i < 3; ++i)
    signals.channels.push_back({std::string("position ") + kAxes[i], "m", values[i]});
  for (std::size_t h = 0; h < kHands; ++h)
    for (std::size_t i = 0; i < 3 && present_[h]; ++i)
      signals.channels.push_back(
          {std::string(kHandNames[h]) + " force " + kAxes[i], "N", values[3 + 3 * h + i]});
  return signals;
}

FidelityReport CompareFidelity(std::span<const FidelitySignals> a,
                               std::span<const FidelitySignals> b, std::optional<bool> by_phase) {
  const std::vector<Run> runs_a = RunsOf(a), runs_b = RunsOf(b);
  FidelityReport report;
  report.by_phase = by_phase.value_or(GoRound(runs_a) && GoRound(runs_b));
  if (report.by_phase && (runs_a[0].cycles == 0 || runs_b[0].cycles == 0))
    throw InputError(
        "A path does not complete one cycle, so the runs cannot be compared by phase.");
  const Alignment alignment = Align(runs_a, runs_b, report.by_phase);
  report.cycles_a = runs_a[0].cycles;
  report.cycles_b = runs_b[0].cycles;
  report.cycles = report.by_phase ? alignment.cycles : 0;
  report.period_a = report.by_phase ? PeriodOf(runs_a[0], alignment.cycles) : kUndefined;
  report.period_b = report.by_phase ? PeriodOf(runs_b[0], alignment.cycles) : kUndefined;
  report.duration = static_cast<double>(alignment.length) / kFidelityRate;
  report.repeats_a = CountRepeats(runs_a, report.by_phase);
  report.repeats_b = CountRepeats(runs_b, report.by_phase);
  for (const FidelityChannel& channel : a[0].channels)
    if (FindChannel(b[0], channel.name))
      report.channels.push_back(CompareChannel(channel, runs_a, runs_b, alignment));
  if (report.channels.empty()) throw InputError("The two runs have no signal in common.");
  report.perceived =
      ComparePerceived(a[0], PartsOf(runs_a[0], alignment), b[0], PartsOf(runs_b[0], alignment));
  if (std::any_of(report.perceived.begin(), report.perceived.end(), ErrorUnknown))
    report.warnings.emplace_back(
        "A run has fewer than two cycles, so the standard errors are unknown. The verdicts about "
        "whether a person would feel a difference are based on single values.");
  return report;
}

}  // namespace predictor
