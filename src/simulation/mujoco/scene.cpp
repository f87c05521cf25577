#include "simulation/mujoco/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "models/mujoco_urdf.h"
#include "models/urdf.h"
#include "scenario/paths.h"
#include "simulation/mujoco/cobot_contacts.h"
#include "simulation/mujoco/fixtures.h"
#include "simulation/mujoco/mesh_holes.h"
#include "simulation/mujoco/movables.h"
#include "simulation/mujoco/shapes.h"
#include "simulation/touches.h"

namespace predictor {
namespace {

constexpr double kTimestep = 0.001;   // [s]
constexpr double kHandRadius = 0.04;  // radius of the ball that defines a hand's inertia [m]
constexpr double kHandleReach = 0.2;  // maximum distance of a handle from the object's shape [m]
// The engine's Coulomb friction creeps under small forces. With the engine's default constants
// (0.02, 0.9), this friction creeps fifty times more than with the constants below.
constexpr double kFrictionTime = 0.004;  // [s]
constexpr double kFrictionImpedance = 0.99;
constexpr double kFarAway = 1000;  // where a removed fixture is [m]
constexpr const char* kObjectName = "object";
constexpr const char* kObjectJoint = "object_motion";
constexpr std::array<const char*, kHands> kHandleSites = {"left_handle", "right_handle"};
constexpr const char* kWristSite = "wrist";
constexpr std::array<const char*, kHands> kHandBodies = {"left_hand", "right_hand"};

void SetOptions(mjSpec* spec, const EnvironmentSpec& environment) {
  spec->compiler.fusestatic = 0;  // keeps the flange's frames
  spec->compiler.saveinertial = 1;
  spec->compiler.degree = 0;
  mjOption& option = spec->option;
  option.timestep = kTimestep;
  option.integrator = mjINT_IMPLICITFAST;
  option.cone = mjCONE_ELLIPTIC;
  option.disableflags |= mjDSBL_AUTORESET | mjDSBL_SENSOR;
  SetVector(option.gravity, Vector3(0, 0, -environment.gravity));
  // With many movable objects, the engine would otherwise choose sparse rows, which AddReactions
  // does not read.
  if (!environment.objects.empty()) option.jacobian = mjJAC_DENSE;
}

// The model of the cobot alone, in the form in which the engine loads it.
SpecPtr CobotSpecOf(const Scenario& scenario) {
  const auto file = ResolveModelPath(scenario.cobot.model, scenario.folder());
  const std::string text =
      MujocoUrdf(ReadUrdf(file, scenario.cobot.remove_links, scenario.folder()));
  char error[512] = "";
  SpecPtr spec(mj_parseXMLString(text.c_str(), nullptr, error, sizeof(error)));
  if (spec == nullptr) {
    throw InputError::At("cobot.model", "cobot.model: " + file.string() +
                                            ": The physics engine cannot load the cobot: " +
                                            std::string(error) + ". Repair the URDF.");
  }
  return spec;
}

void SetJointFriction(mjSpec* spec, const JointFriction& friction, const RobotModel& cobot) {
  const auto check = [&cobot](const std::vector<double>& values, const std::string& key) {
    const int size = static_cast<int>(values.size());
    if (size == 1 || size == cobot.dof()) return;
    throw InputError::At(key, key + " has " + std::to_string(size) +
                                  " values. Give one for all joints, or " +
                                  std::to_string(cobot.dof()) + ".");
  };
  check(friction.viscous, "cobot.joint_friction.viscous");
  check(friction.coulomb, "cobot.joint_friction.coulomb");
  for (int j = 0; j < cobot.dof(); ++j) {
    const std::string name = kCobotPrefix + cobot.joint_name(j);
    mjsJoint* joint = mjs_asJoint(mjs_findElement(spec, mjOBJ_JOINT, name.c_str()));
    if (joint == nullptr) {
      throw InputError::At("cobot.model", "cobot.model: the joint " + Quote(cobot.joint_name(j)) +
                                              " is missing in the physics engine's model.");
    }
    joint->damping[0] = OneOrEach(friction.viscous, j);
    joint->frictionloss = OneOrEach(friction.coulomb, j);
    joint->solref_friction[0] = kFrictionTime;
    std::fill_n(joint->solimp_friction, 2, kFrictionImpedance);
  }
}

bool HasLimits(const Scenario& scenario) {
  return scenario.simulation.joint_limits != JointLimits::kNone;
}

// Removes the position limits of the cobot's joints.
void RemoveLimits(mjSpec* spec, const RobotModel& cobot) {
  for (int j = 0; j < cobot.dof(); ++j) {
    const std::string name = kCobotPrefix + cobot.joint_name(j);
    mjs_asJoint(mjs_findElement(spec, mjOBJ_JOINT, name.c_str()))->limited = mjLIMITED_FALSE;
  }
}

// Returns the body of the end-effector.
mjsBody* AddCobot(mjSpec* spec, const Scenario& scenario, const RobotModel& cobot) {
  const SpecPtr urdf = CobotSpecOf(scenario);
  mjsFrame* frame = mjs_addFrame(mjs_findBody(spec, "world"), nullptr);
  SetPose(frame->pos, frame->quat, scenario.cobot.base.ToPose());
  mjsElement* root = mjs_firstChild(mjs_findBody(urdf.get(), "world"), mjOBJ_BODY, 0);
  if (root == nullptr || mjs_attach(frame->element, root, kCobotPrefix, "") == nullptr) {
    throw InputError::At("cobot.model", "cobot.model: the physics engine cannot place the cobot: " +
                                            std::string(mjs_getError(spec)));
  }
  SetJointFriction(spec, scenario.cobot.joint_friction, cobot);
  if (!HasLimits(scenario)) RemoveLimits(spec, cobot);
  const std::string name = kCobotPrefix + scenario.cobot.end_effector;
  mjsBody* end_effector = mjs_findBody(spec, name.c_str());
  if (end_effector == nullptr) {
    throw InputError::At("cobot.end_effector",
                         "cobot.end_effector: the physics engine has no link " +
                             Quote(scenario.cobot.end_effector) + ".");
  }
  return end_effector;
}

std::string ObjectShape(std::size_t i) { return "object/" + std::to_string(i); }

bool TouchesAny(const EnvironmentSpec& environment, const char* what) {
  const auto touches = [what](const auto& body) { return body.Touches(what); };
  return std::ranges::any_of(environment.fixtures, touches) ||
         std::ranges::any_of(environment.objects, touches);
}

// Adds the pairs of shapes that can touch. The shapes of the object must have been added before
// this call. Returns the pairs of cobot.touches that do not collide because they always touch.
std::vector<ContactPair> AddAllContacts(mjSpec* spec, const Scenario& scenario,
                                        const ObjectModel& object, const MovableModels& movables) {
  const EnvironmentSpec& environment = scenario.environment;
  const bool own_contacts = !scenario.cobot.touches.empty();
  std::optional<CobotShapes> links;
  std::vector<std::string> cobot, carried;
  if (own_contacts || TouchesAny(environment, "cobot")) {
    links.emplace(spec, scenario, TouchesAny(environment, "cobot"));
    cobot = links->Moving();
    RequireShapes(scenario, Toucher::kCobot, cobot.size());
  }
  RequireShapes(scenario, Toucher::kObject, object.collisions.size());
  for (std::size_t i = 0; i < object.collisions.size(); ++i) carried.push_back(ObjectShape(i));
  if (TouchesAny(environment, "object") || scenario.cobot.Touches("object"))
    for (const ModelShape& shape : object.collisions) CheckHull(shape, "object.model");
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i) {
    if (environment.fixtures[i].Touches("object")) AddContacts(spec, environment, i, carried);
    if (environment.fixtures[i].Touches("cobot")) AddContacts(spec, environment, i, cobot);
  }
  AddMovableContacts(spec, environment, movables, carried, cobot);
  return own_contacts ? links->AddContacts(spec, scenario, carried) : std::vector<ContactPair>();
}

// Adds the attachment's joint, in frame A.
void AddAttachmentJoint(mjsBody* object, const AttachmentSpec& spec, bool has_limits) {
  if (spec.joint == JointType::kFixed) return;
  const Pose X_OA = spec.on_object.ToPose();
  mjsJoint* joint = mjs_addJoint(object, nullptr);
  mjs_setName(joint->element, "attachment");
  SetVector(joint->pos, X_OA.p);
  SetVector(joint->axis, X_OA.q * spec.axis);
  joint->damping[0] = spec.damping;
  joint->type = spec.joint == JointType::kSpherical  ? mjJNT_BALL
                : spec.joint == JointType::kRevolute ? mjJNT_HINGE
                                                     : mjJNT_SLIDE;
  if (has_limits && spec.range && joint->type != mjJNT_BALL) {
    joint->limited = mjLIMITED_TRUE;
    std::copy(spec.range->begin(), spec.range->end(), joint->range);
  }
}

// `end_effector` is null for a free object.
mjsBody* AddObject(mjSpec* spec, mjsBody* end_effector, const Scenario& scenario,
                   const ObjectModel& model) {
  const AttachmentSpec& attachment = scenario.object.attachment;
  mjsBody* object = mjs_addBody(end_effector ? end_effector : mjs_findBody(spec, "world"), nullptr);
  mjs_setName(object->element, kObjectName);
  if (end_effector) {
    SetPose(object->pos, object->quat,
            attachment.on_end_effector.ToPose() * attachment.on_object.ToPose().Inverse());
    AddAttachmentJoint(object, attachment, HasLimits(scenario));
  } else {
    mjs_setName(mjs_addFreeJoint(object)->element, kObjectJoint);
  }
  SetInertia(object, model);
  for (std::size_t i = 0; i < model.collisions.size(); ++i) {
    // The mesh is named by its index, since several shapes may use the same file.
    SetContact(AddShape(spec, object, model.collisions[i], ObjectShape(i), "object.model"), false,
               scenario.environment.friction);
  }
  return object;
}

// Adds a sensor of force and torque between the end-effector and the object, at the attachment.
void AddWristSensor(mjSpec* spec, mjsBody* object, const AttachmentSpec& attachment) {
  mjsSite* site = mjs_addSite(object, nullptr);
  mjs_setName(site->element, kWristSite);
  SetPose(site->pos, site->quat, attachment.on_object.ToPose());
  for (const mjtSensor type : {mjSENS_FORCE, mjSENS_TORQUE}) {
    mjsSensor* sensor = mjs_addSensor(spec);
    sensor->type = type;
    sensor->objtype = mjOBJ_SITE;
    mjs_setString(sensor->objname, kWristSite);
  }
  spec->option.disableflags &= ~mjDSBL_SENSOR;
}

void AddHandle(mjsBody* object, const Scenario& scenario, int hand) {
  const Pose X_OD = HandlePose(scenario, hand);
  const auto h = static_cast<std::size_t>(hand);
  mjsSite* site = mjs_addSite(object, nullptr);
  mjs_setName(site->element, kHandleSites[h]);
  SetPose(site->pos, site->quat, X_OD);
  if (scenario.mode != Mode::kDirect) return;
  mjsBody* body = mjs_addBody(object, nullptr);
  mjs_setName(body->element, kHandBodies[h]);
  SetPose(body->pos, body->quat, X_OD);
  body->explicitinertial = 1;
  // Without this value, the engine would use the body's position in its parent as the centre of
  // mass.
  SetPose(body->ipos, body->iquat, Pose::Identity());
  body->gravcomp = 1;
}

void FindAddresses(Scene* scene, const Scenario& scenario, const RobotModel& cobot) {
  const mjModel& model = *scene->model;
  scene->end_effector =
      mj_name2id(&model, mjOBJ_BODY, (kCobotPrefix + scenario.cobot.end_effector).c_str());
  scene->object = mj_name2id(&model, mjOBJ_BODY, kObjectName);
  scene->wrist_site = mj_name2id(&model, mjOBJ_SITE, kWristSite);
  scene->floor = mj_name2id(&model, mjOBJ_GEOM, kFloorName);
  const int free_joint = mj_name2id(&model, mjOBJ_JOINT, kObjectJoint);
  if (free_joint >= 0) {
    scene->object_qpos = model.jnt_qposadr[free_joint];
    scene->object_dof = model.jnt_dofadr[free_joint];
  }
  for (std::size_t h = 0; h < kHands; ++h) {
    scene->hand[h] = mj_name2id(&model, mjOBJ_BODY, kHandBodies[h]);
  }
  scene->fixture_of.assign(static_cast<std::size_t>(model.ngeom), -1);
  for (std::size_t i = 0; i < scenario.environment.fixtures.size(); ++i) {
    const int geom = mj_name2id(&model, mjOBJ_GEOM, FixtureName(i).c_str());
    scene->fixture_of[static_cast<std::size_t>(geom)] = static_cast<int>(i);
    scene->fixture_place.emplace_back(Eigen::Map<const Vector3>(model.geom_pos + 3 * geom));
    scene->fixture_yields.push_back(scenario.environment.fixtures[i].stiffness.has_value());
    scene->fixture_keeps_out.push_back(scenario.environment.fixtures[i].keep_out);
    // Without this setting, RemoveFixtures would have no effect on a fixture at the world's origin.
    scene->model->geom_sameframe[geom] = mjSAMEFRAME_NONE;
  }
  for (int j = 0; j < cobot.dof(); ++j) {
    const int id = mj_name2id(&model, mjOBJ_JOINT, (kCobotPrefix + cobot.joint_name(j)).c_str());
    scene->qpos[static_cast<std::size_t>(j)] = model.jnt_qposadr[id];
    scene->dof[static_cast<std::size_t>(j)] = model.jnt_dofadr[id];
  }
}

// Returns the distance [m] from a point to the nearest of the object's shapes, each of which is
// represented by its bounding box.
double DistanceToObject(const Scene& scene, mjData* data, const Vector3& p_W) {
  const mjModel& model = *scene.model;
  double nearest = std::numeric_limits<double>::infinity();
  for (int g = 0; g < model.ngeom; ++g) {
    if (model.geom_bodyid[g] != scene.object) continue;
    const Eigen::Map<const Vector3> p_WG(data->geom_xpos + 3 * g);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->geom_xmat + 9 * g);
    const Eigen::Map<const Vector3> center(model.geom_aabb + 6 * g);
    const Eigen::Map<const Vector3> half(model.geom_aabb + 6 * g + 3);
    const Vector3 p_G = R.transpose() * (p_W - p_WG) - center;
    nearest = std::min(nearest, (p_G.cwiseAbs() - half).cwiseMax(0).norm());
  }
  return nearest;
}

