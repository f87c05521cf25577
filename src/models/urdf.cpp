#include "models/urdf.h"

#include <system_error>
#include <unordered_map>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "models/urdf_planar.h"
#include "models/urdf_tree.h"
#include "models/urdf_xml.h"

namespace predictor {
namespace {

constexpr std::uintmax_t kMaxUrdfBytes = 4u << 20;  // maximum size of a URDF
constexpr std::size_t kMaxLinks = 1000;
constexpr double kMinInertia = 1e-11;  // smallest trace that counts as inertia [kg·m²]: a cube of
                                       // 1 g and 0.1 mm

std::string ReadText(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError(file.string(),
                     "This file does not exist or is not a regular file. Give a URDF file.");
  }
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error || bytes > kMaxUrdfBytes) {
    throw InputError(file.string(), "The file has " + std::to_string(bytes) +
                                        " bytes, but a URDF can have at most " +
                                        std::to_string(kMaxUrdfBytes) +
                                        ". Move the shapes into mesh files.");
  }
  return ReadWholeFile(file, bytes);
}

// Maps each name to its index. Duplicate names are refused.
using Names = std::unordered_map<std::string, int>;

std::string UniqueName(const UrdfSource& source, const XmlElement& element, Names* names) {
  const std::string name = source.Text(element, "name");
  if (!names->emplace(name, static_cast<int>(names->size())).second) {
    source.Fail(element, "A second " + std::string(element.Name()) + " has the name " +
                             Quote(name) + ". Rename one of them.");
  }
  return name;
}

void ReadLinkNames(const UrdfSource& source, XmlElement* robot, UrdfDocument* to, Names* names) {
  for (XmlElement* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (std::string(e->Name()).rfind("xacro:", 0) == 0) {
      source.Fail(*e, "This is a xacro file. Expand it first: xacro FILE.urdf.xacro > FILE.urdf.");
    }
    if (std::string(e->Name()) != "link") continue;
    UrdfLink link;
    link.name = UniqueName(source, *e, names);
    link.line = e->GetLineNum();
    to->model.links.push_back(link);
    to->links.push_back(e);
  }
  const std::size_t count = to->model.links.size();
  if (count == 0 || count > kMaxLinks) {
    source.Fail(*robot, "The robot has " + std::to_string(count) + " links; it must have 1 to " +
                            std::to_string(kMaxLinks) + ".");
  }
}

int LinkOf(const UrdfSource& source, const XmlElement& joint, const char* which,
           const UrdfModel& model, const Names& names) {
  const XmlElement& element = source.Required(joint, which);
  const std::string link = source.Text(element, "link");
  const auto found = names.find(link);
  if (found == names.end()) {
    source.Fail(element, std::string("The ") + which + " of joint " +
                             Quote(joint.Attribute("name")) + " is " + Quote(link) +
                             ", but this link does not exist. " +
                             Suggestion(link, model.LinkNames()));
  }
  return found->second;
}

void ReadJointNames(const UrdfSource& source, XmlElement* robot, const Names& links,
                    UrdfDocument* to) {
  Names names;
  for (XmlElement* e = robot->FirstChildElement("joint"); e != nullptr;
       e = e->NextSiblingElement("joint")) {
    UrdfJoint joint;
    joint.name = UniqueName(source, *e, &names);
    joint.line = e->GetLineNum();
    joint.parent = LinkOf(source, *e, "parent", to->model, links);
    joint.child = LinkOf(source, *e, "child", to->model, links);
    to->model.joints.push_back(joint);
    to->joints.push_back(e);
  }
}

