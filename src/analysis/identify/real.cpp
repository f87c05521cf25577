#include "analysis/identify/real.h"

#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "models/robot.h"
#include "models/urdf.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

std::string Three(const Vector3& v) { return Formatted("%.17g %.17g %.17g", v.x(), v.y(), v.z()); }

void AddLink(const UrdfLink& link, std::string* text) {
  AppendLine(text, "  <link name=\"%s\">", link.name.c_str());
  if (link.mass > 0) {
    const Matrix3& I = link.inertia;
    AppendLine(text, "    <inertial><origin xyz=\"%s\"/><mass value=\"%.17g\"/>",
               Three(link.com).c_str(), link.mass);
    AppendLine(text,
               "    <inertia ixx=\"%.17g\" ixy=\"%.17g\" ixz=\"%.17g\" iyy=\"%.17g\" iyz=\"%.17g\" "
               "izz=\"%.17g\"/></inertial>",
               I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2));
  }
  AppendLine(text, "  </link>");
}

void AddJoint(const UrdfModel& urdf, const UrdfJoint& joint, std::string* text) {
  AppendLine(text, "  <joint name=\"%s\" type=\"%s\">", joint.name.c_str(), Name(joint.type));
  AppendLine(text, "    <parent link=\"%s\"/><child link=\"%s\"/>",
             urdf.links[static_cast<std::size_t>(joint.parent)].name.c_str(),
             urdf.links[static_cast<std::size_t>(joint.child)].name.c_str());
  AppendLine(text, "    <origin xyz=\"%s\" rpy=\"%s\"/>", Three(joint.X_PJ.p).c_str(),
             Three(RpyOf(joint.X_PJ.q)).c_str());
  if (joint.type != UrdfJointType::kFixed) {
    AppendLine(text, "    <axis xyz=\"%s\"/>", Three(joint.axis).c_str());
    std::string limit;
    const auto add = [&limit](const char* name, double value) {
      if (std::isfinite(value)) Append(&limit, " %s=\"%.17g\"", name, value);
    };
    add("lower", joint.lower);
    add("upper", joint.upper);
    add("velocity", joint.velocity);
    add("effort", joint.effort);
    if (!limit.empty()) AppendLine(text, "    <limit%s/>", limit.c_str());
  }
  AppendLine(text, "  </joint>");
}

// Returns the URDF's links and joints without shapes, which the simulation of a cobot does not
// need.
std::string DynamicsText(const UrdfModel& urdf) {
  std::string text;
  AppendLine(&text, "<?xml version=\"1.0\"?>");
  AppendLine(&text, "<robot name=\"%s\">", urdf.name.c_str());
  for (const UrdfLink& link : urdf.links) AddLink(link, &text);
  for (const UrdfJoint& joint : urdf.joints) AddJoint(urdf, joint, &text);
  AppendLine(&text, "</robot>");
  return text;
}

void Perturb(const RealCobot& real, UrdfModel* urdf) {
  RandomStream stream(real.seed, "identify.links");
  for (UrdfLink& link : urdf->links) {
    const double sign = stream.Uniform() < 0.5 ? -1 : 1;
    const Vector3 direction(stream.Normal(), stream.Normal(), stream.Normal());
    link.mass *= 1 + sign * real.mass_error;
    link.inertia *= 1 + sign * real.mass_error;
    link.com += real.com_error * direction.normalized();
  }
}

}  // namespace

RealCobot DrawRealCobot(int joints, std::uint64_t seed) {
  RealCobot real;
  real.seed = seed;
  RandomStream stream(seed, "identify.friction");
  for (int j = 0; j < joints; ++j) {
    real.viscous.push_back(0.6 + 1.8 * stream.Uniform());
    real.coulomb.push_back(0.3 + 0.9 * stream.Uniform());
  }
  return real;
}

Scenario MakeReal(const Scenario& nominal, const RealCobot& real,
                  const std::filesystem::path& folder) {
  Scenario s = nominal;
  UrdfModel cobot = ReadUrdf(ResolveModelPath(nominal.cobot.model, nominal.folder()),
                             nominal.cobot.remove_links, nominal.folder());
  Perturb(real, &cobot);
  WriteWholeFile(folder / "cobot.urdf", DynamicsText(cobot));
  if (!nominal.object.model.empty()) {
    const auto object = ResolveModelPath(nominal.object.model, nominal.folder());
    WriteWholeFile(folder / "object.urdf", ReadUrdf(object, {}, nominal.folder()).text);
    s.object.model = "object.urdf";
  }
  s.name += ", the real cobot";
  s.mode = Mode::kDirect;
  s.file = folder / "real.yaml";
  s.tree = nullptr;
  s.cobot.model = "cobot.urdf";
  s.cobot.remove_links.clear();
  s.cobot.joint_friction = {real.viscous, real.coulomb};
  s.device.left.reset();
  s.device.right.reset();
  return s;
}

}  // namespace predictor
