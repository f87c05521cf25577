// A plug-in in C++ with memory and wrist sensor: a spring in the wrist whose set-point follows the
// hand, tau = g + J' K (p_set - p) + K_j (posture - q) - d M v, and dp_set/dt = (F - F_start) / D.
// joint_impedance.c explains why the damping is proportional to the mass matrix M.
//
// Parameters: stiffness K [N/m], yielding 1/D [m/(N·s)].
// Build, in the root of the repository, with the output -o following_spring.so:
//   c++ -std=c++17 -O2 -shared -fPIC -I include examples/plugins/following_spring.cpp
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "predictor/controller.h"

namespace {

constexpr double kJointStiffness = 40;  // [N·m/rad]
constexpr double kDampingRate = 60;     // d [1/s]

class FollowingSpring {
 public:
  explicit FollowingSpring(const PredictorControllerConfig& config) : dof_(config.dof) {
    std::copy_n(config.posture, dof_, posture_.begin());
    std::copy_n(config.X_WE_start, 3, start_.begin());
    for (int i = 0; i < config.parameter_count; ++i) {
      const std::string key = config.parameters[i].key;
      if (key == "stiffness")
        stiffness_ = NumberOf(config.parameters[i]);
      else if (key == "yielding")
        yielding_ = NumberOf(config.parameters[i]);
      else
        throw std::runtime_error("In cobot.controller.parameters, \"" + key +
                                 "\" is not one of its parameters. Use stiffness or yielding.");
    }
    memory_.fill(0);
    std::copy_n(start_.begin(), 3, memory_.begin());
  }

  void Compute(const PredictorControllerInput& input, double* torque) const {
    std::array<double, 3> force;
    for (int i = 0; i < 3; ++i) force[i] = stiffness_ * (memory_[i] - input.X_WE[i]);
    for (int j = 0; j < dof_; ++j) {
      torque[j] = input.g[j] + kJointStiffness * (posture_[j] - input.q[j]);
      for (int k = 0; k < dof_; ++k) torque[j] -= kDampingRate * input.M[j + dof_ * k] * input.v[k];
      for (int i = 0; i < 3; ++i) torque[j] += input.J[i + 6 * j] * force[i];
    }
  }

  // The memory contains the set-point, followed by the sensor's reading at the start.
  double* memory() { return memory_.data(); }
  static constexpr int kMemory = 6;

  void Start(const PredictorControllerInput& input) {
    std::copy_n(start_.begin(), 3, memory_.begin());
    std::copy_n(input.F_E_W, 3, memory_.begin() + 3);
  }

  void Advance(const PredictorControllerInput& input) {
    for (int i = 0; i < 3; ++i)
      memory_[i] += input.dt * yielding_ * (input.F_E_W[i] - memory_[i + 3]);
  }

  double StoredEnergy(const PredictorControllerInput& input) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      sum += stiffness_ * (memory_[i] - input.X_WE[i]) * (memory_[i] - input.X_WE[i]);
    for (int j = 0; j < dof_; ++j)
      sum += kJointStiffness * (posture_[j] - input.q[j]) * (posture_[j] - input.q[j]);
    return 0.5 * sum;
  }

 private:
  static double NumberOf(const PredictorParameter& parameter) {
    char* end = nullptr;
    const double value = std::strtod(parameter.value, &end);
    if (end != parameter.value && *end == '\0' && value >= 0 && std::isfinite(value)) return value;
    throw std::runtime_error(std::string("In cobot.controller.parameters, ") + parameter.key +
                             " is \"" + parameter.value + "\". Give a finite number from 0.");
  }

  int dof_;
  double stiffness_ = 400;  // [N/m]
  double yielding_ = 0.01;  // [m/(N·s)]
  std::array<double, PREDICTOR_MAX_JOINTS> posture_{};
  std::array<double, 3> start_{};
  std::array<double, kMemory> memory_{};
};

FollowingSpring& Self(void* self) { return *static_cast<FollowingSpring*>(self); }

// No exception may leave the library.
void* Create(const PredictorControllerConfig* config, char* error, std::size_t error_size) {
  try {
    return new FollowingSpring(*config);
  } catch (const std::exception& e) {
    std::snprintf(error, error_size, "%s", e.what());
    return nullptr;
  }
}

PredictorController Functions() {
  using Input = PredictorControllerInput;
  PredictorController f{};
  f.version = PREDICTOR_CONTROLLER_VERSION;
  f.input_size = sizeof(Input);
  f.create = Create;
  f.destroy = [](void* self) { delete &Self(self); };
  f.compute = [](void* self, const Input* in, double* torque) { Self(self).Compute(*in, torque); };
  f.memory = [](void* self, std::int32_t* size) {
    *size = FollowingSpring::kMemory;
    return Self(self).memory();
  };
  f.start = [](void* self, const Input* in) { Self(self).Start(*in); };
  f.advance = [](void* self, const Input* in) { Self(self).Advance(*in); };
  f.uses_wrist_sensor = [](void*) -> std::int32_t { return 1; };
  f.stored_energy = [](void* self, const Input* in) { return Self(self).StoredEnergy(*in); };
  return f;
}

}  // namespace

extern "C" PREDICTOR_EXPORT const PredictorController* predictor_controller() {
  static const PredictorController functions = Functions();
  return &functions;
}
