// Measures how close the virtual cobot comes to the limits of its joints and to singular postures.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/record.h"
#include "evaluation/metric.h"
#include "scenario/scenario.h"

namespace predictor {
class RobotModel;
class RobotData;
}  // namespace predictor

namespace predictor::assessment {

// The smallest value of a quantity in RUN.
struct Margin {
  std::string what;  // "distance of a joint from its limit"
  Unit unit;
  double smallest = 0;  // SI
  double time = 0;      // run time [s]
  std::string joint;    // joint of the cobot; empty: none
};

// Evaluates the joints that move the end-effector, 100 times a second.
class CobotMargins {
 public:
  // A null `cobot` means that the model of the cobot is not known.
  CobotMargins(const Scenario& scenario, std::shared_ptr<const RobotModel> cobot);
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  bool known() const { return cobot_ != nullptr; }
  // Returns the quantities that have a value:
  // - the distance of a rotating joint, and of a sliding joint, from its nearest limit. The
  //   distance is negative beyond the limit. Joints without limits have no distance.
  // - the smallest singular value of the end-effector's Jacobian, whose rotation is weighted by
  //   rendering.characteristic_length [m]. If fewer than six joints move the end-effector, it is
  //   the smallest of as many singular values as there are joints.
  // - the translational manipulability √det(J Jᵀ) (Yoshikawa 1985), in m³ for rotating joints
  // - the distance of the nearest link pair of the arms, which the record contains
  std::vector<Margin> results() const;

 private:
  enum Kind : std::size_t {
    kRotating,
    kSliding,
    kSingularValue,
    kManipulability,
    kLinkPair,
    kKinds
  };
  void Lower(Kind kind, double value, double time, int joint = -1);
  void Judge(const TickRecord& record);

  struct Smallest {
    double value;
    double time;
    int joint;
  };
  std::shared_ptr<const RobotModel> cobot_;
  std::shared_ptr<RobotData> data_;
  std::string end_effector_;
  double length_;                   // characteristic length [m]
  std::size_t stride_, count_ = 0;  // ticks from one evaluation to the next; ticks in RUN
  std::array<Smallest, kKinds> smallest_;
};

}  // namespace predictor::assessment
