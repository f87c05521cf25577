#include "simulation/link_gaps.h"

#include <vector>

#include "core/error.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "models/urdf.h"
#include "scenario/paths.h"
#include "simulation/mujoco/library.h"
#include "simulation/mujoco/shapes.h"

namespace predictor {
namespace {

constexpr double kShortBar = 0.001;  // shorter bars are omitted [m]

// A shape of a link or of the object, in the place that the engine gives it.
struct PlacedShape {
  int link = -1;  // index in UrdfModel::links; −1: the object
  Pose X_LG;
};

void SetGeomPose(const Pose& X_WG, int geom, mjData* data) {
  SetVector(data->geom_xpos + 3 * geom, X_WG.p);
  const Matrix3 R = X_WG.q.toRotationMatrix();
  for (int i = 0; i < 9; ++i) data->geom_xmat[9 * geom + i] = R(i / 3, i % 3);
}

}  // namespace

struct LinkGaps::Impl {
  explicit Impl(const Scenario& scenario)
      : urdf(ReadUrdf(ResolveModelPath(scenario.cobot.model, scenario.folder()),
                      scenario.cobot.remove_links, scenario.folder())),
        robot(RobotModel::Build(urdf, scenario.cobot.base.ToPose())),
        robot_data(*robot) {
    SilenceMujoco();
    spec.reset(mj_makeSpec());
    const int hand = robot->Frame(scenario.cobot.end_effector).body;
    for (const UrdfLink& link : urdf.links) {
      frames.push_back(robot->Frame(link.name));
      in_hand.push_back(frames.back().body == hand);
    }
    for (const UrdfJoint& joint : urdf.joints)  // parents come before children
      if (in_hand[static_cast<std::size_t>(joint.parent)])
        in_hand[static_cast<std::size_t>(joint.child)] = true;
    for (const ModelShape& shape : LoadObject(scenario.object, scenario.folder()).collisions)
      Add(shape, -1);
    for (std::size_t i = 0; i < urdf.links.size(); ++i) AddLink(static_cast<int>(i));
    model.reset(mj_compile(spec.get(), nullptr));
    if (!model) {  // nothing can be compared
      shapes.clear();
      return;
    }
    data.reset(mj_makeData(model.get()));
    for (PlacedShape& shape : shapes) {  // in the order of the geoms
      const auto g = static_cast<std::size_t>(&shape - shapes.data());
      const double* q = model->geom_quat + 4 * g;
      shape.X_LG = {Eigen::Map<const Vector3>(model->geom_pos + 3 * g),
                    Quaternion(q[0], q[1], q[2], q[3])};
    }
  }

  std::string NewName() const { return "shape" + std::to_string(shapes.size()); }
  mjsBody* world() const { return mjs_findBody(spec.get(), "world"); }

  void Add(const ModelShape& shape, int link) {
    mjsGeom* geom = nullptr;
    try {
      geom = AddShape(spec.get(), world(), shape, NewName(), "cobot.model");
    } catch (const InputError&) {  // thrown after the geom was added
      mjsElement* added = mjs_findElement(spec.get(), mjOBJ_GEOM, NewName().c_str());
      if (added != nullptr) mjs_delete(spec.get(), added);
      throw;
    }
    geom->contype = geom->conaffinity = 0;
    shapes.push_back({link, {}});
  }

  void AddLink(int i) {
    const UrdfLink& link = urdf.links[static_cast<std::size_t>(i)];
    const std::vector<ModelShape>& of = link.collisions.empty() ? link.visuals : link.collisions;
    bool complete = !of.empty();
    for (const ModelShape& shape : of) try {
        Add(shape, i);
      } catch (const InputError&) {
        complete = false;
      }
    if (complete) return;
    for (const UrdfJoint& joint : urdf.joints)
      if (joint.parent == i && joint.X_PJ.p.norm() > kShortBar) AddBar(joint.X_PJ.p, i);
  }

  void AddBar(const Vector3& end, int link) {
    mjsGeom* geom = mjs_addGeom(world(), nullptr);
    mjs_setName(geom->element, NewName().c_str());
    geom->type = mjGEOM_CAPSULE;
    geom->size[0] = kBarRadius;
    geom->size[1] = end.norm() / 2;
    SetPose(geom->pos, geom->quat, {end / 2, Quaternion::FromTwoVectors(Vector3::UnitZ(), end)});
    geom->contype = geom->conaffinity = 0;
    shapes.push_back({link, {}});
  }

  ObjectGaps At(const JointVector& q, const Pose& X_WO) {
    robot_data.UpdateKinematics(*robot, q, JointVector::Zero(robot->dof()));
    for (std::size_t g = 0; g < shapes.size(); ++g) {
      const int link = shapes[g].link;
      const Pose X_WL =
          link < 0 ? X_WO : robot_data.FramePose(*robot, frames[static_cast<std::size_t>(link)]);
      SetGeomPose(X_WL * shapes[g].X_LG, static_cast<int>(g), data.get());
    }
    ObjectGaps gaps;
    for (std::size_t g = 0; g < shapes.size(); ++g) {
      if (shapes[g].link < 0) continue;
      const auto link = static_cast<std::size_t>(shapes[g].link);
      LinkGap& gap = in_hand[link] ? gaps.hand : gaps.links;
      const double distance = ToObject(static_cast<int>(g));
      if (distance < gap.distance) gap = {urdf.links[link].name, distance};
    }
    return gaps;
  }

  // Returns the distance of a link's shape from the object [m].
  double ToObject(int geom) const {
    double least = kFarthestLink;
    for (std::size_t o = 0; o < shapes.size() && shapes[o].link < 0; ++o)
      least = std::min(least, mj_geomDistance(model.get(), data.get(), geom, static_cast<int>(o),
                                              least, nullptr));
    return least;
  }

  UrdfModel urdf;
  std::shared_ptr<const RobotModel> robot;
  RobotData robot_data;
  std::vector<FrameId> frames;  // of the links
  std::vector<bool> in_hand;    // of the links
  SpecPtr spec;
  ModelPtr model;
  DataPtr data;
  std::vector<PlacedShape> shapes;  // those of the object first
};

LinkGaps::LinkGaps(const Scenario& scenario) : impl_(std::make_unique<Impl>(scenario)) {}
LinkGaps::~LinkGaps() = default;
LinkGaps::LinkGaps(LinkGaps&&) noexcept = default;
LinkGaps& LinkGaps::operator=(LinkGaps&&) noexcept = default;

ObjectGaps LinkGaps::At(const JointVector& q, const Pose& X_WO) const { return impl_->At(q, X_WO); }

}  // namespace predictor
