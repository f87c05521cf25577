// The script's actions in words, and what a reset does not undo.
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/text.h"
#include "scenario/live_parameters.h"
#include "viewer/scene_description.h"

namespace predictor {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr double kNothing = 5e-4;  // less is not told [m]

std::string Format(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string Centimetres(double length) { return Format("%.3g cm", 1e2 * std::abs(length)); }

std::string Degrees(double angle) { return Format("%.3g°", kDegrees * std::abs(angle)); }

// "30 cm to the left", for each direction that counts.
std::vector<std::string> Horizontal(const Vector3& by, int facing) {
  std::vector<std::string> parts;
  if (std::abs(by.x()) > kNothing)
    parts.push_back(Centimetres(by.x()) + (by.x() * facing > 0 ? " forward" : " back"));
  if (std::abs(by.y()) > kNothing)
    parts.push_back(Centimetres(by.y()) + (by.y() * facing > 0 ? " to the left" : " to the right"));
  return parts;
}

std::string MoveText(const Vector3& by, int facing) {
  const std::vector<std::string> horizontal = Horizontal(by, facing);
  const bool vertical = std::abs(by.z()) > kNothing;
  if (!vertical && horizontal.empty()) return "Hold the object where it is.";
  std::string text;
  if (vertical)
    text = (by.z() > 0 ? "Lift the object by " : "Lower the object by ") + Centimetres(by.z());
  if (!horizontal.empty())
    text += (vertical ? " and move it " : "Move the object ") + Join(horizontal, " and ");
  return text + ".";
}

std::string RotateText(const Vector3& by) {
  const double angle = by.norm();
  if (angle < 1e-4) return "Hold the object as it is.";
  const Vector3 axis = by / angle;
  if (std::abs(axis.z()) > 0.999)
    return "Turn the object by " + Degrees(angle) +
           (axis.z() > 0 ? " counter-clockwise" : " clockwise") + ", as seen from above.";
  return "Turn the object by " + Degrees(angle) + " about the axis (" + Format("%.2g", axis.x()) +
         ", " + Format("%.2g", axis.y()) + ", " + Format("%.2g", axis.z()) + ").";
}

std::string CircleText(const ActionSpec& action) {
  return "Follow the circle of " + Centimetres(action.radius) + " radius, " +
         Format("%.3g", action.cycles) + (action.cycles == 1 ? " turn, " : " turns, ") +
         Format("%.3g", action.period) + " s each.";
}

std::string Handles(const std::string& hand) {
  return hand == "both" ? "the handles" : "the " + hand + " handle";
}

std::string PutDownText(const Vector3& by, int facing) {
  std::string text = MoveText(by, facing);
  if (by.norm() < kNothing) return "Put the object down.";
  text.pop_back();
  return text + " and put it down.";
}

}  // namespace

std::string Instruction(const ActionSpec& action, int facing) {
  switch (action.action) {
    case ActionType::kGrip:
      return "Grip " + Handles(action.hand) + ".";
    case ActionType::kMove:
      return MoveText(action.by, facing);
    case ActionType::kRotate:
      return RotateText(action.rotate_by);
    case ActionType::kHold:
      return "Hold the object still.";
    case ActionType::kCircle:
      return CircleText(action);
    case ActionType::kPush:
      return "Push " + Handles(action.hand) + " with " + Format("%.3g N", action.force.norm()) +
             ".";
    case ActionType::kRelease:
      return "Let go of " + Handles(action.hand) + ".";
    case ActionType::kPutDown:
      return PutDownText(action.by, facing);
  }
  return {};
}

std::string KeptThresholds(const Scenario& scenario, const TickRecord& record) {
  std::vector<std::string> kept;
  const auto compare = [&](Parameter parameter, const char* value, const char* of) {
    const double now = record.parameters[static_cast<std::size_t>(parameter)];
    const double start = RangeOf(scenario, parameter).start;
    if (now < start) kept.push_back(Format(value, now) + " instead of " + Format(of, start));
  };
  compare(Parameter::kForceThreshold, "%.3g", "%.3g N");
  compare(Parameter::kTorqueThreshold, "%.3g", "%.3g N·m");
  if (kept.empty()) return "";
  return "The reset keeps the tighter thresholds: " + Join(kept, ", ") + ".";
}

int OperatorFacing(const Scenario& scenario, const Vector3& object_start) {
  if (!scenario.Has(0) || !scenario.Has(1))
    return object_start.x() > scenario.cobot.base.xyz.x() ? -1 : 1;
  const double across = scenario.handle(0).pose.xyz.y() - scenario.handle(1).pose.xyz.y();
  return across < 0 ? -1 : 1;
}

}  // namespace predictor
