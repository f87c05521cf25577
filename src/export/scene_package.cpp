#include "export/scene_package.h"

#include <sstream>

#include "core/text.h"
#include "export/package_meshes.h"
#include "export/scene_tree.h"
#include "export/urdf_text.h"

namespace predictor::scene_export {
namespace {

constexpr const char* kPackageXml = R"(<?xml version="1.0"?>
<package format="2">
  <name>predictor_scene</name>
  <version>1.0.0</version>
  <description>A virtual scene written by predictor export scene.</description>
  <maintainer email="nobody@example.com">The person who exported it</maintainer>
  <license>See the licences of the models</license>
</package>
)";

constexpr const char* kImport = R"(
This folder was written by `predictor export scene`: the virtual scene of a scenario as one URDF
file, scene.urdf, with its meshes in the folder "meshes".

Unity (URDF-Importer 0.5)
  1. Copy the whole folder into Assets of a Unity project.
  2. Right-click scene.urdf: "Import Robot from Selected URDF file". Axis type: Y axis. Convex
     method: Unity, which is faster; the colliders are not used.
  3. Assign the new robot to PredictorScene.cs, and press Play. See docs/how-to/unity.md.
Keep scene.urdf next to the folder "meshes": the importer searches below the URDF's folder.

MuJoCo, Pinocchio and other readers load scene.urdf as it is (package:// is not used).

World: root link "world", z up, metres, kilograms, radians. The meshes and textures come from
the models of the robot and the object; their licences apply.
)";

constexpr const char* kBallJoint =
    R"(They replace a ball joint, which URDF does not support: rotations about x, then y, then z. If the
second is at 90 degrees, the other two rotate about the same axis. The damping equals that of the
ball joint if all three are 0.
)";

void List(const std::vector<std::string>& names, std::ostringstream* out) {
  for (std::size_t i = 0; i < names.size(); ++i) *out << "  " << i << "  " << names[i] << "\n";
}

std::string Readme(const Scenario& scenario, const SceneTree& tree,
                   const std::vector<std::string>& left_out) {
  std::ostringstream out;
  out << scenario.name << "\n" << kImport;
  out << "\nJoints of the cobot, in the order of the topic /predictor/joint_states:\n";
  List(tree.cobot_joints, &out);
  if (!tree.attachment_joints.empty()) {
    out << "\nJoints of the attachment, from the link " << tree.end_effector << " to the object:\n";
    List(tree.attachment_joints, &out);
  }
  if (tree.attachment_joints.size() == 3) out << kBallJoint;
  out << "\n"
         "Other links: object and, if the scenario has them, left_handle, right_handle, floor (a "
         "box of\n"
         "10 m instead of an infinite plane) and table.\n"
         "Massless links have "
      << FormatNumber(kTinyMass) << " kg and " << FormatNumber(kTinyInertia)
      << " kg m^2, because some readers refuse zero.\n"
         "Gravity of the scenario: "
      << FormatNumber(scenario.environment.gravity) << " m/s^2.\n";
  if (!left_out.empty())
    out << "\n"
           "Not found and therefore left out: "
        << Join(left_out) << ".\n";
  return out.str();
}

}  // namespace

ScenePackage MakeScenePackage(const Scenario& scenario) {
  const SceneTree tree = ComposeTree(scenario);
  PackageMeshes meshes(scenario.folder());
  ScenePackage package;
  const std::string urdf = UrdfText(tree, scenario.environment.gravity, &meshes);
  package.files = meshes.files();
  package.notes = meshes.notes();
  package.files[kSceneUrdf].text = urdf;
  package.files["package.xml"].text = kPackageXml;
  package.files["README.txt"].text = Readme(scenario, tree, meshes.left_out());
  return package;
}

}  // namespace predictor::scene_export
