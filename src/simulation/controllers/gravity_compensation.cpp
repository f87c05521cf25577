// A controller for hand guiding, with the law τ = g. The cobot compensates its own weight and
// follows the hand.
#include "simulation/controllers/controllers.h"

namespace predictor::controllers {
namespace {

class GravityCompensation final : public Controller {
 public:
  GravityCompensation(const ControllerContext&, const NoParameters&) {}
  void Compute(const ControllerInput& input, JointVector* torque) noexcept override {
    *torque = input.data->gravity();
  }
  double StoredEnergy(const ControllerInput&) const noexcept override { return 0; }
};

}  // namespace

const ControllerKind kGravityCompensation = ControllerKindOf<GravityCompensation, NoParameters>(
    "gravity_compensation", "carries its own weight, follows the hand");

}  // namespace predictor::controllers
