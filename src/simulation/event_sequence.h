// The events of a scenario, which determine when each hazard begins and ends.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "core/random.h"
#include "simulation/hazards/hazard.h"

namespace predictor {

class EventSequence {
 public:
  explicit EventSequence(const Scenario& scenario);  // throws InputError

  bool empty() const { return events_.empty(); }
  std::size_t size() const { return events_.size(); }
  const HazardKind& kind(std::size_t i) const { return *events_[i].kind; }
  double duration(std::size_t i) const { return events_[i].duration; }  // [s]; 0: until the end
  // Returns the number of the movable object that an event picks up, or −1 for none.
  int movable(std::size_t i) const { return events_[i].movable; }
  Vector6 set_point_shift(std::size_t i) const;  // by which event i shifts it [m], [rad]
  double longest_delay() const;                  // sum of all that events add [s]
  bool loosens_attachment() const;  // an event lets the object slip, break loose or be put down
  bool releases_object() const;     // an event opens the gripper
  bool picks_up() const;            // an event lets the object pick up a movable object
  // The fixtures that appear through all events together. The number of a fixture is the number of
  // its bit.
  std::uint64_t obstacles() const;
  // Returns AbsentFixtures while these events are active. The number of an event is the number of
  // its bit.
  std::uint64_t Absent(std::uint16_t active, std::uint64_t absent,
                       std::uint64_t touched) const noexcept;

  // Returns to the state in which no event has begun. Draws new times for the events, because the
  // person knows the times of the last run.
  void Reset() noexcept;
  // Begins and ends events according to the state of the world. Returns their effects.
  Disturbance Update(const WorldState& world, const WorldInput& input) noexcept;
  // Returns the effects of the events that were active at the last Update.
  Disturbance disturbance() const noexcept;

  std::uint16_t active() const noexcept;  // bit: number of the event
  // Returns 1 + the number of the hazard that began last (in the order of hazards.h), or 0 if none
  // has begun.
  std::uint8_t latest() const noexcept { return latest_; }

  void Archive(StateArchive& a) noexcept;

 private:
  struct Event {
    const HazardKind* kind;
    std::unique_ptr<OwnParameters> parameters;
    TriggerSpec trigger;
    double duration;  // [s]
    RandomStream random;
    std::uint8_t number;      // 1 + that of the hazard
    std::uint64_t obstacles;  // that it lets appear: bit = number of the fixture
    int movable;              // that it picks up; −1: none
    Disturbance first = {};   // its effect when it begins
    double earliest = 0;      // [s]
    bool begun = false, ended = false;
    double begin = 0;  // [s]
  };
  void DrawTime(Event* event) const noexcept;
  void AddTo(Disturbance* d, const Event& event, double elapsed) const noexcept;
  bool Begins(const Event& event, const WorldState& world, const WorldInput& input) const noexcept;

  std::vector<Event> events_;
  Vector3 object_start_ = Vector3::Zero();
  bool placed_ = false;  // object_start_ is known
  double time_ = 0;      // of the last Update [s]
  std::uint8_t latest_ = 0;
};

}  // namespace predictor
