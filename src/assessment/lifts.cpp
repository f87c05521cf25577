#include "assessment/lifts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/types.h"

namespace predictor::assessment {
namespace {

// Returns the point midway between the gripping hands, in S.
std::optional<Vector3> MiddleOf(const PersonSample& sample, const person::Stance& stance) {
  Vector3 sum = Vector3::Zero();
  int n = 0;
  for (const person::HandSample& hand : sample.body.hands) {
    if (!hand.present) continue;
    sum += hand.X_WD.p;
    ++n;
  }
  if (n == 0) return {};
  return stance.X_WS.Inverse() * Vector3(sum / n);
}

ergonomics::HandPlace PlaceOf(const Vector3& middle) {
  return {.horizontal = std::hypot(middle.x(), middle.y()),
          .height = middle.z(),
          .asymmetry = std::abs(std::atan2(middle.y(), middle.x()))};
}

// Returns the first sample at which the height is close to its maximum. After this sample, the
// object may move at this height for a long time.
std::size_t ArrivalAt(const std::vector<std::optional<Vector3>>& middle, std::size_t low,
                      std::size_t high) {
  while (low < high && middle[low]->z() < middle[high]->z() - kReversal / 2) ++low;
  return low;
}

struct Rise {
  std::size_t from = 0, to = 0;  // samples
};

// Returns the last sample before the object leaves its lowest height. The object may have stayed at
// this height for some time.
std::size_t DepartureAt(const std::vector<std::optional<Vector3>>& middle, std::size_t low,
                        std::size_t high) {
  std::size_t last = low;
  for (std::size_t i = low; i < high; ++i)
    if (middle[i]->z() < middle[low]->z() + kReversal / 2) last = i;
  return last;
}

// Finds rises between turning points. The search restarts where no hand or a different hand holds a
// handle.
std::vector<Rise> RisesOf(const std::vector<std::optional<Vector3>>& middle,
                          std::span<const PersonSample> samples) {
  std::vector<Rise> rises;
  std::size_t low = 0, high = 0;
  bool holding = false, rising = false;
  const auto height = [&](std::size_t i) { return middle[i]->z(); };
  const auto close = [&] {
    if (holding && rising && height(high) - height(low) >= kMinLift)
      rises.push_back({DepartureAt(middle, low, high), ArrivalAt(middle, low, high)});
    rising = false;
  };
  for (std::size_t i = 0; i < middle.size(); ++i) {
    if (!middle[i] || !samples[i].continues) {
      close();
      holding = false;
      if (!middle[i]) continue;
    }
    if (!holding) {
      low = high = i;
      holding = true;
    }
    if (height(i) > height(high)) high = i;
    if (!rising && height(i) < height(low)) low = high = i;
    if (height(high) - height(low) > kReversal) rising = true;
    if (rising && height(high) - height(i) > kReversal) {
      close();
      low = high = i;
    }
  }
  close();
  return rises;
}

double MeanVerticalForce(std::span<const PersonSample> samples) {
  double sum = 0;
  for (const PersonSample& sample : samples)
    for (const person::HandSample& hand : sample.body.hands)
      if (hand.present) sum += hand.F_D_W[2];
  return sum / static_cast<double>(samples.size());
}

void Assess(double object_mass, double per_minute, Sex sex, Lift* lift) {
  ergonomics::LiftTask whole;
  whole.mean_load = whole.max_load = object_mass;
  whole.origin = lift->origin;
  whole.destination = lift->destination;
  whole.frequency = per_minute;
  lift->niosh = ergonomics::AssessAssistedLift(whole, lift->vertical_force);
  const ergonomics::VerticalHandling task = {
      .reach = std::max(lift->origin.horizontal, lift->destination.horizontal),
      .mid_height = (lift->origin.height + lift->destination.height) / 2,
      .travel = lift->destination.height - lift->origin.height,
      .frequency = per_minute};
  lift->acceptable = ergonomics::AcceptableLift(task, sex);
  lift->share_that_accepts =
      lift->acceptable.ShareThatAccepts(std::max(0.0, lift->vertical_force) / kStandardGravity);
}

}  // namespace

std::vector<Lift> LiftsOf(std::span<const PersonSample> samples, const person::Stance& stance,
                          double object_mass, Sex sex) {
  std::vector<std::optional<Vector3>> middle;
  middle.reserve(samples.size());
  for (const PersonSample& sample : samples) middle.push_back(MiddleOf(sample, stance));
  const std::vector<Rise> rises = RisesOf(middle, samples);
  const double minutes = static_cast<double>(samples.size()) / kSampleRate / 60;
  std::vector<Lift> lifts;
  for (const Rise& rise : rises) {
    Lift lift;
    const auto& hands = samples[rise.from].body.hands;
    lift.one_hand = !hands[0].present || !hands[1].present;
    lift.begin = samples[rise.from].body.time;
    lift.end = samples[rise.to].body.time;
    lift.origin = PlaceOf(*middle[rise.from]);
    lift.destination = PlaceOf(*middle[rise.to]);
    lift.vertical_force = MeanVerticalForce(samples.subspan(rise.from, rise.to - rise.from + 1));
    Assess(object_mass, static_cast<double>(rises.size()) / minutes, sex, &lift);
    lifts.push_back(lift);
  }
  return lifts;
}

void AddDamageOfLifts(std::span<const PersonSample> samples, std::span<const double> moment,
                      std::vector<Lift>* lifts) {
  for (Lift& lift : *lifts) {
    double largest = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples[i].body.time >= lift.begin && samples[i].body.time <= lift.end)
        largest = std::max(largest, moment[i]);
    lift.moment = largest;
    lift.day_share =
        ergonomics::ShareOfReferenceDay(ergonomics::LiftDamage(largest), ergonomics::kLiftRisk);
  }
}

}  // namespace predictor::assessment
