// Writes the body as OpenSim's XML.
#include "core/text.h"
#include "person/body_model.h"

namespace predictor::person {
namespace {

std::string Tag(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">\n";
}

std::string Named(const std::string& tag, const std::string& name, const std::string& content) {
  return "<" + tag + " name=\"" + name + "\">\n" + content + "</" + tag + ">\n";
}

std::string Numbers(const Vector3& v) {
  return FormatNumber(v.x()) + " " + FormatNumber(v.y()) + " " + FormatNumber(v.z());
}

std::string BodyElement(const BodyModel& model, const BodyPart& part) {
  const BodyJoint& carries = model.joint(part.last);
  const Vector3& I = carries.inertia;  // diagonal, so a change of axes only permutes the entries
  return Named("Body", part.name,
               Tag("mass", FormatNumber(carries.mass)) +
                   Tag("mass_center", Numbers(InOpenSim(carries.com))) +
                   Tag("inertia", Numbers({I.x(), I.z(), I.y()}) + " 0 0 0"));
}

std::string Coordinates(const BodyModel& model, const BodyPart& part) {
  std::string text;
  for (int i = part.first; i <= part.last; ++i)
    text += Named("Coordinate", JointName(i),
                  Tag("default_value", "0") +
                      Tag("range", FormatNumber(model.joint(i).lower) + " " +
                                       FormatNumber(model.joint(i).upper)) +
                      Tag("clamped", "false"));
  return Tag("coordinates", text);
}

std::string Frame(const std::string& name, const std::string& body, const Vector3& offset) {
  return Named("PhysicalOffsetFrame", name,
               Tag("socket_parent", body) + Tag("translation", Numbers(InOpenSim(offset))) +
                   Tag("orientation", "0 0 0"));
}

// An axis with a `joint` of -1 does not move.
std::string Axis(const std::string& name, int joint, const Vector3& axis) {
  const std::string function =
      joint < 0 ? Named("Constant", "function", Tag("value", "0"))
                : Named("LinearFunction", "function", Tag("coefficients", "1 0"));
  return Named("TransformAxis", name,
               Tag("coordinates", joint < 0 ? "" : JointName(joint)) + Tag("axis", Numbers(axis)) +
                   function);
}

// The joints of a part follow one another. The axes that do not move must be linearly independent
// of the other axes.
std::string SpatialTransform(const BodyModel& model, const BodyPart& part) {
  std::vector<std::pair<int, Vector3>> rotations, translations;
  for (int i = part.first; i <= part.last; ++i)
    (IsPrismatic(i) ? translations : rotations).emplace_back(i, InOpenSim(model.joint(i).axis));
  for (auto* axes : {&rotations, &translations})
    for (const Vector3& unit :
         {Vector3(Vector3::UnitX()), Vector3(Vector3::UnitY()), Vector3(Vector3::UnitZ())}) {
      bool free = axes->size() < 3;
      for (const auto& [joint, axis] : *axes) free = free && std::abs(axis.dot(unit)) < 0.5;
      if (free) axes->emplace_back(-1, unit);
    }
  std::string text;
  for (std::size_t k = 0; k < 3; ++k)
    text += Axis("rotation" + std::to_string(k + 1), rotations[k].first, rotations[k].second);
  for (std::size_t k = 0; k < 3; ++k)
    text +=
        Axis("translation" + std::to_string(k + 1), translations[k].first, translations[k].second);
  return Tag("SpatialTransform", text);
}

const BodyPart* CarrierOf(int joint) {
  for (const BodyPart& part : BodyParts())
    if (part.last == joint) return &part;
  return nullptr;
}

std::string JointElement(const BodyModel& model, const BodyPart& part) {
  const BodyJoint& first = model.joint(part.first);
  const BodyPart* parent = CarrierOf(first.parent);
  const std::string name = part.name;
  const std::string inner = name + "_place", outer = name + "_origin";
  return Named(
      "CustomJoint", name + "_joint",
      Tag("socket_parent_frame", inner) + Tag("socket_child_frame", outer) +
          Coordinates(model, part) +
          Tag("frames", Frame(inner, parent ? std::string("/bodyset/") + parent->name : "/ground",
                              first.offset) +
                            Frame(outer, "/bodyset/" + name, Vector3::Zero())) +
          SpatialTransform(model, part));
}

}  // namespace

std::span<const BodyPart> BodyParts() {
  constexpr auto kLeft = [](ArmJoint joint) { return Of(0, joint); };
  constexpr auto kRight = [](ArmJoint joint) { return Of(1, joint); };
  static constexpr BodyPart kParts[] = {
      {"pelvis", kPelvisX, kPelvisList},
      {"torso", kTorsoFlexion, kTorsoTwist},
      {"head", kNeckFlexion, kNeckTwist},
      {"left_upper_arm", kLeft(ArmJoint::kShoulderFlexion), kLeft(ArmJoint::kShoulderRotation)},
      {"left_forearm", kLeft(ArmJoint::kElbowFlexion), kLeft(ArmJoint::kElbowFlexion)},
      {"left_hand", kLeft(ArmJoint::kPronation), kLeft(ArmJoint::kWristDeviation)},
      {"right_upper_arm", kRight(ArmJoint::kShoulderFlexion), kRight(ArmJoint::kShoulderRotation)},
      {"right_forearm", kRight(ArmJoint::kElbowFlexion), kRight(ArmJoint::kElbowFlexion)},
      {"right_hand", kRight(ArmJoint::kPronation), kRight(ArmJoint::kWristDeviation)}};
  return kParts;
}

std::string OpenSimModelOf(const BodyModel& model) {
  std::string bodies, joints;
  for (const BodyPart& part : BodyParts()) {
    bodies += BodyElement(model, part);
    joints += JointElement(model, part);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<OpenSimDocument Version=\"40500\">\n" +
         Named("Model", "person",
               Tag("length_units", "meters") + Tag("force_units", "N") +
                   Tag("gravity", "0 " + FormatNumber(-kStandardGravity) + " 0") +
                   Named("BodySet", "bodyset", Tag("objects", bodies)) +
                   Named("JointSet", "jointset", Tag("objects", joints))) +
         "</OpenSimDocument>\n";
}

}  // namespace predictor::person
