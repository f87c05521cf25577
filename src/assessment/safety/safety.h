// Judges whether the collaboration was safe for the person: what the hands felt, how the stops
// loaded the joints, what could happen after letting go, and what this rig cannot show.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assessment/safety/cobot_margins.h"
#include "assessment/safety/hand_exposure.h"
#include "assessment/safety/letting_go.h"
#include "assessment/safety/stop_loads.h"

namespace predictor::assessment {

// Collects the records of a run.
class SafetyCollector {
 public:
  // `outline`: see SceneMotion. `cobot` is the model of the virtual cobot. Null: not known.
  explicit SafetyCollector(const Scenario& scenario, std::vector<OutlinePoint> outline = {},
                           std::shared_ptr<const RobotModel> cobot = nullptr);
  // Adds the next record, in order.
  void Add(const TickRecord& record);

  const HandExposure& exposure() const { return exposure_; }
  const StopWindows& stops() const { return stops_; }
  const SceneMotion& scene() const { return scene_; }
  const CobotMargins& margins() const { return margins_; }

  // The largest values of both hands in RUN: the force [N], the torque [N·m], and the speeds of the
  // virtual handles [m/s], [rad/s].
  struct LargestValue {
    double value = 0;
    std::uint8_t event = 0;  // TickRecord::latest_event at this time
  };
  struct Largest {
    LargestValue force, torque, speed, rotation_speed;
  };
  const Largest& largest() const { return largest_; }

 private:
  HandExposure exposure_;
  StopWindows stops_;
  SceneMotion scene_;
  CobotMargins margins_;
  Largest largest_;
};

// A limit up to which the rig renders a quantity, and the largest value of this quantity in the
// run.
struct RigLimit {
  std::string what;  // "force of a hand"
  Unit unit;
  double limit = 0, reached = 0;  // SI
  std::string event;  // hazard that had begun last when the value was largest; empty: none
  // The value without this limit may be larger, because the emulator stopped the run or slowed the
  // handles down.
  bool censored() const { return reached >= limit; }
};

struct SafetyAssessment {
  bool simulated = false;        // the operator
  std::vector<Result> exposure;  // measured
  std::vector<StopJudgement> stops;
  Separation separation;
  std::optional<Drop> drop;
  std::optional<UnintendedContact> contact;
  std::vector<Margin> margins;  // modelled
  std::vector<RigLimit> rig;
  std::vector<NotEvaluable> not_evaluable;
};

struct SafetyOptions {
  bool intervals = true;              // whether to compute 90 % intervals of the loads during stops
  std::optional<SceneMasses> masses;  // empty: not known
  std::optional<ergonomics::ContactLimits> limits;  // empty: the user gave none
};

// Throws InputError if no simulated time passed.
SafetyAssessment JudgeSafety(const Scenario& scenario, const PersonSetup& setup,
                             const SafetyCollector& run, const SafetyOptions& options);

}  // namespace predictor::assessment
