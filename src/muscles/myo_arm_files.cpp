#include "muscles/myo_arm_files.h"

#include <array>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"

namespace predictor::muscles {
namespace {

using MyoSpec = std::unique_ptr<mjSpec, MyoDeleter>;
using Message = std::array<char, 1000>;

void DeleteAll(mjSpec* spec, mjtObj kind) {
  for (mjsElement* element = mjs_firstElement(spec, kind); element != nullptr;) {
    mjsElement* next = mjs_nextElement(spec, element);
    mjs_delete(spec, element);
    element = next;
  }
}

// The file contains the inertias of the bodies, so only pictures need the shapes of the bones. The
// shapes around which tendons wrap are not shapes of the bones.
void DeletePictures(mjSpec* spec) {
  for (mjsElement* element = mjs_firstElement(spec, mjOBJ_GEOM); element != nullptr;) {
    mjsElement* next = mjs_nextElement(spec, element);
    const mjsGeom* geom = mjs_asGeom(element);
    if (geom->type == mjGEOM_MESH)
      mjs_delete(spec, element);
    else
      mjs_setString(geom->material, "");
    element = next;
  }
  for (const mjtObj kind : {mjOBJ_MESH, mjOBJ_SKIN, mjOBJ_MATERIAL, mjOBJ_TEXTURE, mjOBJ_EXCLUDE,
                            mjOBJ_PAIR, mjOBJ_SENSOR, mjOBJ_CAMERA, mjOBJ_KEY})
    DeleteAll(spec, kind);
}

// The middle deltoid passes through a point of the upper arm. In the MoBL ARMS model, from which
// MyoArm was converted, this point lies on the outer side of the bone (z > 0). In MyoArm, its z has
// the opposite sign. The line then runs through the bone, is longer than the muscle's lengthrange,
// and does not abduct the arm. The point is mirrored to the outer side (D).
void RepairMiddleDeltoid(mjSpec* spec) {
  for (const char* name : {"DELT2_DELT2-P2_r", "DELT2_DELT2-P2"})
    if (mjsElement* point = mjs_findElement(spec, mjOBJ_SITE, name)) {
      double* z = &mjs_asSite(point)->pos[2];
      *z = std::abs(*z);
    }
}

std::string FirstLineOf(const Message& error) {
  const std::string text = error.data();
  return Printable(text.substr(0, text.find('\n')));
}

MyoModel Compile(MyoSpec spec, const Message& error, const std::filesystem::path& source) {
  if (!spec)
    throw InputError(source.string(),
                     "MuJoCo cannot read this model. Give the folder myo_sim/models of the package "
                     "myo-sim, or one MJCF file with the whole arm. The reason is: " +
                         FirstLineOf(error));
  DeletePictures(spec.get());
  RepairMiddleDeltoid(spec.get());
  MyoModel model(mj_compile(spec.get(), nullptr));
  if (!model)
    throw InputError(source.string(),
                     "MuJoCo cannot compile this model: " + Printable(mjs_getError(spec.get())));
  return model;
}

MyoModel FromText(const std::string& text, const std::filesystem::path& source) {
  Message error = {};
  MyoSpec spec(mj_parseXMLString(text.c_str(), nullptr, error.data(), error.size()));
  return Compile(std::move(spec), error, source);
}

std::string Include(const std::filesystem::path& file) {
  return "<include file=\"" + EscapeMarkup(file.string()) + "\"/>";
}

// The torso carries the origins of some muscles and the site to which the arm is attached.
std::string TorsoAssets(const std::filesystem::path& folder) {
  return "<compiler angle=\"radian\"/>" +
         Include(folder / "torso" / "assets" / "myotorso_assets.xml") +
         Include(folder / "head" / "assets" / "myohead_simple_assets.xml");
}
std::string TorsoBody(const std::filesystem::path& folder) {
  return "<body name=\"predictor_torso\">" +
         Include(folder / "torso" / "assets" / "myotorso_chain.xml") + "</body>";
}

// Returns the arm's pose as attributes of a body.
std::string PlaceOfArm(const std::filesystem::path& folder) {
  const MyoModel torso = FromText("<mujoco>" + TorsoAssets(folder) + "<worldbody>" +
                                      TorsoBody(folder) + "</worldbody></mujoco>",
                                  folder);
  const int site = mj_name2id(torso.get(), mjOBJ_SITE, "arm_attach_r");
  if (site < 0)
    throw InputError(folder.string(),
                     "The torso of the model has no site arm_attach_r. Use myo-sim 0.2.4.");
  const std::unique_ptr<mjData, MyoDeleter> data(mj_makeData(torso.get()));
  mj_kinematics(torso.get(), data.get());
  const mjtNum* p = data->site_xpos + 3 * static_cast<std::ptrdiff_t>(site);
  std::array<mjtNum, 4> q;
  mju_mat2Quat(q.data(), data->site_xmat + 9 * static_cast<std::ptrdiff_t>(site));
  return Formatted("pos=\"%.17g %.17g %.17g\" quat=\"%.17g %.17g %.17g %.17g\"", p[0], p[1], p[2],
                   q[0], q[1], q[2], q[3]);
}

MyoModel FromFolder(const std::filesystem::path& given) {
  const std::filesystem::path folder = std::filesystem::absolute(given);
  const std::filesystem::path arm = folder / "arm" / "assets";
  if (!std::filesystem::exists(arm / "myoarm_r_chain.xml"))
    throw InputError(given.string(),
                     "The folder has no arm/assets/myoarm_r_chain.xml. Give the folder "
                     "myo_sim/models of the package myo-sim 0.2.4.");
  const std::string place = PlaceOfArm(folder);
  return FromText("<mujoco>" + TorsoAssets(folder) + Include(arm / "myoarm_r_assets.xml") +
                      Include(arm / "myoarm_r_tendon.xml") + Include(arm / "myoarm_r_muscle.xml") +
                      "<worldbody>" + TorsoBody(folder) + "<body name=\"predictor_arm\" " + place +
                      ">" + Include(arm / "myoarm_r_chain.xml") + "</body></worldbody></mujoco>",
                  folder);
}

}  // namespace

MyoModel ReadMyoArm(const std::filesystem::path& model) {
  std::error_code error;
  if (std::filesystem::is_directory(model, error)) return FromFolder(model);
  if (!std::filesystem::is_regular_file(model, error))
    throw InputError(model.string(), "The model cannot be read. Check its name.");
  Message message = {};
  MyoSpec spec(mj_parseXML(model.string().c_str(), nullptr, message.data(), message.size()));
  return Compile(std::move(spec), message, model);
}

}  // namespace predictor::muscles
