#include "export/materials.h"

#include "models/urdf_xml.h"
#include "scenario/paths.h"

namespace predictor::scene_export {
namespace {

// The robot's material of the same name. It supplies the values that the visual's own material
// omits.
const XmlElement* GlobalMaterial(const XmlElement& robot, const XmlElement& material) {
  const char* name = material.Attribute("name");
  for (const XmlElement* global = robot.FirstChildElement("material");
       name != nullptr && global != nullptr; global = global->NextSiblingElement("material")) {
    if (global->Attribute("name", name) != nullptr) return global;
  }
  return nullptr;
}

const char* TextureOf(const XmlElement* material) {
  const XmlElement* texture = material ? material->FirstChildElement("texture") : nullptr;
  return texture ? texture->Attribute("filename") : nullptr;
}

bool HasColor(const XmlElement* material) {
  return material != nullptr && material->FirstChildElement("color") != nullptr;
}

SceneShape Read(const XmlElement& robot, const XmlElement& visual, const ModelShape& shape,
                const UrdfModel& urdf, const std::filesystem::path& scenario_folder) {
  SceneShape out{shape, shape.kind != ShapeKind::kMesh, {}};
  const XmlElement* material = visual.FirstChildElement("material");
  if (material == nullptr) return out;
  const XmlElement* global = GlobalMaterial(robot, *material);
  const char* texture = TextureOf(material) ? TextureOf(material) : TextureOf(global);
  if (texture != nullptr) {
    out.texture = ResolveModelPath(texture, urdf.file.parent_path(), scenario_folder);
  }
  out.has_color = out.has_color || HasColor(material) || HasColor(global);
  return out;
}

}  // namespace

UrdfMaterials::UrdfMaterials(const UrdfModel& urdf, const std::filesystem::path& scenario_folder)
    : visuals_(urdf.links.size()) {
  tinyxml2::XMLDocument doc;
  const XmlElement* robot = ParseXml(urdf.text, {urdf.file.string(), {}}, &doc);
  std::size_t i = 0;  // the text contains the links and their visuals in the same order as the
                      // model
  for (const XmlElement* link = robot->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link"), ++i) {
    const XmlElement* visual = link->FirstChildElement("visual");
    for (const ModelShape& shape : urdf.links[i].visuals) {
      visuals_[i].push_back(Read(*robot, *visual, shape, urdf, scenario_folder));
      visual = visual->NextSiblingElement("visual");
    }
  }
}

}  // namespace predictor::scene_export
