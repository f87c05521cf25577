// Counts the ticks in which the cobot is at or beyond the limits of its joints.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "evaluation/metrics/registry.h"
#include "models/arm_model.h"

namespace predictor::metrics {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

class CobotLimits final : public Metric {
 public:
  explicit CobotLimits(const Scenario& s) {
    if (s.cobot.model.empty()) return;
    try {
      const auto robot = LoadCobotModel(s);
      limits_ = Limits{EffortLimit(s.cobot, *robot), robot->velocity_limit()};
    } catch (const InputError&) {
      // The model of a recording may be missing. In this case, the limits of the cobot are unknown.
    }
  }

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran || !limits_) return;
    const auto dof = std::min<Eigen::Index>(record.cobot_dof, limits_->effort.size());
    bool at_effort = false, above_velocity = false;
    for (Eigen::Index j = 0; j < dof; ++j) {
      const auto i = static_cast<std::size_t>(j);
      at_effort |= std::fabs(record.cobot_torque[i]) >= limits_->effort[j];
      above_velocity |= std::fabs(record.cobot_v[i]) > limits_->velocity[j];
    }
    effort_ += at_effort;
    velocity_ += above_velocity;
  }

  void AppendTo(std::vector<Result>* results) const override {
    const auto add = [&](const char* key, const char* label, const char* meaning,
                         std::uint64_t count) {
      results->push_back({.path = std::string("cobot_limits.") + key,
                          .group = "Cobot's joints",
                          .label = label,
                          .meaning = meaning,
                          .value = limits_ ? static_cast<double>(count) : kMissing,
                          .shown = count > 0});
    };
    add("effort_ticks", "ticks at an effort limit",
        "ticks in which the torque of a joint of the cobot is at its effort limit; null: the model "
        "is missing",
        effort_);
    add("velocity_ticks", "ticks above a velocity limit",
        "ticks in which a joint of the cobot is faster than the velocity limit in its URDF; null: "
        "the model is missing",
        velocity_);
  }

 private:
  struct Limits {
    JointVector effort, velocity;  // [N·m], [rad/s]; prismatic: [N], [m/s]
  };
  std::optional<Limits> limits_;
  std::uint64_t effort_ = 0, velocity_ = 0;
};

}  // namespace

const MetricKind kCobotLimits = {.make = MakeMetric<CobotLimits>};

}  // namespace predictor::metrics
