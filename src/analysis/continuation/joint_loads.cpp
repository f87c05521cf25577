#include "analysis/continuation/joint_loads.h"

#include <algorithm>
#include <cmath>

#include "analysis/parallel.h"
#include "assessment/hand_samples.h"
#include "assessment/person_chain.h"
#include "core/error.h"

namespace predictor {
namespace {

// Computes the load on the joints at `peak`. The posture solver starts at the posture of the stop.
double JointUse(const assessment::PersonSetup& setup, const TickRecord& stop,
                const TickRecord& peak) {
  std::array<assessment::PersonSample, 2> samples = {assessment::SampleOf({&stop, 1}),
                                                     assessment::SampleOf({&peak, 1})};
  samples[1].continues = false;
  if (!assessment::IsHeld(samples[0]) || !assessment::IsHeld(samples[1])) return kUndefined;
  const auto chain = assessment::RunNominal(setup, samples, {}, [](double) {});
  const assessment::Frame& frame = chain.frames.back();
  if (!frame.reached) return kUndefined;
  double use = 0;
  for (std::size_t h = 0; h < kHands; ++h)
    if (samples[1].body.hands[h].present) {
      if (!std::isfinite(frame.shoulder_use[h])) return kUndefined;  // raised above 90°
      use = std::max({use, frame.elbow_use[h], frame.shoulder_use[h]});
    }
  return use;
}

}  // namespace

void AddJointLoads(const StoppedRun& stopped, int workers, Continuation* c) {
  const auto missing = assessment::MissingForPosture(stopped.scenario);
  if (!missing.empty()) {
    c->no_joint_use = missing.front();
    return;
  }
  try {
    const assessment::PersonSetup setup = assessment::SetupOf(stopped.scenario, stopped.first);
    std::vector<ContinuedRun*> runs;
    for (ContinuedRun& run : c->runs) runs.push_back(&run);
    if (c->reference) runs.push_back(&*c->reference);
    DoInParallel(
        runs.size(), workers,
        [&](std::size_t i) {
          if (runs[i]->peak_force > 0)
            runs[i]->joint_use = JointUse(setup, stopped.stop(), runs[i]->at_peak);
        },
        [] {});
  } catch (const InputError& error) {
    c->no_joint_use = error.what();
  }
}

}  // namespace predictor
