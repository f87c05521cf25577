#include "assessment/live_person.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "person/skeleton.h"

namespace predictor::assessment {
namespace {

using StatePoints = std::array<std::array<float, 3>, kBodyPoints>;

StatePoints PointsOf(const LiveChain& chain) {
  const person::Stance& stance = chain.setup().stance;
  const person::BodyModel& model = chain.model();
  const person::BodyVector& q = chain.newest().q;
  const person::Skeleton s = person::SkeletonOf(model, q, stance.width);
  StatePoints points{};
  const auto put = [&](BodyPoint point, const Vector3& p_S) {
    const Vector3 p = stance.X_WS * p_S;
    points[static_cast<std::size_t>(point)] = {static_cast<float>(p.x()), static_cast<float>(p.y()),
                                               static_cast<float>(p.z())};
  };
  put(BodyPoint::kPelvis, s.pelvis);
  put(BodyPoint::kL5S1, s.lower_back);
  put(BodyPoint::kNeck, s.neck);
  put(BodyPoint::kHead, s.head);
  const person::Placement at = person::Place(model, q);
  put(BodyPoint::kEyes, at.FrameOf(person::kNeckTwist) * model.anthropometry().eyes);
  using enum BodyPoint;
  constexpr BodyPoint kSides[kHands][8] = {{kLeftShoulder, kLeftElbow, kLeftWrist, kLeftHand,
                                            kLeftHip, kLeftKnee, kLeftAnkle, kLeftToes},
                                           {kRightShoulder, kRightElbow, kRightWrist, kRightHand,
                                            kRightHip, kRightKnee, kRightAnkle, kRightToes}};
  for (std::size_t h = 0; h < kHands; ++h) {
    const person::SkeletonSide& side = s.sides[h];
    const Vector3* places[] = {&side.shoulder, &side.elbow, &side.wrist, &side.knuckles,
                               &side.hip,      &side.knee,  &side.ankle, &side.toes};
    for (std::size_t k = 0; k < std::size(places); ++k) put(kSides[h][k], *places[k]);
  }
  return points;
}

bool IsBelowGround(const PersonSample& sample, const person::Stance& stance) {
  for (const person::HandSample& hand : sample.body.hands)
    if (hand.present && (stance.X_WS.Inverse() * hand.X_WD.p).z() < 0) return true;
  return false;
}

}  // namespace

LivePerson::LivePerson(const Scenario& scenario, const WorkPattern& work,
                       std::span<const tracks::StreamDescription> streams)
    : scenario_(scenario), work_(work), builder_(scenario), streams_(streams), exposure_(scenario) {
  if (const auto missing = MissingForPosture(scenario); !missing.empty())
    throw InputError(Join(missing, " "));
  person::AnthropometryOf(*scenario.operator_.body);
}

bool LivePerson::Add(const TickRecord& record) {
  if (record.tick == last_tick_) return false;
  if (record.tick < last_tick_) BeginAgain();
  last_tick_ = record.tick;
  const std::optional<PersonSample> sample = builder_.Add(record);
  if (!record.ran) return Wait(record);
  if (!sample) return false;
  if (!chain_) Begin();
  if (state_.since == 0) state_.since = sample->body.time;
  state_.tick = record.tick;
  state_.wall_ns = record.wall_ns;
  state_.run_time = sample->body.time;
  Take(*sample);
  return true;
}

void LivePerson::Begin() {
  if (!setup_) setup_ = SetupOf(scenario_, builder_.first());
  work_.strength = setup_->body.strength;
  if (streams_.has_emg())
    chain_.emplace(*setup_, work_, kLiveDelayWithEmg, [this](const PersonSample& sample) {
      return streams_.ActivationsAt(ClockOf(sample), sample.body.time, &state_);
    });
  else
    chain_.emplace(*setup_, work_);
  intervals_.emplace(*setup_, work_);
}

// Starts the evaluation again but keeps the initial places of the handles.
void LivePerson::BeginAgain() {
  builder_ = SampleBuilder(scenario_);
  held_ = {};
  chain_.reset();
  intervals_.reset();
  exposure_ = LiveExposure(scenario_);
  warnings_.Clear();
  state_ = {};
}

bool LivePerson::Wait(const TickRecord& record) {
  // The samples of a long pause would otherwise fill the memory.
  if (record.tick % 100 == 0) streams_.Convert(Seconds(record.wall_ns));
  if (state_.status == PersonStatus::kWaiting) return false;
  Rest(PersonStatus::kWaiting);
  InputStatus& heart_rate = state_.inputs[static_cast<std::size_t>(PersonInput::kHeartRate)].status;
  if (heart_rate != InputStatus::kNone) heart_rate = InputStatus::kMissing;
  state_.heart_rate = kUnknown;
  state_.tick = record.tick;
  state_.wall_ns = record.wall_ns;
  state_.run_time = record.run_time;
  return true;
}

// Returns the monotonic clock at the sample [s].
double LivePerson::ClockOf(const PersonSample& sample) const {
  return 1e-9 * static_cast<double>(builder_.start_ns()) + sample.by_clock;
}

void LivePerson::Take(PersonSample sample) {
  streams_.Update(ClockOf(sample), sample.body.time, &state_);
  const bool below = IsBelowGround(sample, setup_->stance);
  if (below)
    for (person::HandSample& hand : sample.body.hands) hand.present = false;
  if (const auto held = held_.Take(sample)) return TakeHeld(*held);
  Rest(below ? PersonStatus::kBelowGround : PersonStatus::kNoHand);
  exposure_.Add(nullptr);
  exposure_.Write(false, &state_);
}

void LivePerson::TakeHeld(PersonSample sample) {
  state_.head = head_.AddTo(&sample, ClockOf(sample), *setup_);
  streams_.AddTo(ClockOf(sample), *setup_, &sample, &state_);
  chain_->Add(sample);
  const person::Posture& posture = chain_->newest();
  state_.status = PersonStatus::kJudged;
  state_.reached = posture.reached ? 1 : 0;
  state_.miss = static_cast<float>(posture.miss());
  state_.points = PointsOf(*chain_);
  Judge(false);
  exposure_.Write(false, &state_);
}

void LivePerson::Judge(bool all) {
  for (JudgedSample judged; chain_ && chain_->Next(all, &judged);) {
    WriteFrame(judged, &state_);
    state_.load_time = judged.sample.body.time;
    state_.warnings = warnings_.Update(judged.frame, state_.load_time);
    intervals_->Add(judged, &state_);
    exposure_.Add(&judged.frame);
  }
}

// Judges the remaining samples. From this time on, the posture is unknown.
void LivePerson::Rest(PersonStatus status) {
  if (state_.status != status) {
    Judge(true);
    exposure_.Write(true, &state_);
    warnings_.Clear();
    ForgetValues(&state_);
  }
  state_.status = status;
}

}  // namespace predictor::assessment
