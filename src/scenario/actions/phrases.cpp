#include "scenario/actions/phrases.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "core/text.h"
#include "core/units.h"

namespace predictor {
namespace {

constexpr double kMinDistance = 5e-4;  // a shorter displacement is not mentioned [m]
constexpr double kAligned = 0.999;  // cosine of the angle between two directions of the same name

// Returns a text such as "30 cm to the left" for each direction with a significant displacement.
std::vector<std::string> Horizontal(const Vector3& by, double facing) {
  const double forward = by.x() * std::cos(facing) + by.y() * std::sin(facing);
  const double left = by.y() * std::cos(facing) - by.x() * std::sin(facing);
  std::vector<std::string> parts;
  if (std::abs(forward) > kMinDistance)
    parts.push_back(InCentimetres(forward) + (forward > 0 ? " forward" : " back"));
  if (std::abs(left) > kMinDistance)
    parts.push_back(InCentimetres(left) + (left > 0 ? " to the left" : " to the right"));
  return parts;
}

}  // namespace

std::string WithUnit(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.3g%s", value, unit);
  return text;
}

std::string InCentimetres(double length) { return WithUnit(1e2 * std::abs(length), " cm"); }

std::string InDegrees(double angle) { return WithUnit(kDegrees * std::abs(angle), "°"); }

std::string HandlesOf(const std::string& hand) {
  return hand == "both" ? "the handles" : "the " + hand + " handle";
}

std::string MoveSentence(const Vector3& by, double facing) {
  const std::vector<std::string> horizontal = Horizontal(by, facing);
  const bool vertical = std::abs(by.z()) > kMinDistance;
  if (!vertical && horizontal.empty()) return "Hold the object where it is.";
  std::string text;
  if (vertical)
    text = (by.z() > 0 ? "Lift the object by " : "Lower the object by ") + InCentimetres(by.z());
  if (!horizontal.empty())
    text += (vertical ? " and move it " : "Move the object ") + Join(horizontal, " and ");
  return text + ".";
}

std::string DirectionWords(const Vector3& direction, double facing) {
  const double forward = direction.x() * std::cos(facing) + direction.y() * std::sin(facing);
  const double left = direction.y() * std::cos(facing) - direction.x() * std::sin(facing);
  if (std::abs(direction.z()) > kAligned) return direction.z() > 0 ? "up" : "down";
  if (std::abs(forward) > kAligned) return forward > 0 ? "forward" : "back";
  if (std::abs(left) > kAligned) return left > 0 ? "to the left" : "to the right";
  return "";
}

}  // namespace predictor
