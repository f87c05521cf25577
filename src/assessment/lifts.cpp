#include "assessment/lifts.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

// Samples of a rise: between departure and arrival the object moves, and its lowest and its highest
// height may be earlier and later.
struct Rise {
  std::size_t lowest = 0, from = 0, to = 0, highest = 0;
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
      rises.push_back({low, DepartureAt(middle, low, high), ArrivalAt(middle, low, high), high});
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

void Judge(const LiftingWork& work, double per_minute, Lift* lift) {
  ergonomics::LiftTask& whole = lift->task;
  whole.mean_load = whole.max_load = work.object_mass;
  whole.origin = lift->origin;
  whole.destination = lift->destination;
  whole.frequency = per_minute;
  whole.duration = work.duration;
  whole.coupling = work.coupling;
  if (!lift->lowered) lift->niosh = ergonomics::AssessAssistedLift(whole, lift->vertical_force);
  const ergonomics::VerticalHandling task = {
      .reach = std::max(lift->origin.horizontal, lift->destination.horizontal),
      .mid_height = (lift->origin.height + lift->destination.height) / 2,
      .travel = std::abs(lift->destination.height - lift->origin.height),
      .frequency = per_minute};
  lift->acceptable = lift->lowered ? ergonomics::AcceptableLower(task, work.sex)
                                   : ergonomics::AcceptableLift(task, work.sex);
  lift->share_that_accepts =
      lift->acceptable.ShareThatAccepts(std::max(0.0, lift->vertical_force) / kStandardGravity);
}

using Middles = std::vector<std::optional<Vector3>>;

Middles MiddlesOf(std::span<const PersonSample> samples, const person::Stance& stance) {
  Middles middles;
  middles.reserve(samples.size());
  for (const PersonSample& sample : samples) middles.push_back(MiddleOf(sample, stance));
  return middles;
}

// Appends the lifts, or the lowerings, which are rises of the mirrored heights.
void AppendLifts(const Middles& middles, std::span<const PersonSample> samples, bool lowered,
                 const LiftingWork& work, std::vector<Lift>* lifts) {
  Middles heights = middles;
  if (lowered)
    for (auto& middle : heights)
      if (middle) middle->z() = -middle->z();
  const std::vector<Rise> rises = RisesOf(heights, samples);
  const double minutes = static_cast<double>(samples.size()) / kSampleRate / 60;
  for (const Rise& rise : rises) {
    Lift lift;
    lift.lowered = lowered;
    const auto& hands = samples[rise.from].body.hands;
    lift.one_hand = !hands[0].present || !hands[1].present;
    lift.begin = samples[rise.from].body.time;
    lift.end = samples[rise.to].body.time;
    lift.origin = PlaceOf(*middles[rise.from]);
    lift.destination = PlaceOf(*middles[rise.to]);
    lift.origin.height = middles[rise.lowest]->z();
    lift.destination.height = middles[rise.highest]->z();
    lift.vertical_force = MeanVerticalForce(samples.subspan(rise.from, rise.to - rise.from + 1));
    Judge(work, static_cast<double>(rises.size()) / minutes, &lift);
    lifts->push_back(lift);
  }
}

}  // namespace

std::vector<Lift> LiftsOf(std::span<const PersonSample> samples, const person::Stance& stance,
                          const LiftingWork& work) {
  const Middles middles = MiddlesOf(samples, stance);
  std::vector<Lift> lifts;
  for (const bool lowered : {false, true}) AppendLifts(middles, samples, lowered, work, &lifts);
  std::ranges::stable_sort(lifts, {}, &Lift::begin);
  return lifts;
}

LiftingJob JobOf(std::span<const Lift> lifts, double minutes) {
  std::vector<ergonomics::LiftTask> carried, whole;
  for (const Lift& lift : lifts) {
    if (lift.lowered || lift.one_hand) continue;
    ergonomics::LiftTask task = lift.task;
    task.frequency = 1 / minutes;
    whole.push_back(task);
    task.mean_load = task.max_load = std::max(0.0, lift.vertical_force / kStandardGravity);
    carried.push_back(task);
  }
  return {whole.size(), minutes, ergonomics::CompositeLiftingIndex(carried),
          ergonomics::CompositeLiftingIndex(whole)};
}

std::size_t ExertionsOf(std::span<const PersonSample> samples, std::size_t hand,
                        std::span<const Lift> lifts) {
  std::size_t exertions = 0;
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end + 1) {
    end = begin;
    while (end < samples.size() && samples[end].body.hands[hand].present) ++end;
    if (end == begin) continue;
    const double from = samples[begin].body.time, to = samples[end - 1].body.time;
    const auto moves = std::ranges::count_if(
        lifts, [&](const Lift& lift) { return lift.begin >= from && lift.begin <= to; });
    exertions += std::max<std::size_t>(1, static_cast<std::size_t>(moves));
  }
  return exertions;
}

double HorizontalTravel(std::span<const PersonSample> samples, const person::Stance& stance) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vector3 low = Vector3::Constant(kFar), high = Vector3::Constant(-kFar);
  for (const auto& middle : MiddlesOf(samples, stance)) {
    if (!middle) continue;
    low = low.cwiseMin(*middle);
    high = high.cwiseMax(*middle);
  }
  return low.x() > high.x() ? 0 : std::hypot(high.x() - low.x(), high.y() - low.y());
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
