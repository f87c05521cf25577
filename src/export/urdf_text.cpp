#include "export/urdf_text.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "models/urdf_xml.h"

namespace predictor::scene_export {
namespace {

constexpr double kNoLimit = 1e6;    // replaces an infinite limit: no reader accepts "inf"
constexpr double kNothing = 1e-15;  // smaller values are rounding errors of zero

XmlElement* Add(XmlElement* parent, const char* name) {
  return parent->InsertNewChildElement(name);
}

void Set(XmlElement* element, const char* attribute, const std::string& value) {
  element->SetAttribute(attribute, value.c_str());
}

std::string Text(double x) { return FormatNumber(std::abs(x) < kNothing ? 0 : x); }

std::string Text(const Vector3& x) { return Text(x.x()) + " " + Text(x.y()) + " " + Text(x.z()); }

std::string Text(const std::array<double, 4>& x) {
  return Text(x[0]) + " " + Text(x[1]) + " " + Text(x[2]) + " " + Text(x[3]);
}

// Roll, pitch and yaw [rad]. Roll is computed last, from the rotation that remains after yaw. The
// three angles are therefore consistent at a vertical pitch, where roll and yaw are not unique.
Vector3 RollPitchYaw(const Matrix3& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double s = std::sin(yaw), c = std::cos(yaw);
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

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

// URDF-Importer keeps materials by name, even across imports. Therefore the name describes the
// material.
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

// Without this element MuJoCo merges fixed links, loses the mass of links that are fixed to the
// world, and looks for meshes beside the URDF.
void AddMujoco(XmlElement* robot, double gravity) {
  XmlElement* mujoco = Add(robot, "mujoco");
  XmlElement* compiler = Add(mujoco, "compiler");
  compiler->SetAttribute("fusestatic", false);
  compiler->SetAttribute("inertiafromgeom", false);
  compiler->SetAttribute("strippath", false);
  compiler->SetAttribute("discardvisual", true);
  Set(Add(mujoco, "option"), "gravity", Text(Vector3(0, 0, -gravity)));
}

}  // namespace

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

}  // namespace predictor::scene_export
