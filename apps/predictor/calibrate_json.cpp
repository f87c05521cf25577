#include "calibrate_json.h"

#include <span>

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

Json EstimateJson(const Estimate& estimate) {
  return {{"value", estimate.value}, {"half_width_95", estimate.half_width}};
}

Json EstimatesJson(std::span<const Estimate> estimates) {
  Json list = Json::array();
  for (const Estimate& estimate : estimates) list.push_back(EstimateJson(estimate));
  return list;
}

Json VectorJson(const Vector3& values) { return {values.x(), values.y(), values.z()}; }

}  // namespace

Json ToJson(const commissioning::HandleCalibration& found) {
  const std::span<const Estimate, 6> bias(found.bias);
  return {{"poses", found.poses},
          {"mass_kg", EstimateJson(found.mass)},
          {"center_of_mass_m", EstimatesJson(found.center_of_mass)},
          {"force_bias_n", EstimatesJson(bias.first<3>())},
          {"torque_bias_nm", EstimatesJson(bias.last<3>())},
          {"force_drift_n_s", VectorJson(found.drift.head<3>())},
          {"torque_drift_nm_s", VectorJson(found.drift.tail<3>())},
          {"force_residual_n", VectorJson(found.residual.head<3>())},
          {"torque_residual_nm", VectorJson(found.residual.tail<3>())}};
}

Json ToJson(const commissioning::BaseCalibration& found, const Pose& X_WB) {
  return {{"points", found.distances.size()},
          {"xyz_m", VectorJson(X_WB.p)},
          {"rpy_rad", VectorJson(RpyOf(X_WB.q))},
          {"position_half_width_95_m", VectorJson(found.position)},
          {"rotation_half_width_95_rad", VectorJson(found.rotation)},
          {"residual_m", found.residual},
          {"distances_m", found.distances}};
}

Json ToJson(const commissioning::LoopFit& found) {
  return {{"bandwidth_hz", EstimateJson(found.bandwidth)},
          {"damping_ratio", EstimateJson(found.damping_ratio)},
          {"delay_s", EstimateJson(found.delay)},
          {"gain", EstimateJson(found.gain)},
          {"lag_s", found.lag()},
          {"noise_rad", found.noise},
          {"residual_rad", found.residual},
          {"misfit_ratio", found.misfit},
          {"late_ticks_ratio", found.gaps.late_share()},
          {"lost_samples_ratio", found.gaps.lost_share()}};
}

}  // namespace predictor
