#include "export/scene_package.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "core/text.h"
#include "export/package_meshes.h"
#include "export/scene_sdf.h"
#include "export/scene_tree.h"
#include "export/xml_text.h"
#include "models/urdf_xml.h"

namespace predictor::scene_export {
namespace {

// ---- the scene as URDF

constexpr double kNoLimit = 1e6;  // replaces an infinite limit: no reader accepts "inf"

void AddOrigin(XmlElement* parent, const Pose& X) {
  XmlElement* origin = Add(parent, "origin");
  Set(origin, "xyz", Text(X.p));
  Set(origin, "rpy", Text(RollPitchYaw(X.R())));
}

void AddInertial(XmlElement* parent, const SceneLink& link) {
  if (link.mass == 0) return;
  XmlElement* inertial = Add(parent, "inertial");
  AddOrigin(inertial, {link.com, Quaternion::Identity()});
  Set(Add(inertial, "mass"), "value", FormatNumber(link.mass));
  XmlElement* inertia = Add(inertial, "inertia");
  const Matrix3& I = link.inertia;
  Set(inertia, "ixx", FormatNumber(I(0, 0)));
  Set(inertia, "ixy", FormatNumber(I(0, 1)));
  Set(inertia, "ixz", FormatNumber(I(0, 2)));
  Set(inertia, "iyy", FormatNumber(I(1, 1)));
  Set(inertia, "iyz", FormatNumber(I(1, 2)));
  Set(inertia, "izz", FormatNumber(I(2, 2)));
}

void AddGeometry(XmlElement* parent, const ModelShape& shape, const std::string& role,
                 PackageMeshes* meshes) {
  XmlElement* geometry = Add(parent, "geometry");
  const auto add_round = [&](const char* name) {
    XmlElement* round = Add(geometry, name);
    Set(round, "radius", Text(shape.size.x()));
    return round;
  };
  switch (shape.kind) {
    case ShapeKind::kBox:
      Set(Add(geometry, "box"), "size", Text(shape.size));
      break;
    case ShapeKind::kCylinder:
      Set(add_round("cylinder"), "length", Text(shape.size.y()));
      break;
    case ShapeKind::kSphere:
      add_round("sphere");
      break;
    case ShapeKind::kMesh: {
      XmlElement* mesh = Add(geometry, "mesh");
      Set(mesh, "filename", meshes->Add(shape, role));
      if (shape.size != Vector3::Ones()) Set(mesh, "scale", Text(shape.size));
      break;
    }
  }
}

// URDF-Importer stores materials by name, even across imports. Therefore, the name of a material
// describes its properties.
void AddMaterial(XmlElement* visual, const SceneShape& shape, PackageMeshes* meshes) {
  if (!shape.texture.empty()) {
    const std::string file = meshes->AddTexture(shape.texture);
    XmlElement* material = Add(visual, "material");
    Set(material, "name", file.substr(file.rfind('/') + 1));
    Set(Add(material, "texture"), "filename", file);
  } else if (shape.has_color) {
    const std::string rgba = Text(shape.shape.color);
    std::string name = "rgba_" + rgba;
    std::replace(name.begin(), name.end(), ' ', '_');
    XmlElement* material = Add(visual, "material");
    Set(material, "name", name);
    Set(Add(material, "color"), "rgba", rgba);
  }
}

void AddLink(XmlElement* robot, const SceneLink& link, PackageMeshes* meshes) {
  XmlElement* element = Add(robot, "link");
  Set(element, "name", link.name);
  AddInertial(element, link);
  for (const SceneShape& shape : link.visuals) {
    XmlElement* visual = Add(element, "visual");
    AddOrigin(visual, shape.shape.X_LG);
    AddGeometry(visual, shape.shape, "visual", meshes);
    AddMaterial(visual, shape, meshes);
  }
  for (const SceneShape& shape : link.collisions) {
    XmlElement* collision = Add(element, "collision");
    AddOrigin(collision, shape.shape.X_LG);
    AddGeometry(collision, shape.shape, "collision", meshes);
  }
}

void AddLimit(XmlElement* element, const SceneJoint& joint) {
  const bool has_range = joint.type != UrdfJointType::kContinuous;
  if (!has_range && std::isinf(joint.effort) && std::isinf(joint.velocity)) return;
  XmlElement* limit = Add(element, "limit");
  if (has_range) {
    Set(limit, "lower", Text(joint.lower));
    Set(limit, "upper", Text(joint.upper));
  }
  Set(limit, "effort", Text(std::min(joint.effort, kNoLimit)));
  Set(limit, "velocity", Text(std::min(joint.velocity, kNoLimit)));
}

void AddJoint(XmlElement* robot, const SceneJoint& joint) {
  XmlElement* element = Add(robot, "joint");
  Set(element, "name", joint.name);
  Set(element, "type", Name(joint.type));
  AddOrigin(element, joint.X_PJ);
  Set(Add(element, "parent"), "link", joint.parent);
  Set(Add(element, "child"), "link", joint.child);
  if (joint.type == UrdfJointType::kFixed) return;
  Set(Add(element, "axis"), "xyz", Text(joint.axis));
  AddLimit(element, joint);
  XmlElement* dynamics = Add(element, "dynamics");
  Set(dynamics, "damping", Text(joint.damping));
  Set(dynamics, "friction", Text(joint.friction));
}

// Without this element, MuJoCo merges fixed links, loses the mass of links that are fixed to the
// world, and looks for meshes next to the URDF.
void AddMujoco(XmlElement* robot, double gravity) {
  XmlElement* mujoco = Add(robot, "mujoco");
  XmlElement* compiler = Add(mujoco, "compiler");
  compiler->SetAttribute("fusestatic", false);
  compiler->SetAttribute("inertiafromgeom", false);
  compiler->SetAttribute("strippath", false);
  compiler->SetAttribute("discardvisual", true);
  Set(Add(mujoco, "option"), "gravity", Text(Vector3(0, 0, -gravity)));
}

// Returns the URDF. MuJoCo's element contains the gravity [m/s²]. Other readers ignore this
// element. URDF-Importer has requirements beyond the format's rules, which the text meets: every
// moving joint has an axis, every limit has an effort and a velocity, every material has a name,
// and only materials of the same colour have the same name. Meshes and textures are added to
// `meshes`. Throws the same InputError as PackageMeshes.
std::string UrdfText(const SceneTree& tree, double gravity, PackageMeshes* meshes) {
  tinyxml2::XMLDocument doc;
  doc.InsertEndChild(doc.NewDeclaration());
  doc.InsertEndChild(doc.NewComment(" Written by predictor export scene; see README.txt. "));
  XmlElement* robot = doc.NewElement("robot");
  doc.InsertEndChild(robot);
  Set(robot, "name", "predictor_scene");
  AddMujoco(robot, gravity);
  for (const SceneLink& link : tree.links) AddLink(robot, link, meshes);
  for (const SceneJoint& joint : tree.joints) AddJoint(robot, joint);
  tinyxml2::XMLPrinter printer;
  doc.Print(&printer);
  return printer.CStr();
}

// ---- the package

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

constexpr const char* kGazebo = R"(
This folder was written by `predictor export scene --sdf`: the virtual scene of a scenario as one
SDF 1.9 file, scene.sdf, with its meshes in the folder "meshes".

Check it with `ign sdf -k scene.sdf`, and open it with Gazebo (Fortress or newer): `ign gazebo
scene.sdf` or `gz sim scene.sdf`. No controller is part of it, so the cobot falls.

The attachment is a ball joint if it is spherical. Gazebo Fortress ignores the damping of ball
joints; Ionic knows it. Frames stand for links without mass. Only the object, the movable objects
(movable_0, movable_1, …), the floor, the table and the fixtures collide. The meshes come from the models of the robot and the object; their licences apply.
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
  if (!tree.movables.empty())
    out << "The movable objects are omitted, because a URDF is one tree. An SDF contains them.\n";
  if (!left_out.empty()) out << "\nNot found and therefore omitted: " << Join(left_out) << ".\n";
  return out.str();
}

}  // namespace

ScenePackage MakeScenePackage(const Scenario& scenario, SceneFormat format) {
  const SceneTree tree = ComposeTree(scenario);
  PackageMeshes meshes(scenario.folder());
  const bool is_sdf = format == SceneFormat::kSdf;
  const std::string text = is_sdf ? SdfText(tree, scenario, &meshes)
                                  : UrdfText(tree, scenario.environment.gravity, &meshes);
  ScenePackage package;
  package.files = meshes.files();
  package.notes = meshes.notes();
  package.files[is_sdf ? kSceneSdf : kSceneUrdf].text = text;
  if (is_sdf) {
    package.files["README.txt"].text = scenario.name + "\n" + kGazebo;
    return package;
  }
  package.files["package.xml"].text = kPackageXml;
  package.files["README.txt"].text = Readme(scenario, tree, meshes.left_out());
  return package;
}

}  // namespace predictor::scene_export
