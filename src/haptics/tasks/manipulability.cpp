// −α J_m: increases the translational manipulability of each arm.
#include <algorithm>
#include <cmath>

#include "haptics/registry.h"

namespace predictor {
namespace {

class Manipulability final : public Task {
 public:
  explicit Manipulability(const RenderSetup& setup)
      : Task(0), weight_(setup.scenario.rendering.manipulability) {}

  void Update(const RenderContext& context, JointObjective* joints) noexcept override {
    for (int i = 0; i < kHands; ++i) {
      const RenderArm& arm = context.arms[i];
      if (!arm.present) continue;
      if (weight_ == 0) {  // without weight, only the recorded value is computed, which is cheap
        const auto J = context.J[i].topRows<3>();
        const Matrix3 JJt = J.lazyProduct(J.transpose());
        value_[i] = std::sqrt(std::max(0.0, JJt.determinant()));
        continue;
      }
      JointVector gradient;
      arm.data->ManipulabilityGradient(*arm.model, arm.handle, &value_[i], &gradient);
      joints->gradient.segment(context.offset[i], gradient.size()) += weight_ * gradient;
    }
  }

  void Publish(const double*, RenderResult* result) const noexcept override {
    result->manipulability = value_;
  }

 private:
  double weight_;  // α
  std::array<double, kHands> value_ = {};
};

}  // namespace

const TaskKind tasks::kManipulability =
    TaskKindOf<Manipulability>("manipulability", "the arms stay away from singular postures");

}  // namespace predictor