void CheckHandles(const Scene& scene, const Scenario& scenario) {
  const DataPtr data(mj_makeData(scene.model.get()));
  mj_kinematics(scene.model.get(), data.get());
  for (const int hand : scenario.hands()) {
    const auto h = static_cast<std::size_t>(hand);
    const int site = mj_name2id(scene.model.get(), mjOBJ_SITE, kHandleSites[h]);
    const double distance =
        DistanceToObject(scene, data.get(), Eigen::Map<Vector3>(data->site_xpos + 3 * site));
    if (distance <= kHandleReach || std::isinf(distance)) continue;
    const std::string key = std::string("handles.") + kHandNames[h] + ".xyz";
    throw InputError::At(key, key + " is " + FormatNumber(std::round(distance * 1000) / 1000) +
                                  " m outside the object's shape. A handle must be at most " +
                                  FormatNumber(kHandleReach) +
                                  " m from it. Give the pose in the object's own frame in metres.");
  }
}

}  // namespace

Scene ComposeScene(const Scenario& scenario, const RobotModel& cobot, bool wrist_sensor,
                   Holding holding) {
  SilenceMujoco();
  Scene scene;
  scene.spec.reset(mj_makeSpec());
  mjSpec* spec = scene.spec.get();
  SetOptions(spec, scenario.environment);
  AddSurroundings(spec, scenario.environment);
  mjsBody* end_effector = AddCobot(spec, scenario, cobot);
  scene.object_model = LoadObject(scenario.object, scenario.folder());
  const bool carried = holding == Holding::kJoint;
  mjsBody* object = AddObject(spec, carried ? end_effector : nullptr, scenario, scene.object_model);
  if (wrist_sensor && carried) AddWristSensor(spec, object, scenario.object.attachment);
  for (int hand = 0; hand < kHands; ++hand) {
    if (scenario.Has(hand)) AddHandle(object, scenario, hand);
  }
  const MovableModels movables = LoadMovables(scenario);
  AddMovables(spec, scenario.environment, movables);
  scene.excluded_pairs = AddAllContacts(spec, scenario, scene.object_model, movables);
  scene.model.reset(mj_compile(spec, nullptr));
  if (scene.model == nullptr) {
    const std::string why = FirstLine(spec);
    for (const ModelShape& shape : scene.object_model.collisions) CheckMesh(shape, "object.model");
    CheckMeshes(movables);
    throw InputError("The physics engine cannot load the scene: " + why +
                     ". Check masses, inertias and shapes of the cobot and the objects.");
  }
  FindAddresses(&scene, scenario, cobot);
  FindMovables(scenario.environment.objects.size(), &scene);
  FindCobotPairs(scenario, cobot, &scene);
  SetStiffness(scenario.environment, scene.fixture_of, spec, scene.model.get());
  if (carried) CheckHandles(scene, scenario);
  return scene;
}

