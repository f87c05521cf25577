#include "simulation/event_sequence.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "simulation/hazards/hazards.h"

namespace predictor {
namespace {

#define PREDICTOR_ENTRY(kind) &hazards::kind,
constexpr const ParameterKind* kHazardKinds[] = {PREDICTOR_HAZARDS(PREDICTOR_ENTRY)};
#undef PREDICTOR_ENTRY

// This runs when the program starts, so that every scenario is read with their parameters.
[[maybe_unused]] const bool kDeclared = (DeclareHazards(kHazardKinds), true);

constexpr double kGrip = 0.5;  // force of a hand that grips [N]

// Returns the number of the entry of `bodies` that an event names by its parameter `key`. `what` is
// the word for such a body, and `missing` the advice if none has a name.
template <class Bodies>
int NumberOf(const Scenario& scenario, std::size_t event, const char* key, const Bodies& bodies,
             const char* what, const char* missing) {
  const std::string path = "events." + std::to_string(event) + "." + key;
  const YamlNode* named = scenario.events[event].parameters.Find(key);
  const std::string name = named ? named->text : "";
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name.empty()) continue;
    if (bodies[i].name == name) return static_cast<int>(i);
    names.push_back(bodies[i].name);
  }
  throw InputError::At(path, path + ": no " + what + " has the name " + Quote(name) + ". " +
                                 (names.empty() ? missing : Suggestion(name, names)));
}

// Returns the fixture that an event names, as the bit with the fixture's number.
std::uint64_t FixtureOf(const Scenario& scenario, std::size_t event, HazardNeeds needs) {
  if (needs != HazardNeeds::kFixture) return 0;
  return std::uint64_t{1} << NumberOf(
             scenario, event, "fixture", scenario.environment.fixtures, "fixture",
             "In environment.fixtures, give a name to the fixture that appears.");
}

// Returns the number of the movable object that an event names, or −1 for none.
int MovableOf(const Scenario& scenario, std::size_t event, HazardNeeds needs) {
  if (needs != HazardNeeds::kMovable) return -1;
  return NumberOf(scenario, event, "object", scenario.environment.objects, "movable object",
                  "Add the movable object to environment.objects.");
}

}  // namespace

const HazardKind* FindHazard(const std::string& name) noexcept {
  return static_cast<const HazardKind*>(FindKind(kHazardKinds, name));
}

EventSequence::EventSequence(const Scenario& scenario) {
  for (std::size_t i = 0; i < scenario.events.size(); ++i) {
    const EventSpec& spec = scenario.events[i];
    const std::string path = "events." + std::to_string(i);
    const HazardKind* kind = FindHazard(spec.event);
    if (kind == nullptr)
      throw InputError::At(path + ".event", path + ".event: there is no event " +
                                                Quote(spec.event) + ". " +
                                                Suggestion(spec.event, NamesOf(kHazardKinds)));
    Problems problems;
    auto parameters = ReadParameters(*kind, {spec.parameters, path}, &problems);
    problems.ThrowIfAny();
    const auto place = std::find(std::begin(kHazardKinds), std::end(kHazardKinds), kind);
    // Each event has its own random stream, so that an additional event does not change the times
    // of the other events.
    events_.push_back({kind, std::move(parameters), spec.trigger, spec.duration,
                       RandomStream(scenario.seed, "event " + std::to_string(i)),
                       static_cast<std::uint8_t>(place - std::begin(kHazardKinds) + 1),
                       FixtureOf(scenario, i, kind->needs), MovableOf(scenario, i, kind->needs)});
    Event& event = events_.back();
    kind->disturb(*event.parameters, 0, &event.first);
  }
  Reset();
}

Vector6 EventSequence::set_point_shift(std::size_t i) const { return events_[i].first.set_point; }

double EventSequence::longest_delay() const {
  double sum = 0;
  for (const Event& event : events_) sum += event.first.delay;
  return sum;
}

bool EventSequence::loosens_attachment() const {
  return std::ranges::any_of(events_, [](const Event& event) {
    return event.first.grip != GripLimits() || event.first.gripper.was_opened();
  });
}

