#include "assessment/person_run.h"

namespace predictor::assessment {

PersonRun RunOf(const SampleCollector& ticks) {
  PersonRun run{ticks.samples(), {}, ticks.stopped()};
  for (std::size_t h = 0; h < kHands; ++h)
    run.handles[h] = FromRecord(ticks.first().hands[h].real.pose);
  return run;
}

PersonRun RunOf(const tracks::PersonFile& file) {
  PersonRun run;
  const auto& hands = file.track.hands;
  const std::vector<double>& times = (hands[0] ? hands[0] : hands[1])->pose.times;
  std::array<bool, kHands> seen = {};
  for (const double time : times) {
    PersonSample sample;
    sample.body.time = sample.recorded = time;
    for (std::size_t h = 0; h < kHands; ++h) {
      if (!hands[h]) continue;
      const auto p = hands[h]->pose.PositionAt(time);
      const auto q = hands[h]->pose.RotationAt(time);
      const auto F = hands[h]->WrenchAt(time);
      if (!p || !q || !F) continue;
      sample.body.hands[h] = {hands[h]->HoldsAt(time), Pose{*p, *q}, *F};
      sample.peak_force[h] = F->head<3>().norm();
      if (!seen[h]) run.handles[h] = {*p, *q};
      seen[h] = true;
    }
    const auto same = [&](std::size_t h) {
      return sample.body.hands[h].present == run.samples.back().body.hands[h].present;
    };
    sample.continues = run.samples.empty() || (same(0) && same(1));
    run.samples.push_back(sample);
  }
  return run;
}

Scenario ScenarioOf(const tracks::PersonHeader& header, const tracks::BodyTrack& track) {
  Scenario scenario;
  scenario.name = header.name;
  scenario.rate = tracks::kPersonRate;
  scenario.operator_.type = header.simulated ? "virtual" : "imported";
  scenario.operator_.body = header.body;
  scenario.operator_.stance = header.stance;
  scenario.left_handle.reset();
  scenario.right_handle.reset();
  if (track.hands[0]) scenario.left_handle.emplace().grip = header.left;
  if (track.hands[1]) scenario.right_handle.emplace().grip = header.right;
  return scenario;
}

}  // namespace predictor::assessment
