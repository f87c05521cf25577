#include "scenario/formulation.h"

#include "scenario/scenario.h"

namespace predictor {
namespace {

constexpr RepairEntry kTable[] = {
    {Repair::kPredictedJacobian, "predicted_jacobian", "(8), (10)",
     "Jacobians at the joint positions at which the arms will obey the command",
     "Jacobians at the measured joint positions"},
    {Repair::kRelativeTarget, "relative_target", "(10)",
     "the right handle's target is the virtual relative pose, applied to the real left handle",
     "the vector between the virtual handles in W, and equal orientations of both handles"},
    {Repair::kLead, "lead", "(9)", "the reference runs ahead by rendering.lead", "no lead"},
    {Repair::kSoftRows, "soft_rows", "(4), (5)",
     "the relative pose and the link distances yield by slacks, so that a solution always exists",
     "hard equality and hard inequalities, which may have no solution"},
    {Repair::kCoupling, "coupling", "none",
     "virtual handles feel the arms' limits beyond coupling.deadband", "no coupling"},
    {Repair::kRotationWeight, "rotation_weight", "(7)",
     "1 rad counts as rendering.characteristic_length", "1 rad counts as 1 m"},
    {Repair::kNearerHemisphere, "nearer_hemisphere", "(9), (10)", "rotations take the shorter path",
     "the sign of the quaternions decides the path"},
    {Repair::kDamperEnd, "damper_end", "(11) to (15)",
     "a velocity damper ends at the security distance",
     "below it, the damper pushes the links apart"},
    {Repair::kApproachParabola, "approach_parabola", "(11) to (15)",
     "beyond the damper's line, a parabola of constant deceleration limits the approach",
     "beyond the influence distance, the approach is unlimited"},
    {Repair::kSpeedReserve, "speed_reserve", "(14), (15)",
     "78 % of the vendor's joint speeds (0.80 × 0.98)", "the vendor's joint speeds"},
    {Repair::kAccelerationLimit, "acceleration_limit", "(13)",
     "joint accelerations are limited within the QP", "only the guard limits them, after the QP"},
    {Repair::kSingularityDamping, "singularity_damping", "(7)",
     "joint damping grows near a singularity", "constant damping of 1e-5"},
    {Repair::kHandleSpeedCap, "handle_speed_cap", "(9)",
     "reference velocities are scaled to safety.handle_speed",
     "reference velocities are used as they are"},
};
static_assert(std::size(kTable) == kRepairs);

}  // namespace

std::span<const RepairEntry> RepairTable() { return kTable; }

std::vector<std::string> RepairNames() {
  std::vector<std::string> names;
  for (const RepairEntry& entry : kTable) names.emplace_back(entry.name);
  return names;
}

RepairSet RepairsOf(const RenderingSpec& rendering) {
  RepairSet repairs;
  if (rendering.formulation == "repaired") repairs.set_.set();
  for (const RepairEntry& entry : kTable)
    for (const std::string& name : rendering.formulation_except)
      if (name == entry.name)
        repairs.set_[static_cast<std::size_t>(entry.repair)] = rendering.formulation == "paper";
  return repairs;
}

void ApplyFormulation(Scenario* scenario) {
  const RepairSet repairs = RepairsOf(scenario->rendering);
  if (!repairs.Has(Repair::kLead)) scenario->rendering.lead = 0;
  if (repairs.Has(Repair::kCoupling)) return;
  CouplingSpec& coupling = scenario->coupling;
  coupling.stiffness = coupling.damping = coupling.speed_damping = 0;
  coupling.rotation_stiffness = coupling.rotation_damping = 0;
}

}  // namespace predictor
