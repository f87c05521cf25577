// Writes the body as MuJoCo's XML, with which its tests compare kinematics and inverse dynamics.
#pragma once

#include <string>

#include "core/text.h"
#include "person/body_model.h"
#include "person/legs.h"

namespace predictor::person {

inline std::string MjcfVector(const Vector3& v) {
  return "\"" + FormatNumber(v.x()) + " " + FormatNumber(v.y()) + " " + FormatNumber(v.z()) + "\"";
}

inline std::string MjcfInertial(double mass, const Vector3& com, const Vector3& inertia) {
  return "<inertial pos=" + MjcfVector(com) + " mass=\"" + FormatNumber(mass) +
         "\" diaginertia=" + MjcfVector(inertia) + "/>\n";
}

inline std::string MjcfJoint(const BodyModel& model, int i) {
  const BodyJoint& joint = model.joint(i);
  return std::string("<joint name=\"") + JointName(i) + "\" type=\"" +
         (IsPrismatic(i) ? "slide" : "hinge") + "\" axis=" + MjcfVector(joint.axis) + " range=\"" +
         FormatNumber(joint.lower) + " " + FormatNumber(joint.upper) + "\"/>\n";
}

// Opens the body of the joints first ... last, which are at the same place. The last one carries
// the mass.
inline std::string OpenMjcfBody(const BodyModel& model, const char* name, int first, int last) {
  std::string text = std::string("<body name=\"") + name +
                     "\" pos=" + MjcfVector(model.joint(first).offset) + ">\n";
  for (int i = first; i <= last; ++i) text += MjcfJoint(model, i);
  const BodyJoint& carries = model.joint(last);
  return text + MjcfInertial(carries.mass, carries.com, carries.inertia);
}

inline std::string MjcfArm(const BodyModel& model, int hand) {
  const std::string side = HandName(hand);
  const auto part = [&](const char* name, ArmJoint first, ArmJoint last) {
    return OpenMjcfBody(model, (side + name).c_str(), Of(hand, first), Of(hand, last));
  };
  return part("_upper_arm", ArmJoint::kShoulderFlexion, ArmJoint::kShoulderRotation) +
         part("_forearm", ArmJoint::kElbowFlexion, ArmJoint::kElbowFlexion) +
         part("_hand", ArmJoint::kPronation, ArmJoint::kWristDeviation) +
         "</body>\n</body>\n</body>\n";
}

inline std::string MjcfLegs(const BodyModel& model) {
  std::string text;
  const Anthropometry& a = model.anthropometry();
  const BodyLegs legs = LegsOf(model, BodyVector::Zero(), 2 * a.half_hip_width);
  for (int side = 0; side < kHands; ++side) {
    int part = 0;
    for (const Segment* segment : {&a.thigh, &a.shank, &a.foot}) {
      const Vector3& com = legs.com[static_cast<std::size_t>(side)][static_cast<std::size_t>(part)];
      text += std::string("<body name=\"") + HandName(side) + "_leg_" + std::to_string(part++) +
              "\" pos=" + MjcfVector(com) + ">\n" +
              MjcfInertial(segment->mass, Vector3::Zero(), segment->inertia) + "</body>\n";
    }
  }
  return text;
}

// Returns the body as a MuJoCo model, with the joints' names and order of body_model.h. The legs
// stand upright and do not move.
inline std::string MjcfOf(const BodyModel& model) {
  return "<mujoco model=\"person\">\n<compiler angle=\"radian\"/>\n<option gravity=\"0 0 " +
         FormatNumber(-kStandardGravity) + "\"/>\n<worldbody>\n" +
         OpenMjcfBody(model, "pelvis", kPelvisX, kPelvisList) +
         OpenMjcfBody(model, "torso", kTorsoFlexion, kTorsoTwist) +
         OpenMjcfBody(model, "head", kNeckFlexion, kNeckTwist) + "</body>\n" + MjcfArm(model, 0) +
         MjcfArm(model, 1) + "</body>\n</body>\n" + MjcfLegs(model) + "</worldbody>\n</mujoco>\n";
}

}  // namespace predictor::person
