#include "models/mujoco_urdf.h"

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
