#include "commissioning/loop_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace predictor {
namespace {

constexpr double kStep = LoopRecord::kStep;
constexpr double kQuantum = 1e-9;  // less is rounding [rad]

}  // namespace

void LoopRecorder::Told(double time, double u) {
  times_.push_back(time);
  commands_.push_back(u);
}

LoopRecord LoopRecorder::Finish() && {
  if (times_.empty()) return std::move(record_);
  const double start = times_.front();
  for (LoopRecord::Sample& sample : record_.samples) sample.time -= start;
  const auto steps = static_cast<std::size_t>(std::ceil((times_.back() - start) / kStep)) + 1;
  record_.u.assign(steps, 0);
  times_.push_back(start + kStep * static_cast<double>(steps));
  // Each step has the mean of what was told within it: so no way is lost.
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    double from = (times_[i] - start) / kStep;
    const double to = (times_[i + 1] - start) / kStep;
    while (from < to - 1e-9) {
      const double cell = std::floor(from + 1e-9);
      const double next = std::min(to, cell + 1);
      record_.u[std::min(static_cast<std::size_t>(cell), steps - 1)] +=
          commands_[i] * (next - from);
      from = next;
    }
  }
  return std::move(record_);
}

double NoiseOf(const LoopRecord& record) {
  const auto first =
      std::find_if(record.u.begin(), record.u.end(), [](double u) { return u != 0; });
  const double begin = kStep * static_cast<double>(first - record.u.begin());
  double sum = 0, squares = 0, n = 0, quantum = HUGE_VAL;
  for (std::size_t i = 0; i < record.samples.size(); ++i) {
    const double d = record.samples[i].q - record.samples.front().q;
    if (record.samples[i].time < begin) {
      sum += d;
      squares += d * d;
      ++n;
    }
    const double change = i == 0 ? 0 : std::abs(record.samples[i].q - record.samples[i - 1].q);
    if (change > kQuantum) quantum = std::min(quantum, change);
  }
  const double variance = n > 1 ? squares / n - sum / n * sum / n : 0;
  return std::max(std::sqrt(std::max(0.0, variance)),
                  std::isfinite(quantum) ? quantum / std::sqrt(12.0) : 0);
}

}  // namespace predictor
