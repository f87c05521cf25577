#include "models/mujoco_urdf.h"

#include <algorithm>
#include <set>

#include "core/error.h"
#include "models/urdf_xml.h"

namespace predictor {
namespace {

void DeleteChildren(XmlElement* element, const std::set<std::string>& names) {
  XmlElement* next = nullptr;
  for (XmlElement* child = element->FirstChildElement(); child != nullptr; child = next) {
    next = child->NextSiblingElement();
    if (names.count(child->Name()) > 0) element->DeleteChild(child);
  }
}

// MuJoCo mistakes a link named "world" for MuJoCo's own world and loses the link's mass.
void RenameWorld(const UrdfModel& urdf, XmlElement* robot) {
  const std::vector<std::string> names = urdf.LinkNames();
  std::string name = "world_link";
  while (std::find(names.begin(), names.end(), name) != names.end()) name += '_';
  const auto rename = [&name](XmlElement* element, const char* attribute) {
    if (element->Attribute(attribute, "world")) element->SetAttribute(attribute, name.c_str());
  };
  for (XmlElement* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (std::string(e->Name()) == "link") rename(e, "name");
    if (std::string(e->Name()) != "joint") continue;
    rename(e->FirstChildElement("parent"), "link");
    rename(e->FirstChildElement("child"), "link");
  }
}

}  // namespace

std::string MujocoUrdf(const UrdfModel& urdf, MujocoShapes shapes) {
  tinyxml2::XMLDocument doc;
  XmlElement* robot = ParseXml(urdf.text, {urdf.file.string(), {}}, &doc);
  DeleteChildren(robot, {"mujoco", "gazebo", "transmission", "material", "sensor"});
  std::set<std::string> unwanted = {"visual"};
  if (shapes == MujocoShapes::kNone) unwanted.insert("collision");
  for (XmlElement* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (std::string(e->Name()) == "link") DeleteChildren(e, unwanted);
    if (std::string(e->Name()) == "joint") DeleteChildren(e, {"dynamics", "safety_controller"});
  }
  RenameWorld(urdf, robot);
  XmlElement* compiler = robot->InsertNewChildElement("mujoco")->InsertNewChildElement("compiler");
  compiler->SetAttribute("fusestatic", false);
  compiler->SetAttribute("inertiafromgeom", false);
  compiler->SetAttribute("strippath", false);
  compiler->SetAttribute("discardvisual", true);
  tinyxml2::XMLPrinter printer;
  doc.Print(&printer);
  return printer.CStr();
}

}  // namespace predictor
