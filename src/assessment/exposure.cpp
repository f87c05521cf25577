#include "assessment/exposure.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <ranges>

#include "assessment/hand_samples.h"
#include "core/filters.h"

namespace predictor::assessment {
namespace {

constexpr std::size_t kStride = 10;              // samples per step of the fatigue model
constexpr double kStep = kStride / kSampleRate;  // [s]

// Returns loads at 10 Hz, which are means of the samples at 100 Hz.
std::vector<double> Coarse(std::span<const double> load) {
  std::vector<double> coarse;
  for (std::size_t i = 0; i < load.size(); i += kStride) {
    const auto part = load.subspan(i, std::min(kStride, load.size() - i));
    coarse.push_back(std::reduce(part.begin(), part.end()) / static_cast<double>(part.size()));
  }
  return coarse;
}

// Ma et al. 2009, with the interface of FatigueTracker.
class MaTracker {
 public:
  void Step(double mean_load) {
    capacity_ = ergonomics::Capacity(capacity_, std::min(mean_load, 1.0), kStep);
  }
  double capacity() const { return capacity_; }
  bool IsTooMuch(double load) const { return load > capacity_; }

 private:
  double capacity_ = 1;
};

// Peternel et al. 2018, likewise.
class TrialTracker {
 public:
  explicit TrialTracker(const ergonomics::TrialFatigue& trial) : trial_(trial) {}
  void Step(double mean_load) {
    fatigue_ = ergonomics::TrialFatigueAfter(fatigue_, std::min(mean_load, 1.0), kStep, trial_);
  }
  double capacity() const { return 1 - fatigue_; }
  bool IsTooMuch(double) const { return fatigue_ >= ergonomics::kTrialExhaustion; }

 private:
  ergonomics::TrialFatigue trial_;
  double fatigue_ = 0;
};

// Repeats the run until it is too much, but for at most a shift.
template <class Tracker>
FatigueCourse CourseOf(Tracker state, std::span<const double> coarse) {
  FatigueCourse course;
  course.time_to_limit = std::numeric_limits<double>::infinity();
  double time = 0;
  const auto run = [&] {
    for (const double u : coarse) {
      if (state.IsTooMuch(u) && time < course.time_to_limit) course.time_to_limit = time;
      state.Step(u);
      time += kStep;
    }
  };
  run();
  course.capacity = state.capacity();
  while (time < ergonomics::kShift && time <= course.time_to_limit) run();
  return course;
}

std::size_t RestOf(double cutoff) { return static_cast<std::size_t>(kSampleRate / cutoff); }

// Applies a first-order filter forward and backward, so that the result has no delay. The filter
// begins and ends at rest, and the result contains RestOf(cutoff) more samples at each end.
std::vector<double> Smooth(std::span<const double> values, double cutoff) {
  const std::size_t rest = RestOf(cutoff);
  std::vector<double> smooth(values.size() + 2 * rest, 0);
  std::ranges::copy(values, smooth.begin() + static_cast<std::ptrdiff_t>(rest));
  const auto pass = [cutoff](auto&& range) {
    LowPass<double> filter(cutoff, 1 / kSampleRate, 0);
    for (double& value : range) value = filter.Update(value);
  };
  pass(smooth);
  pass(std::views::reverse(smooth));
  return smooth;
}

}  // namespace

std::optional<std::vector<double>> WithoutGaps(std::vector<double> load) {
  const auto known = [](double x) { return std::isfinite(x); };
  const auto first = std::ranges::find_if(load, known);
  const auto unknown = std::ranges::count_if(load, std::not_fn(known));
  if (first == load.end() ||
      static_cast<double>(unknown) > kMaxUnknownShare * static_cast<double>(load.size()))
    return {};
  double last = *first;
  for (double& x : load) last = x = known(x) ? x : last;
  return load;
}

DamageResult DamageOfRepetitions(const ergonomics::DamageTool& tool, const std::string& part,
                                 double damage, double duration) {
  DamageResult result = {tool.name, part};
  result.per_run = damage;
  result.day_share = ergonomics::ShareOfReferenceDay(damage, tool.risk);
  const double shift = ergonomics::DamageOfShift(damage, duration);
  result.shift_share = ergonomics::ShareOfReferenceDay(shift, tool.risk);
  result.probability = tool.risk.Probability(shift);
  return result;
}

DamageResult DamageOfMoment(const ergonomics::DamageTool& tool, const std::string& part,
                            std::span<const double> moment) {
  const std::vector<double> smooth = Smooth(moment, kDamageCutoff);
  const auto [low, high] = std::ranges::minmax(smooth);
  const auto cycles =
      ergonomics::CountRainflow(smooth, std::max(kMinRange, kMinRangeShare * (high - low)));
  DamageResult result =
      DamageOfRepetitions(tool, part, ergonomics::DamageOf(cycles, tool.per_cycle),
                          static_cast<double>(moment.size()) / kSampleRate);
  for (const ergonomics::LoadCycle& cycle : cycles)
    result.load_over_range = std::max(result.load_over_range, cycle.range / tool.largest_load);
  return result;
}

std::vector<double> SmoothMoment(std::span<const double> moment) {
  const std::vector<double> smooth = Smooth(moment, kDamageCutoff);
  const auto rest = static_cast<std::ptrdiff_t>(RestOf(kDamageCutoff));
  return {smooth.begin() + rest, smooth.end() - rest};
}

void FatigueTracker::Add(double load) {
  sum_ += load;
  if (++count_ < kStride) return;
  Step(sum_ / static_cast<double>(kStride));
  sum_ = 0;
  count_ = 0;
}

void FatigueTracker::Step(double mean_load) {
  state_ = ergonomics::Fatigued(state_, std::min(mean_load, 1.0), kStep, rates_);
}

FatigueResult FatigueOfLoad(const std::string& joint, ergonomics::FatigueJoint kind,
                            std::span<const double> load,
                            const std::optional<ergonomics::TrialFatigue>& trial) {
  const std::vector<double> coarse = Coarse(load);
  FatigueResult result = {joint};
  result.mean_load = std::reduce(coarse.begin(), coarse.end()) / static_cast<double>(coarse.size());
  result.compartments = CourseOf(FatigueTracker(kind), coarse);
  result.ma = CourseOf(MaTracker(), coarse);
  if (trial) result.trial = CourseOf(TrialTracker(*trial), coarse);
  result.endurance = ergonomics::MeasuredEnduranceTime(result.mean_load, kind);
  return result;
}

}  // namespace predictor::assessment