bool EventSequence::releases_object() const {
  return std::ranges::any_of(events_,
                             [](const Event& event) { return event.first.gripper.was_opened(); });
}

bool EventSequence::picks_up() const {
  return std::ranges::any_of(events_, [](const Event& event) { return event.movable >= 0; });
}

std::uint64_t EventSequence::obstacles() const {
  std::uint64_t all = 0;
  for (const Event& event : events_) all |= event.obstacles;
  return all;
}

std::uint64_t EventSequence::Absent(std::uint16_t active, std::uint64_t absent,
                                    std::uint64_t touched) const noexcept {
  std::uint64_t present = 0;
  for (std::size_t i = 0; i < events_.size(); ++i)
    if ((active >> i & 1U) != 0) present |= events_[i].obstacles;
  return AbsentFixtures(obstacles(), present, absent, touched);
}

void EventSequence::Reset() noexcept {
  placed_ = false;
  time_ = 0;
  latest_ = 0;
  for (Event& event : events_) {
    event.begun = event.ended = false;
    DrawTime(&event);
  }
}

// The distribution of the time is uniform in the part of the window that has not passed yet.
void EventSequence::DrawTime(Event* event) const noexcept {
  const TriggerSpec& trigger = event->trigger;
  const double passed = std::clamp(time_ - trigger.after, 0.0, trigger.window);
  event->earliest = trigger.after + (passed + (trigger.window - passed) * event->random.Uniform());
}

bool EventSequence::Begins(const Event& event, const WorldState& world,
                           const WorldInput& input) const noexcept {
  const TriggerSpec& trigger = event.trigger;
  if (world.time < event.earliest) return false;
  if (trigger.place &&
      (world.object.X_W.p - object_start_ - trigger.place->center).norm() > trigger.place->radius)
    return false;
  double least = HUGE_VAL, most = 0;
  for (int h = 0; h < kHands; ++h) {
    if (!input.present.Has(h)) continue;
    const double force = input.F_H_W[static_cast<std::size_t>(h)].head<3>().norm();
    least = std::min(least, force);
    most = std::max(most, force);
  }
  return (!trigger.gripping || least >= kGrip) && (!trigger.force || most > *trigger.force);
}

Disturbance EventSequence::Update(const WorldState& world, const WorldInput& input) noexcept {
  if (!placed_) object_start_ = world.object.X_W.p;
  placed_ = true;
  time_ = world.time;
  for (Event& event : events_) {
    if (!event.begun && Begins(event, world, input)) {
      event.begun = true;
      event.begin = time_;
      latest_ = event.number;
    }
    // Rounding errors must not add a tick.
    if (event.begun && event.duration > 0 && time_ - event.begin > event.duration - 1e-9)
      event.ended = true;
  }
  return disturbance();
}

Disturbance EventSequence::disturbance() const noexcept {
  Disturbance d;
  for (const Event& event : events_) {
    if (!event.begun || event.ended) continue;
    AddTo(&d, event, time_ - event.begin);
  }
  return d;
}

void EventSequence::AddTo(Disturbance* d, const Event& event, double elapsed) const noexcept {
  const double picked = d->pick_up.picked;
  event.kind->disturb(*event.parameters, elapsed, d);
  if (d->pick_up.picked < picked) d->pick_up.movable = event.movable;
  d->obstacles |= event.obstacles;
}

std::uint16_t EventSequence::active() const noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < events_.size(); ++i)
    if (events_[i].begun && !events_[i].ended) bits |= 1U << i;
  return static_cast<std::uint16_t>(bits);
}

void EventSequence::Archive(StateArchive& a) noexcept {
  if (events_.empty()) return;
  for (Event& event : events_)
    a(event.begun, event.ended, event.begin, event.random, event.earliest);
  a(object_start_, placed_, time_, latest_);
  if (a.seed())
    for (Event& event : events_)
      if (!event.begun) DrawTime(&event);
  if (latest_ > std::size(kHazardKinds)) a.Fail();
}

}  // namespace predictor
