#include "analysis/identify/loop.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "core/error.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/fidelity.h"
#include "evaluation/fidelity_signals.h"
#include "evaluation/statistics.h"

namespace predictor {
namespace {

class Steps {
 public:
  Steps(int all, const std::function<void(double)>& progress) : all_(all), progress_(progress) {}
  void Next() {
    if (progress_) progress_(static_cast<double>(++done_) / all_);
  }

 private:
  int all_, done_ = 0;
  const std::function<void(double)>& progress_;
};

void Run(const Scenario& scenario, const std::function<void(const TickRecord&)>& look) {
  Emulator emulator(scenario);
  if (Simulate(&emulator, scenario.duration, look) == RunEnd::kFinished) return;
  throw std::runtime_error("The run of '" + scenario.name + "' with seed " +
                           std::to_string(scenario.seed) +
                           " was stopped, so it cannot be compared.");
}

FidelitySignals SignalsOf(Scenario scenario, std::uint64_t seed) {
  scenario.seed = seed;
  FidelityCollector collector;
  Run(scenario, [&](const TickRecord& record) { collector.Add(record); });
  return collector.signals();
}

std::vector<FidelitySignals> RunsOf(const Scenario& scenario, std::uint64_t first, int count,
                                    Steps* steps) {
  std::vector<FidelitySignals> runs;
  for (int i = 0; i < count; ++i) {
    runs.push_back(SignalsOf(scenario, first + static_cast<std::uint64_t>(i)));
    steps->Next();
  }
  return runs;
}

// Compares, for all channels, item i of `a` with item i + shift of `b`, cyclically.
struct Compared {
  std::vector<ChannelFidelity> first;  // of the first pair, for names and units
  std::vector<Statistics> rmse, correlation, range;
};

Compared Compare(const std::vector<FidelitySignals>& a, const std::vector<FidelitySignals>& b,
                 std::size_t shift) {
  Compared result;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const FidelityReport report = CompareFidelity({&a[i], 1}, {&b[(i + shift) % b.size()], 1});
    if (i == 0) {
      result.first = report.channels;
      result.rmse.resize(report.channels.size());
      result.correlation = result.range = result.rmse;
    }
    for (std::size_t c = 0; c < result.first.size(); ++c) {
      result.rmse[c].Add(report.channels.at(c).rmse);
      result.correlation[c].Add(report.channels[c].correlation);
      result.range[c].Add(report.channels[c].range);
    }
  }
  return result;
}

Agreement AgreementOf(const Compared& compared, std::size_t channel) {
  return {compared.rmse[channel].mean(), compared.rmse[channel].std(),
          compared.correlation[channel].mean()};
}

constexpr std::size_t kPoints = 400;  // points per cycle

// Returns one channel of each run: the first `cycles` cycles, resampled by phase, or the first
// `length` samples of a task without phase.
using Series = std::vector<std::vector<double>>;
Series SeriesOf(const std::vector<FidelitySignals>& runs, std::size_t channel, std::size_t cycles,
                std::size_t length) {
  Series series(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::vector<double>& samples = runs[i].channels.at(channel).samples;
    if (cycles == 0)
      series[i].assign(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(length));
    const std::vector<double> phase =
        cycles > 0 ? CyclePhase(runs[i].path_x, runs[i].path_y) : std::vector<double>();
    for (std::size_t k = 0; k < cycles; ++k) {
      const std::vector<double> cycle = CutCycle(samples, phase, k, kPoints);
      series[i].insert(series[i].end(), cycle.begin(), cycle.end());
    }
  }
  return series;
}

// Tests for each channel whether the real runs can be distinguished from the emulated runs.
std::vector<SameKindTest> TestSameKinds(const std::vector<FidelitySignals>& a,
                                        const std::vector<FidelitySignals>& b) {
  std::size_t cycles = SIZE_MAX, length = SIZE_MAX;
  for (const auto* side : {&a, &b})
    for (const FidelitySignals& run : *side) {
      cycles = std::min(cycles, CyclesIn(CyclePhase(run.path_x, run.path_y)));
      length = std::min(length, run.path_x.size());
    }
  std::vector<SameKindTest> tests;
  for (std::size_t c = 0; c < a[0].channels.size(); ++c)
    tests.push_back(TestSameKind(SeriesOf(a, c, cycles, length), SeriesOf(b, c, cycles, length)));
  return tests;
}

RealCobot RealOf(const IdentifyLoopOptions& options, int joints) {
  RealCobot real = options.real;
  if (!real.viscous.empty() || !real.coulomb.empty()) return real;
  const RealCobot drawn = DrawRealCobot(joints, real.seed);
  real.viscous = drawn.viscous;
  real.coulomb = drawn.coulomb;
  return real;
}

}  // namespace

IdentifyLoopResult IdentifyLoop(const Scenario& excitation, const Scenario& task,
                                const IdentifyLoopOptions& options) {
  if (options.seeds < 2) throw InputError("The loop needs at least two seeds.");
  Steps steps(1 + 3 * options.seeds, options.progress);
  IdentifyLoopResult result;
  result.seeds = options.seeds;
  result.first_seed = options.first_seed;
  result.nominal = task.cobot.joint_friction;
  result.real = RealOf(options, static_cast<int>(excitation.cobot.posture.size()));

  Identifier identifier(excitation);
  TorqueNoise noise(result.real);
  Run(MakeReal(excitation, result.real, options.folder), [&](TickRecord record) {
    noise.Add(&record);
    identifier.Add(record);
  });
  result.identification = identifier.Finish();
  steps.Next();
  const Scenario after = WithFriction(task, result.identification);
  result.found = after.cobot.joint_friction;

  const auto count = static_cast<std::uint64_t>(options.seeds);
  const auto real = RunsOf(MakeReal(task, result.real, options.folder), options.first_seed,
                           options.seeds, &steps);
  const auto emulated = [&](const Scenario& s) {
    return RunsOf(s, options.first_seed + count, options.seeds, &steps);
  };
  const Compared repeat = Compare(real, real, 1);
  const auto runs_nominal = emulated(task), runs_found = emulated(after);
  const Compared with_nominal = Compare(real, runs_nominal, 0);
  const Compared with_found = Compare(real, runs_found, 0);
  const auto same_nominal = TestSameKinds(real, runs_nominal);
  const auto same_found = TestSameKinds(real, runs_found);
  for (std::size_t c = 0; c < repeat.first.size(); ++c) {
    result.axes.push_back({repeat.first[c].name, repeat.first[c].unit, repeat.range[c].mean(),
                           AgreementOf(repeat, c), AgreementOf(with_nominal, c),
                           AgreementOf(with_found, c), same_nominal.at(c), same_found.at(c)});
  }
  return result;
}

}  // namespace predictor
