#include "commissioning/payload_check.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace predictor::commissioning {
namespace {

// Larger errors are noticeable by hand in the arm's protective stops and free-drive.
constexpr double kMass = 0.1;      // [kg]
constexpr double kMassPart = 0.1;  // share of the handle's mass
constexpr double kSensor = 1.0;    // possible mass of a sensor [kg]
constexpr double kReach = 0.1;     // distance of its centre of gravity from the flange [m]
constexpr double kMoment = 0.01;   // of mass times distance [kg·m]: 0.1 N·m

// Centre of mass of the handle, in E.
Vector3 CentreOf(const ArmSpec& arm) {
  return arm.sensor.pose.ToPose() * arm.payload.center_of_mass;
}

// Returns an error if the arm's own wrench already excludes the weight configured in its
// controller.
std::string TakenOffTwice(const ToldPayload& told, const HandlePayloadSpec& handle) {
  if (!(told.mass > kMass && handle.mass > kMass)) return "";
  return Formatted(
      "Its controller subtracts %.2f kg from its own wrench, and the machine file gives the handle "
      "a mass of %.2f kg: the weight would be subtracted twice. Enter the handle either in Desk or "
      "as payload.mass in the machine file, and zero in the other place.",
      told.mass, handle.mass);
}

}  // namespace

std::string PayloadRefusal(const DeviceFacts& facts, const MachineArm& machine) {
  if (!facts.payload) return "";
  const ToldPayload& told = *facts.payload;
  const HandlePayloadSpec& handle = machine.arm.payload;
  const bool own = machine.sensor.make == SensorMake::kOwn;
  if (own && facts.payload_taken_off) return TakenOffTwice(told, handle);
  const double slack = std::max(kMass, kMassPart * handle.mass);
  const double most = handle.mass + slack + (own ? 0 : kSensor);
  const Vector3 c = CentreOf(machine.arm);
  if (!(told.mass >= handle.mass - slack && told.mass <= most))
    return Formatted(
        "Its controller is set to %.2f kg at the flange, but the handle weighs %.2f kg%s. Enter "
        "%.2f kg%s at the pendant; otherwise its protective stops and free-drive are wrong.",
        told.mass, handle.mass, own ? "" : " without the sensor", handle.mass,
        own ? "" : " plus the sensor's mass");
  // The effect of a separate sensor is unknown, but its upper bound is known.
  const double sensor = own ? 0 : kReach * std::max(0.0, told.mass - handle.mass);
  const double moment = (told.mass * told.center_of_mass - handle.mass * c).norm();
  if (moment <= kMoment + sensor) return "";
  return Formatted(
      "Its controller is set to a centre of gravity at (%.0f, %.0f, %.0f) mm from the flange, but "
      "the handle's is at (%.0f, %.0f, %.0f) mm. Enter %s at the pendant.",
      1e3 * told.center_of_mass.x(), 1e3 * told.center_of_mass.y(), 1e3 * told.center_of_mass.z(),
      1e3 * c.x(), 1e3 * c.y(), 1e3 * c.z(),
      own ? "this position" : "the mass and centre of gravity of sensor and handle together");
}

}  // namespace predictor::commissioning
