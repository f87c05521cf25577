// Hand guiding: the cobot compensates its own weight and follows the hand, τ = g.
#include "core/error.h"
#include "simulation/controllers/controllers.h"

namespace predictor {
namespace {

class GravityCompensation final : public Controller {
 public:
  void Compute(const ControllerInput& input, JointVector* torque) noexcept override {
    *torque = input.data->gravity();
  }
  double StoredEnergy(const ControllerInput&) const noexcept override { return 0; }
};

}  // namespace

std::unique_ptr<Controller> MakeGravityCompensation(const ControllerContext& context) {
  if (!context.spec.trajectory.empty()) {
    throw InputError(
        "cobot.controller.trajectory: gravity_compensation has no set-point to move. Leave the "
        "trajectory out, or choose type: cartesian_impedance.");
  }
  return std::make_unique<GravityCompensation>();
}

}  // namespace predictor
