#include "commissioning/loop_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"

namespace predictor::commissioning {
namespace {

constexpr double kQuantum = 1e-9;  // smaller steps are rounding errors [rad]

}  // namespace

void LoopRecorder::AddCommand(double due, double time, double u) {
  dues_.push_back(due);
  times_.push_back(time);
  commands_.push_back(u);
}

// The clock of an arm and the age of samples vary, so lost samples can be counted only over the
// whole record.
Gaps LoopRecorder::FindGaps() const {
  Gaps gaps;
  gaps.ticks = static_cast<long>(times_.size());
  for (std::size_t i = 1; i < times_.size(); ++i) {
    const double gap = times_[i] - times_[i - 1];
    gaps.longest_tick = std::max(gaps.longest_tick, gap);
    if (std::lround((dues_[i] - dues_[i - 1]) / LoopRecord::kStep) > 1) ++gaps.late;
  }
  const std::vector<LoopRecord::Sample>& samples = record_.samples;
  gaps.samples = static_cast<long>(samples.size());
  for (std::size_t i = 1; i < samples.size(); ++i)
    gaps.longest_hole = std::max(gaps.longest_hole, samples[i].time - samples[i - 1].time);
  if (samples.empty()) return gaps;
  const double time = samples.back().time - samples.front().time;
  gaps.lost = std::max(0L, std::lround(time / period_) + 1 - gaps.samples);
  return gaps;
}

LoopRecord LoopRecorder::Finish() && {
  if (times_.empty()) return std::move(record_);
  record_.gaps = FindGaps();
  const double start = times_.front();
  for (LoopRecord::Sample& sample : record_.samples) sample.time -= start;
  const auto steps =
      static_cast<std::size_t>(std::ceil((times_.back() - start) / LoopRecord::kStep)) + 1;
  record_.u.assign(steps, 0);
  times_.push_back(start + LoopRecord::kStep * static_cast<double>(steps));
  // Each step contains the mean of the commands within this step, so that no displacement is lost.
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    double from = (times_[i] - start) / LoopRecord::kStep;
    const double to = (times_[i + 1] - start) / LoopRecord::kStep;
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

Gaps& Gaps::operator+=(const Gaps& other) {
  ticks += other.ticks;
  late += other.late;
  samples += other.samples;
  lost += other.lost;
  longest_tick = std::max(longest_tick, other.longest_tick);
  longest_hole = std::max(longest_hole, other.longest_hole);
  return *this;
}

std::string GapsText(const Gaps& gaps) {
  return Formatted(
      "%ld of %ld ticks were late (%.1f %%; longest interval %.1f ms), %ld of %ld samples were "
      "lost (%.1f %%; longest gap %.1f ms)",
      gaps.late, gaps.ticks, 1e2 * gaps.late_share(), 1e3 * gaps.longest_tick, gaps.lost,
      gaps.samples + gaps.lost, 1e2 * gaps.lost_share(), 1e3 * gaps.longest_hole);
}

double NoiseOf(const LoopRecord& record) {
  const auto first =
      std::find_if(record.u.begin(), record.u.end(), [](double u) { return u != 0; });
  const double begin = LoopRecord::kStep * static_cast<double>(first - record.u.begin());
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

}  // namespace predictor::commissioning