// Checks that everything that moves as one body has mass and inertia. Without mass and inertia, the
// acceleration of a joint would be undefined.
void CheckMovingMasses(const UrdfSource& source, const UrdfModel& model) {
  std::vector<double> mass(model.links.size()), inertia(model.links.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    mass[i] = model.links[i].mass;
    inertia[i] = model.links[i].inertia.trace();
  }
  for (auto joint = model.joints.rbegin(); joint != model.joints.rend(); ++joint) {
    const auto child = static_cast<std::size_t>(joint->child);
    const auto parent = static_cast<std::size_t>(joint->parent);
    if (joint->type == UrdfJointType::kFixed) {  // lumps fixed links; a lever arm adds inertia
      inertia[parent] += inertia[child] + mass[child] * joint->X_PJ.p.squaredNorm();
      mass[parent] += mass[child];
    } else if (mass[child] <= 0 || inertia[child] <= kMinInertia) {
      throw InputError(source.name + ":" + std::to_string(model.links[child].line),
                       "Link " + Quote(model.links[child].name) + " is moved by joint " +
                           Quote(joint->name) + ", but it has the " +
                           (mass[child] <= 0 ? "mass 0 kg" : "inertia 0 kg·m²") +
                           " including all links that are fixed to it. Give it an <inertial> with "
                           "mass and inertia, or make the joint fixed.");
    }
  }
}

// Returns the XML after processing, with links removed, absolute mesh paths and independent joints.
std::string Print(const tinyxml2::XMLDocument& doc) {
  tinyxml2::XMLPrinter printer;
  doc.Print(&printer);
  return printer.CStr();
}

}  // namespace

std::vector<std::string> UrdfModel::LinkNames() const {
  std::vector<std::string> names;
  for (const UrdfLink& link : links) names.push_back(link.name);
  return names;
}

double UrdfModel::Mass() const {
  double mass = 0;
  for (const UrdfLink& link : links) mass += link.mass;
  return mass;
}

double UrdfModel::MovingMass() const {
  std::vector<bool> moves(links.size(), false);
  double mass = 0;
  for (const UrdfJoint& joint : joints) {  // parents come before children
    const auto child = static_cast<std::size_t>(joint.child);
    moves[child] =
        joint.type != UrdfJointType::kFixed || moves[static_cast<std::size_t>(joint.parent)];
    if (moves[child]) mass += links[child].mass;
  }
  return mass;
}

UrdfModel ReadUrdf(const std::filesystem::path& file, const std::vector<std::string>& remove_links,
                   const std::filesystem::path& scenario_folder) {
  UrdfModel model =
      ParseUrdf(ReadText(file), file.string(), file.parent_path(), remove_links, scenario_folder);
  model.file = file;
  return model;
}

UrdfModel ParseUrdf(const std::string& text, const std::string& name,
                    const std::filesystem::path& folder,
                    const std::vector<std::string>& remove_links,
                    const std::filesystem::path& scenario_folder) {
  if (text.size() > kMaxUrdfBytes) {
    throw InputError(name, "The text has " + std::to_string(text.size()) +
                               " bytes, but a URDF can have at most " +
                               std::to_string(kMaxUrdfBytes) + ".");
  }
  const UrdfSource source{name, folder, scenario_folder};
  tinyxml2::XMLDocument doc;
  XmlElement* robot = ParseXml(text, source, &doc);
  SplitPlanarJoints(source, robot);
  UrdfDocument urdf;
  urdf.model.file = name;
  urdf.model.name = robot->Attribute("name") ? robot->Attribute("name") : "";
  Names links;
  ReadLinkNames(source, robot, &urdf, &links);
  ReadJointNames(source, robot, links, &urdf);
  SortTree(source, &urdf);
  RemoveLinks(remove_links, robot, &urdf);
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    ReadInertial(source, urdf.links[i], &urdf.model.links[i]);
    ReadShapes(source, *robot, urdf.links[i], &urdf.model.links[i]);
  }
  for (std::size_t i = 0; i < urdf.joints.size(); ++i) {
    ReadJoint(source, *urdf.joints[i], &urdf.model.joints[i]);
    while (XmlElement* mimic = urdf.joints[i]->FirstChildElement("mimic")) {
      if (const char* joint = mimic->Attribute("joint")) urdf.model.joints[i].mimics = joint;
      doc.DeleteNode(mimic);
    }
  }
  CheckMovingMasses(source, urdf.model);
  urdf.model.text = Print(doc);
  return std::move(urdf.model);
}

const char* Name(UrdfJointType type) {
  switch (type) {
    case UrdfJointType::kRevolute:
      return "revolute";
    case UrdfJointType::kContinuous:
      return "continuous";
    case UrdfJointType::kPrismatic:
      return "prismatic";
    default:
      return "fixed";
  }
}

}  // namespace predictor
