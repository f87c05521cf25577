#include "fakes/ur/ur_controller.h"

#include <algorithm>
#include <cmath>

namespace predictor {

void UrController::Advance() {
  double largest = 0;
  for (std::size_t i = 0; i < target_.size(); ++i)
    largest = std::max(largest, std::abs(target_[i] - set_point_[i]));
  const double step = acceleration_ * cycle;
  if (largest <= step) {
    set_point_ = target_;
    return;
  }
  for (std::size_t i = 0; i < target_.size(); ++i)
    set_point_[i] += step / largest * (target_[i] - set_point_[i]);
}

}  // namespace predictor
