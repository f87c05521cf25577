#include "simulation/external_controller.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

// The damping of the fallback controller, as a rate [1/s]. The mass matrix times this rate resists
// the motion.
constexpr double kFallbackRate = 10;

template <class M>
void Copy(const M& from, double* to) noexcept {
  std::copy_n(from.data(), from.size(), to);
}

bool Holds(const JointVector& x, const double* values) noexcept {
  return std::memcmp(x.data(), values, sizeof(double) * static_cast<std::size_t>(x.size())) == 0;
}

}  // namespace

void FillPose(const Pose& X, double* to) noexcept {
  Copy(X.p, to);
  to[3] = X.q.w(), to[4] = X.q.x(), to[5] = X.q.y(), to[6] = X.q.z();
}

InterfaceInput::InterfaceInput(double dt, int dof) : J_(6, dof) {
  to_.dt = dt;
  to_.dof = dof;
}

const PredictorControllerInput& InterfaceInput::Fill(const ControllerInput& input) noexcept {
  to_.time = input.time;
  if (input.torque) Copy(*input.torque, to_.torque);
  Copy(input.F_E_W, to_.F_E_W);
  FillPose(input.X_WO, to_.X_WO);
  // The other values follow from the state of the joints, which is often the same in two successive
  // calls.
  if (is_filled_ && Holds(*input.q, to_.q) && Holds(*input.v, to_.v)) return to_;
  is_filled_ = true;
  const RobotData& data = *input.data;
  Copy(*input.q, to_.q);
  Copy(*input.v, to_.v);
  Copy(data.gravity(), to_.g);
  if (reads_ & PREDICTOR_READS_H) Copy(data.bias(), to_.h);
  FillPose(input.E->X_W, to_.X_WE);
  Copy(input.E->V_W, to_.V_WE);
  if (reads_ & PREDICTOR_READS_J) {
    data.FrameJacobian(*input.model, input.end_effector, &J_);
    Copy(J_, to_.J);
  }
  if (reads_ & PREDICTOR_READS_M) Copy(data.M(), to_.M);
  return to_;
}

std::vector<InterfaceParameter> InterfaceParameters(const std::string& text) {
  std::vector<InterfaceParameter> parameters;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError::At(
          "cobot.controller.parameters",
          "cobot.controller.parameters contains " + Quote(word) +
              ". Write each parameter as key=value, with a space between two parameters.");
    parameters.push_back({word.substr(0, equals), word.substr(equals + 1)});
  }
  return parameters;
}

ExternalController::ExternalController(const ControllerContext& context)
    : input_(context.period, context.model.dof()) {}

void ExternalController::Compute(const ControllerInput& input, JointVector* torque) noexcept {
  const Eigen::Index dof = input.q->size();
  std::array<double, PREDICTOR_MAX_JOINTS> answered{};
  const Answer answer = Ask(Fill(input), answered.data());
  const Eigen::Map<const Eigen::VectorXd> computed(answered.data(), dof);
  outcome_ = answer.came ? ControllerOutcome::kComputed : ControllerOutcome::kFellBack;
  const bool is_usable = answer.came && computed.allFinite();
  if (is_usable && answer.allocations == 0) {
    *torque = computed;
    return;
  }
  if (is_usable)
    Fail(static_cast<double>(answer.allocations), 0, Quantity::kAllocations);
  else if (answer.came)
    Fail(static_cast<double>(dof - computed.array().isFinite().count()), 0, Quantity::kCount);
  else if (answer.silence >= longest_silence())
    Fail(answer.silence, longest_silence(), Quantity::kTime);
  *torque = input.data->gravity();
  torque->noalias() -= kFallbackRate * input.data->M().lazyProduct(*input.v);
}

void ExternalController::Fail(double value, double limit, Quantity quantity) noexcept {
  outcome_ = ControllerOutcome::kFailed;
  failure_ = Status{StopCause::kPhysics, -1, value, limit, quantity};
}

}  // namespace predictor