std::string SceneText(const Scene& scene) {
  std::string text(1 << 12, '\0');
  char error[512] = "";
  const auto save = [&] {
    return mj_saveXMLString(scene.spec.get(), text.data(), static_cast<int>(text.size()), error,
                            sizeof(error));
  };
  int result = save();
  if (result > 0) {  // the required size
    text.resize(static_cast<std::size_t>(result) + 1);
    result = save();
  }
  if (result != 0) throw InputError(std::string("The scene could not be written: ") + error + ".");
  text.resize(text.find('\0'));
  return text;
}

bool SetHandMass(const Scene& scene, int hand, double mass) noexcept {
  const int body = scene.hand[static_cast<std::size_t>(hand)];
  if (body < 0) return false;
  mjModel& model = *scene.model;
  const double change = mass - model.body_mass[body];
  if (change == 0) return false;
  model.body_mass[body] = mass;
  const double inertia = 0.4 * mass * kHandRadius * kHandRadius;
  std::fill_n(model.body_inertia + 3 * body, 3, inertia);
  for (int b = body; b > 0; b = model.body_parentid[b]) model.body_subtreemass[b] += change;
  return true;
}

void RemoveFixtures(const Scene& scene, std::uint64_t which) noexcept {
  mjModel& model = *scene.model;
  for (int g = 0; g < model.ngeom; ++g) {
    const int i = scene.fixture_of[static_cast<std::size_t>(g)];
    if (i < 0) continue;
    const bool removed = (which >> i & 1U) != 0;
    Vector3 place = scene.fixture_place[static_cast<std::size_t>(i)];
    // The fixture moves along its own z axis, so that a plane also ends up far below all bodies.
    if (removed) {
      const double* q = model.geom_quat + 4 * g;
      place -= kFarAway * (Quaternion(q[0], q[1], q[2], q[3]) * Vector3::UnitZ());
    }
    SetVector(model.geom_pos + 3 * g, place);
  }
}

DofFriction FrictionOf(const Scene& scene, int joint) noexcept {
  const int dof = scene.dof[static_cast<std::size_t>(joint)];
  return {scene.model->dof_frictionloss[dof], scene.model->dof_solimp[mjNIMP * dof]};
}

void SetFriction(const Scene& scene, int joint, const DofFriction& friction) noexcept {
  const int dof = scene.dof[static_cast<std::size_t>(joint)];
  scene.model->dof_frictionloss[dof] = friction.torque;
  std::fill_n(scene.model->dof_solimp + mjNIMP * dof, 2, friction.impedance);
}

}  // namespace predictor
