// Collects the equations of motion of a cobot's joints, averaged over windows of a run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/record.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "models/torque_regressor.h"
#include "scenario/scenario.h"

namespace predictor {

// The equations of one joint. Each row is y = x · parameters, averaged over a window. The columns
// are the speed [rad/s], the sign of the speed, and then the 10 inertial parameters of each body
// and of the load.
struct JointRows {
  std::vector<long> window;  // number of the window in the run; windows overlap by half
  std::vector<double> y;     // [N·m]
  std::vector<double> x;     // row by row
  std::array<double, 2> moving = {0, 0};  // time for which it turned in each direction [s]
  std::vector<float> speed;               // speeds while it turned [rad/s]
};

inline constexpr int kFrictionColumns = 2;
// A joint that is slower than the first speed may be at rest due to friction. A joint that is
// faster than the second speed certainly turns [rad/s].
inline constexpr double kStill = 0.002;
inline constexpr double kTurning = 0.02;

class RowBuilder {
 public:
  // `window` is in [s].
  RowBuilder(const Scenario& nominal, double window);

  // Adds a tick. Ticks that are not finite or are out of order are skipped.
  void Add(const TickRecord& record);

  const RobotModel& robot() const { return *robot_; }
  const ObjectModel& load() const { return load_; }
  const Eigen::VectorXd& link_parameters() const { return regressor_.parameters(); }
  int columns() const { return kFrictionColumns + 10 * robot_->dof() + 10; }
  const std::vector<JointRows>& rows() const { return rows_; }
  // Returns the duration of the ticks used [s].
  double duration() const { return static_cast<double>(used_) * dt_; }
  std::uint64_t not_finite() const { return not_finite_; }  // number of skipped ticks
  int recorded_joints() const { return recorded_joints_; }  // joints of the last tick; 0: none yet

 private:
  // The values of one tick, which all belong to the same time.
  struct Sample {
    std::uint64_t tick = 0;
    bool ran = false;
    JointVector q, torque;  // [rad], [N·m]
    Pose X_WO;
    Twist V_WE;
    std::array<Vector3, kHands> p_WD;
    std::array<Wrench, kHands> F_D_W;  // wrench of hand and coupling
    bool IsFinite() const;
  };
  // A window that is being filled.
  struct Window {
    long index = -1;
    int ticks = 0;
    Eigen::MatrixXd x;  // one row per joint
    Eigen::VectorXd y;
    Eigen::VectorXd still;  // share of the weight during which the joint may have been at rest
  };

  Sample Take(const TickRecord& record) const;
  void AddEquation(const Sample& before, const Sample& now, const Sample& after);
  void AddLoad(const Sample& before, const Sample& now, const Sample& after);
  void Accumulate(const JointVector& v, std::uint64_t tick);
  void Close(Window* window);

  const AttachmentSpec attachment_;
  const double gravity_;  // [m/s²]
  const double dt_;       // [s]
  const int ticks_;       // ticks per window, even
  const int hop_;         // interval of the windows [ticks]
  std::shared_ptr<const RobotModel> robot_;
  ObjectModel load_;
  RobotData data_;
  TorqueRegressor regressor_;
  FrameId end_effector_, A_;    // A: the attachment on the cobot
  std::vector<double> weight_;  // Hann window, sum 1

  std::array<Sample, 3> last_;  // the third is the newest
  bool any_ = false;            // the newest sample exists
  int consecutive_ = 0;         // number of consecutive samples, at most 3
  std::array<Window, 2> open_;
  Eigen::MatrixXd x_;  // current equation, without friction
  Eigen::VectorXd y_;
  std::vector<JointRows> rows_;
  std::uint64_t used_ = 0, not_finite_ = 0;  // number of used ticks; number of skipped ticks
  int recorded_joints_ = 0;
};

}  // namespace predictor
