#include "analysis/stability_map/variant.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "haptics/stability.h"
#include "models/object_model.h"
#include "simulation/world.h"

namespace predictor {
namespace {

constexpr double kSame = 1e-6;  // values with a smaller relative difference are equal

// Visits every description of an arm's loop, of both arms and of the simulated rig.
template <class F>
void ForEachLoop(Scenario* s, F f) {
  if (s->device.left) f(&s->device.left->loop);
  if (s->device.right) f(&s->device.right->loop);
  if (s->rig.loop) f(&*s->rig.loop);
}

const VelocityLoopSpec& OwnLoop(const Scenario& s) { return s.arm(s.Has(0) ? 0 : 1).loop; }

// Returns the object with another mass, as a primitive in the scenario. The object keeps its shape
// and its centre of mass, and its inertia changes in proportion to the mass.
PrimitiveSpec ScaledObject(const Scenario& s, double mass) {
  const ObjectModel object = LoadObject(s.object, s.folder());
  const Matrix3 off = object.inertia - Matrix3(object.inertia.diagonal().asDiagonal());
  if (off.norm() > 1e-3 * object.inertia.norm())
    throw InputError(
        "The object's principal axes differ from the axes of its frame, so its mass was not "
        "varied.");
  PrimitiveSpec body;
  body.shape = Shape::kBox;
  body.size.setConstant(0.02);  // also for the handles, which must be on the object
  for (int i = 0; i < kHands; ++i)
    if (s.Has(i)) body.size = body.size.cwiseMax(2 * HandlePose(s, i).p.cwiseAbs());
  body.mass = mass;
  body.center_of_mass = object.com;
  body.inertia = mass / object.mass * object.inertia.diagonal();
  return body;
}

// Gives the handles' poses in the object's frame instead of relative to links.
void FixHandles(Scenario* s) {
  for (int i = 0; i < kHands; ++i) {
    std::optional<HandleSpec>& handle = i == 0 ? s->left_handle : s->right_handle;
    if (!handle || handle->link.empty()) continue;
    const Pose X_OD = HandlePose(*s, i);
    handle->pose = {X_OD.p, RpyOf(X_OD.q)};
    handle->link.clear();
  }
}

// Replaces the object and moves the bases of the arms together with the object's handles.
void ReplaceObject(Scenario* s, double mass) {
  const World before(*s);
  s->object.primitive = ScaledObject(*s, mass);
  FixHandles(s);             // the primitive has no links
  s->cobot.touches.clear();  // not in the linear model, and the box is not the object's shape
  s->object.model.clear();
  const World after(*s);
  const Quaternion R_RW = s->environment.shift.value_or(PoseSpec()).ToPose().q;
  for (std::size_t i = 0; i < kHands; ++i) {
    auto& arm = i == 0 ? s->device.left : s->device.right;
    if (arm)
      arm->base.xyz += R_RW * (after.state().handle[i].X_W.p - before.state().handle[i].X_W.p);
  }
}

std::vector<double> Factors(double own, const std::vector<double>& factors) {
  std::vector<double> values;
  values.reserve(factors.size());
  for (const double f : factors) values.push_back(own * f);
  return values;
}

}  // namespace

const MapAxisText& TextOf(MapAxis axis) {
  static constexpr std::array<MapAxisText, kMapAxes> kTexts = {{
      {"object_mass", "mass of the object", "kg", 1, true},
      {"hand_mass", "mass of each hand", "kg", 1, true},
      {"delay", "delay of the arms' velocity loops", "ms", 1000, false},
      {"bandwidth", "bandwidth of the arms' velocity loops", "Hz", 1, true},
      {"lead", "lead (lag compensation)", "ms", 1000, false},
  }};
  return kTexts[static_cast<std::size_t>(axis)];
}

MapBase BaseOf(const Scenario& scenario) {
  if (scenario.mode == Mode::kDirect)
    throw InputError::At(
        "mode", "--map: mode is direct, which has no arms and no haptic loop. Set mode: emulate.");
  const World world(scenario);
  const double dt = 1 / scenario.rate;
  const LinearModel linear = world.Linearise();
  const LeadChoice choice = ChooseLead(HapticLoop(linear, scenario, dt), scenario, dt);
  return {scenario,
          choice.lead,
          choice.lag,
          world.object_mass(),
          linear,
          world.state().object.X_W,
          world.LineariseWithoutContacts()};
}

double OwnValue(const MapBase& base, MapAxis axis) {
  switch (axis) {
    case MapAxis::kObjectMass:
      return base.object_mass;
    case MapAxis::kHandMass:
      return base.scenario.operator_.hand.mass;
    case MapAxis::kDelay:
      return OwnLoop(base.scenario).delay;
    case MapAxis::kBandwidth:
      return OwnLoop(base.scenario).bandwidth;
    case MapAxis::kLead:
      break;
  }
  return base.lead;
}

bool IsOwn(const MapBase& base, MapAxis axis, double value) {
  const double own = OwnValue(base, axis);
  return std::abs(value - own) <= kSame * std::max(std::abs(own), kSame);
}

std::vector<double> MapValues(const MapBase& base, MapAxis axis) {
  const double own = OwnValue(base, axis);
  std::vector<double> values;
  switch (axis) {
    case MapAxis::kObjectMass:
      values = Factors(own, {0.25, 0.4, 0.63, 1, 1.25, 1.6, 2.5});
      break;
    case MapAxis::kHandMass:
      values = Factors(own > 0 ? own : 1, {0.25, 0.4, 0.63, 1, 1.6, 2.5, 4});
      break;
    case MapAxis::kDelay:
      values = {0, 0.002, 0.004, 0.008, 0.015, 0.025, 0.040};
      break;
    case MapAxis::kBandwidth:
      values = Factors(own, {0.25, 0.4, 0.63, 1, 1.6, 2.5, 4});
      break;
    case MapAxis::kLead:
      values = Factors(base.lag, {0, 0.2, 0.4, 0.6, 0.8, 1, 1.25});
      break;
  }
  const auto is_own = [&](double v) { return IsOwn(base, axis, v); };
  if (std::none_of(values.begin(), values.end(), is_own)) values.push_back(own);
  std::sort(values.begin(), values.end());
  return values;
}

Variant VariantOf(const MapBase& base, MapAxis axis, double value) {
  Variant variant{base.scenario, base.lead};
  Scenario& s = variant.scenario;
  if (IsOwn(base, axis, value)) return variant;
  switch (axis) {
    case MapAxis::kObjectMass:
      ReplaceObject(&s, value);
      break;
    case MapAxis::kHandMass:
      s.operator_.hand.mass = value;
      break;
    case MapAxis::kDelay:
      ForEachLoop(&s, [value](VelocityLoopSpec* loop) { loop->delay = value; });
      break;
    case MapAxis::kBandwidth:
      ForEachLoop(&s, [value](VelocityLoopSpec* loop) { loop->bandwidth = value; });
      break;
    case MapAxis::kLead:
      variant.lead = value;
      break;
  }
  return variant;
}

}  // namespace predictor
