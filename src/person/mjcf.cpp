// Writes the body as MuJoCo's XML.
#include "core/text.h"
#include "person/body_model.h"
#include "person/legs.h"

namespace predictor::person {
namespace {

std::string Text(const Vector3& v) {
  return "\"" + FormatNumber(v.x()) + " " + FormatNumber(v.y()) + " " + FormatNumber(v.z()) + "\"";
}

std::string Inertial(double mass, const Vector3& com, const Vector3& inertia) {
  return "<inertial pos=" + Text(com) + " mass=\"" + FormatNumber(mass) +
         "\" diaginertia=" + Text(inertia) + "/>\n";
}

std::string JointElement(const BodyModel& model, int i) {
  const BodyJoint& joint = model.joint(i);
  return std::string("<joint name=\"") + JointName(i) + "\" type=\"" +
         (IsPrismatic(i) ? "slide" : "hinge") + "\" axis=" + Text(joint.axis) + " range=\"" +
         FormatNumber(joint.lower) + " " + FormatNumber(joint.upper) + "\"/>\n";
}

// Opens the body of the joints first ... last, which are at the same place. The last one carries
// the mass.
std::string Open(const BodyModel& model, const char* name, int first, int last) {
  std::string text =
      std::string("<body name=\"") + name + "\" pos=" + Text(model.joint(first).offset) + ">\n";
  for (int i = first; i <= last; ++i) text += JointElement(model, i);
  const BodyJoint& carries = model.joint(last);
  return text + Inertial(carries.mass, carries.com, carries.inertia);
}

std::string Arm(const BodyModel& model, int hand) {
  const std::string side = HandName(hand);
  const auto part = [&](const char* name, ArmJoint first, ArmJoint last) {
    return Open(model, (side + name).c_str(), Of(hand, first), Of(hand, last));
  };
  return part("_upper_arm", ArmJoint::kShoulderFlexion, ArmJoint::kShoulderRotation) +
         part("_forearm", ArmJoint::kElbowFlexion, ArmJoint::kElbowFlexion) +
         part("_hand", ArmJoint::kPronation, ArmJoint::kWristDeviation) +
         "</body>\n</body>\n</body>\n";
}

std::string Legs(const BodyModel& model) {
  std::string text;
  const Anthropometry& a = model.anthropometry();
  const BodyLegs legs = LegsOf(model, BodyVector::Zero(), 2 * a.half_hip_width);
  for (int side = 0; side < kHands; ++side) {
    int part = 0;
    for (const Segment* segment : {&a.thigh, &a.shank, &a.foot}) {
      const Vector3& com = legs.com[static_cast<std::size_t>(side)][static_cast<std::size_t>(part)];
      text += std::string("<body name=\"") + HandName(side) + "_leg_" + std::to_string(part++) +
              "\" pos=" + Text(com) + ">\n" +
              Inertial(segment->mass, Vector3::Zero(), segment->inertia) + "</body>\n";
    }
  }
  return text;
}

}  // namespace

std::string MjcfOf(const BodyModel& model) {
  return "<mujoco model=\"person\">\n<compiler angle=\"radian\"/>\n<option gravity=\"0 0 " +
         FormatNumber(-kStandardGravity) + "\"/>\n<worldbody>\n" +
         Open(model, "pelvis", kPelvisX, kPelvisList) +
         Open(model, "torso", kTorsoFlexion, kTorsoTwist) +
         Open(model, "head", kNeckFlexion, kNeckTwist) + "</body>\n" + Arm(model, 0) +
         Arm(model, 1) + "</body>\n</body>\n" + Legs(model) + "</worldbody>\n</mujoco>\n";
}

}  // namespace predictor::person
