#include "models/urdf_planar.h"

#include <string>
#include <vector>

#include "core/text.h"

namespace predictor {
namespace {

constexpr double kCarrierMass = 1e-6;     // mass of a link between two joints [kg]
constexpr double kCarrierInertia = 1e-9;  // principal moments of such a link [kg·m²]

std::string Text(const Vector3& v) {
  return FormatNumber(v.x()) + " " + FormatNumber(v.y()) + " " + FormatNumber(v.z());
}

// Returns the direction of x in the plane.
Vector3 InPlane(const Vector3& normal) {
  constexpr double kNearlyNormal = 0.9;
  const Vector3 along = std::abs(normal.x()) < kNearlyNormal ? Vector3::UnitX() : Vector3::UnitY();
  return (along - along.dot(normal) * normal).normalized();
}

class Splitter {
 public:
  Splitter(const UrdfSource& source, XmlElement* robot, XmlElement* joint)
      : source_(source), robot_(robot), joint_(joint), name_(source.Text(*joint, "name")) {}

  void Split() {
    for (const char* ending : {"_x", "_y", "_yaw"}) RefuseTaken("joint", name_ + ending);
    for (const char* ending : {"_x_link", "_y_link"}) RefuseTaken("link", name_ + ending);
    // The planar joint is read as a prismatic joint, so that errors in its axis and limits refer to
    // the joint's place in the file.
    joint_->SetAttribute("type", "prismatic");
    UrdfJoint plane;
    plane.name = name_;
    ReadJoint(source_, *joint_, &plane);
    const std::string parent = source_.Text(source_.Required(*joint_, "parent"), "link");
    source_.Required(*joint_, "limit");
    const Vector3 x = InPlane(plane.axis), y = plane.axis.cross(x);
    AddSlide("_x", parent, x, true);
    AddSlide("_y", name_ + "_x_link", y, false);
    TurnAbout(plane.axis);
  }

 private:
  void RefuseTaken(const char* kind, const std::string& name) const {
    for (const XmlElement* e = robot_->FirstChildElement(kind); e != nullptr;
         e = e->NextSiblingElement(kind))
      if (e->Attribute("name", name.c_str()) != nullptr)
        source_.Fail(*joint_, "The planar joint " + Quote(name_) + " is read as joints " +
                                  Quote(name_ + "_x") + ", " + Quote(name_ + "_y") + " and " +
                                  Quote(name_ + "_yaw") + " with links between them, but the " +
                                  kind + " " + Quote(name) + " exists. Rename it.");
  }

  void InsertBefore(XmlElement* added) {
    tinyxml2::XMLNode* before = joint_->PreviousSibling();
    if (before != nullptr)
      robot_->InsertAfterChild(before, added);
    else
      robot_->InsertFirstChild(added);
  }

  // Adds a prismatic joint from `parent` to the new link NAME<ending>_link.
  void AddSlide(const std::string& ending, const std::string& parent, const Vector3& axis,
                bool at_origin) {
    tinyxml2::XMLDocument* doc = joint_->GetDocument();
    const std::string link_name = name_ + ending + "_link";
    XmlElement* link = doc->NewElement("link");
    link->SetAttribute("name", link_name.c_str());
    XmlElement* inertial = link->InsertNewChildElement("inertial");
    inertial->InsertNewChildElement("mass")->SetAttribute("value", kCarrierMass);
    XmlElement* inertia = inertial->InsertNewChildElement("inertia");
    for (const char* moment : {"ixx", "iyy", "izz"}) inertia->SetAttribute(moment, kCarrierInertia);
    XmlElement* slide = doc->NewElement("joint");
    slide->SetAttribute("name", (name_ + ending).c_str());
    slide->SetAttribute("type", "prismatic");
    if (const XmlElement* origin = joint_->FirstChildElement("origin"); origin && at_origin)
      slide->InsertEndChild(origin->DeepClone(doc));
    slide->InsertNewChildElement("parent")->SetAttribute("link", parent.c_str());
    slide->InsertNewChildElement("child")->SetAttribute("link", link_name.c_str());
    slide->InsertNewChildElement("axis")->SetAttribute("xyz", Text(axis).c_str());
    slide->InsertEndChild(joint_->FirstChildElement("limit")->DeepClone(doc));
    InsertBefore(link);
    InsertBefore(slide);
  }

  // Turns the planar joint itself into the continuous joint about the plane's normal.
  void TurnAbout(const Vector3& normal) {
    joint_->SetAttribute("name", (name_ + "_yaw").c_str());
    joint_->SetAttribute("type", "continuous");
    for (const char* part : {"origin", "limit", "axis"})
      if (XmlElement* element = joint_->FirstChildElement(part)) joint_->DeleteChild(element);
    joint_->FirstChildElement("parent")->SetAttribute("link", (name_ + "_y_link").c_str());
    joint_->InsertNewChildElement("axis")->SetAttribute("xyz", Text(normal).c_str());
  }

  const UrdfSource& source_;
  XmlElement* robot_;
  XmlElement* joint_;
  std::string name_;
};

}  // namespace

void SplitPlanarJoints(const UrdfSource& source, XmlElement* robot) {
  std::vector<XmlElement*> planar;
  for (XmlElement* e = robot->FirstChildElement("joint"); e != nullptr;
       e = e->NextSiblingElement("joint"))
    if (e->Attribute("type", "planar") != nullptr) planar.push_back(e);
  for (XmlElement* joint : planar) Splitter(source, robot, joint).Split();
}

}  // namespace predictor
