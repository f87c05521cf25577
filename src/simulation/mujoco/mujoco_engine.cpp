#include "simulation/mujoco/mujoco_engine.h"

#include <algorithm>

#include "core/error.h"
#include "simulation/mujoco/cobot_contacts.h"
#include "simulation/mujoco/full_vectors.h"
#include "simulation/mujoco/movables.h"
#include "simulation/mujoco/scene.h"

namespace predictor {
namespace {

constexpr unsigned kState = mjSTATE_INTEGRATION;

Eigen::Map<const Vector3> At(const mjtNum* xyz) { return Eigen::Map<const Vector3>(xyz); }

void ForcesWithoutLoad(const mjModel* model, mjData* data) {
  mj_forwardSkip(model, data, mjSTAGE_VEL, 1);
}
void ForcesAndLoad(const mjModel* model, mjData* data) {
  mj_forwardSkip(model, data, mjSTAGE_VEL, 0);
}

class MujocoEngine final : public Engine {
 public:
  explicit MujocoEngine(std::shared_ptr<const Scene> scene)
      : scene_(std::move(scene)),
        model_(scene_->model.get()),
        data_(mj_makeData(model_)),
        full_(*scene_) {
    layout_ = {.positions = scene_->own_positions,
               .dof = scene_->own_dof,
               .q = scene_->qpos,
               .v = scene_->dof,
               .object_q = scene_->object_qpos,
               .object_v = scene_->object_dof,
               .step = model_->opt.timestep};
    mj_resetData(model_, data());
  }

  std::unique_ptr<Engine> Copy() const override {
    auto copy = std::make_unique<MujocoEngine>(scene_);
    mj_copyData(copy->data(), model_, data());
    return copy;
  }
  const ObjectModel& object_model() const noexcept override { return scene_->object_model; }

  double time() const noexcept override { return data_->time; }
  void SetTime(double time) noexcept override { data_->time = time; }
  Values positions() noexcept override { return {data_->qpos, layout_.positions}; }
  Values velocities() noexcept override { return {data_->qvel, dof()}; }
  Values joint_forces() noexcept override { return {data_->qfrc_applied, dof()}; }
  ConstValues accelerations() const noexcept override { return {data_->qacc, dof()}; }
  void SetObjectWrench(const Wrench& wrench) noexcept override {
    Eigen::Map<Vector6>(data_->xfrc_applied + 6 * scene_->object) = wrench;
  }
  void ForgetSolution() noexcept override { std::fill_n(data_->qacc_warmstart, model_->nv, 0.0); }

  std::size_t state_size() const noexcept override {
    return static_cast<std::size_t>(mj_stateSize(model_, kState));
  }
  void Save(std::span<double> to) const noexcept override {
    mj_getState(model_, data(), to.data(), kState);
  }
  void Restore(std::span<const double> from) noexcept override {
    mj_resetData(model_, data());  // clears warnings, and the stack after an error
    mj_setState(model_, data(), from.data(), kState);
  }
  void MoveObject(const FrameMotion& O) noexcept override {
    const Quaternion& q = O.X_W.q;
    double* X = data_->qpos + scene_->object_qpos;
    Eigen::Map<Vector3>{X} = O.X_W.p;
    X[3] = q.w(), X[4] = q.x(), X[5] = q.y(), X[6] = q.z();
    // The engine's free joint has the linear velocity of O in axes of W and the angular velocity in
    // axes of O.
    double* V = data_->qvel + scene_->object_dof;
    Eigen::Map<Vector3>{V} = O.V_W.head<3>();
    Eigen::Map<Vector3>{V + 3} = q.conjugate() * Vector3(O.V_W.tail<3>());
  }
  Values movable_positions() noexcept override {
    return {data_->qpos + layout_.positions, model_->nq - layout_.positions};
  }
  Values movable_velocities() noexcept override {
    return {data_->qvel + dof(), model_->nv - dof()};
  }
  Values movable_forces() noexcept override {
    return {data_->qfrc_applied + dof(), model_->nv - dof()};
  }
  Values all_velocities() noexcept override { return {data_->qvel, model_->nv}; }
  Vector3 movable_com(int i) const noexcept override {
    return At(data_->xipos + 3 * scene_->movables[static_cast<std::size_t>(i)].body);
  }
  double GapTo(int movable, double most) noexcept override {
    return GapBetween(*scene_, data(), movable, most);
  }
  void SetHeldMovable(int i) noexcept override { LetPass(*scene_, i); }
  Movables movables() const noexcept override { return MotionOfMovables(*scene_, *data_); }
  double MovablePotential() const noexcept override {
    double energy = 0;
    for (const MovableBody& movable : scene_->movables)
      energy -= model_->body_mass[movable.body] *
                At(model_->opt.gravity).dot(At(data_->xipos + 3 * movable.body));
    return energy;
  }
  void Clear() noexcept override { mj_resetData(model_, data()); }

  bool Prepare() noexcept override { return Guarded(mj_step1, model_, data()) && IsComplete(); }
  bool Advance() noexcept override {
    if (!Guarded(mj_step2, model_, data()) || !IsComplete()) return false;
    EndFalls(*scene_, data());
    return true;
  }
  bool ComputeAccelerations(bool load) noexcept override {
    return Guarded(load ? ForcesAndLoad : ForcesWithoutLoad, model_, data()) && IsComplete();
  }

  Pose PoseOf(SceneBody body) const noexcept override {
    const double* q = data_->xquat + 4 * Index(body);
    return {At(data_->xpos + 3 * Index(body)), Quaternion(q[0], q[1], q[2], q[3])};
  }
  FrameMotion MotionOf(SceneBody body) const noexcept override {
    FrameMotion motion;
    motion.X_W = PoseOf(body);
    double velocity[6];  // angular, then linear
    mj_objectVelocity(model_, data(), mjOBJ_XBODY, Index(body), velocity, 0);
    motion.V_W << At(velocity + 3), At(velocity);
    return motion;
  }
  Vector3 object_com() const noexcept override { return At(data_->xipos + 3 * scene_->object); }
  double KineticEnergy() noexcept override {
    mj_energyVel(model_, data());
    return data_->energy[1];
  }

  void Jacobian(SceneBody body, const Vector3& p_W, Jacobian6 J) noexcept override {
    full_.Jacobian(mj_jac, model_, data(), p_W, Index(body), J);
  }
  void JacobianRate(SceneBody body, const Vector3& p_W, Jacobian6 J) noexcept override {
    full_.Jacobian(mj_jacDot, model_, data(), p_W, Index(body), J);
  }
  void MassMatrix(Eigen::Ref<Eigen::MatrixXd> M) const noexcept override {
    full_.MassMatrix(model_, data(), M);
  }
  void TimesMass(const double* a, double* force) const noexcept override {
    full_.TimesMass(model_, data(), a, force);
  }
  void StepMatrix(Eigen::Ref<Eigen::MatrixXd> M) const noexcept override {
    MassMatrix(M);
    // The engine integrates the joints' damping implicitly.
    for (int i = 0; i < M.cols(); ++i) M(i, i) += model_->opt.timestep * model_->dof_damping[i];
  }
  void Forces(Eigen::Ref<Eigen::VectorXd> forces) noexcept override {
    const auto map = [&](const double* x) { return ConstValues(x, forces.size()); };
    forces = map(data_->qfrc_passive) - map(data_->qfrc_bias) + map(data_->qfrc_applied);
    if (data_->nefc > 0) forces += map(data_->qfrc_constraint);
    const double* wrench = data_->xfrc_applied + 6 * scene_->object;
    full_.AddWrench(model_, data(), wrench, data_->xipos + 3 * scene_->object, scene_->object,
                    forces);
  }
  bool has_reactions() const noexcept override { return data_->nefc > 0; }
  void AddReactions(Eigen::Ref<Eigen::MatrixXd> M) const noexcept override {
    full_.AddReactions(model_, data(), M);
  }
  void Displace(const double* change, double scale) noexcept override {
    full_.Displace(model_, data(), change, scale);
  }

  Wrench LoadWrench(Vector3* p_WA) const noexcept override {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data_->site_xmat +
                                                                           9 * scene_->wrist_site);
    *p_WA = At(data_->site_xpos + 3 * scene_->wrist_site);
    Wrench F_W;
    // The engine's sensor gives the wrench of the end-effector on the load.
    F_W << -(R * At(data_->sensordata)), -(R * At(data_->sensordata + 3));
    return F_W;
  }

  int contact_count() const noexcept override { return data_->ncon; }
  Contact contact(int i) const noexcept override;
  std::vector<ContactPair> contact_pairs() const override {
    const DataPtr copy(mj_copyData(nullptr, model_, data()));
    mj_kinematics(model_, copy.get());
    return ContactPairsAt(*scene_, copy.get());
  }

  DofFriction JointFriction(int j) const noexcept override { return FrictionOf(*scene_, j); }
  void SetJointFriction(int j, const DofFriction& friction) noexcept override {
    SetFriction(*scene_, j, friction);
  }
  void RemoveFixtures(std::uint64_t which) noexcept override {
    predictor::RemoveFixtures(*scene_, which);
  }
  double HandMass(int hand) const noexcept override {
    const int body = scene_->hand[static_cast<std::size_t>(hand)];
    return body < 0 ? 0 : model_->body_mass[body];
  }
  bool SetHandMass(int hand, double mass) noexcept override {
    return predictor::SetHandMass(*scene_, hand, mass);
  }
  void ArchiveMasses(StateArchive& a) noexcept override {
    for (int body = 0; body < model_->nbody; ++body) a(model_->body_subtreemass[body]);
  }

  Options options() const noexcept override {
    return {(model_->opt.disableflags & mjDSBL_FRICTIONLOSS) == 0, model_->opt.tolerance,
            MovablesTouch(*scene_), CobotTouches(*scene_),
            (model_->opt.disableflags & mjDSBL_CONTACT) == 0};
  }
  void SetOptions(const Options& options) noexcept override {
    const auto enable = [this](bool on, int flag) {
      model_->opt.disableflags =
          on ? model_->opt.disableflags & ~flag : model_->opt.disableflags | flag;
    };
    enable(options.coulomb_friction, mjDSBL_FRICTIONLOSS);
    enable(options.contacts, mjDSBL_CONTACT);
    model_->opt.tolerance = options.tolerance;
    SetMovablesTouch(*scene_, options.movables_touch);
    SetCobotTouches(*scene_, options.cobot_touches);
  }
  std::string SceneText() const override { return predictor::SceneText(*scene_); }

 private:
  mjData* data() const noexcept { return data_.get(); }
  int Index(SceneBody body) const noexcept {
    const int movable = NumberOfMovable(body);
    if (movable >= 0) return scene_->movables[static_cast<std::size_t>(movable)].body;
    return body == SceneBody::kObject ? scene_->object : scene_->end_effector;
  }
  // If a contact or constraint does not fit into the engine's memory, the engine omits it with a
  // warning.
  bool IsComplete() const noexcept {
    return data_->warning[mjWARN_CONTACTFULL].number == 0 &&
           data_->warning[mjWARN_CNSTRFULL].number == 0;
  }

  // If two bodies touch, a Contact describes the body with the higher rank.
  int Rank(int geom) const noexcept {
    const int body = model_->geom_bodyid[geom];
    if (body == 0) return 0;
    if (scene_->movable_of[static_cast<std::size_t>(body)] >= 0) return 1;
    return IsLink(body) ? 2 : 3;
  }
  // Returns whether a body that takes part in a contact is a link of the cobot.
  bool IsLink(int body) const noexcept {
    return body > 0 && body != scene_->object &&
           scene_->movable_of[static_cast<std::size_t>(body)] < 0;
  }
  std::string_view LinkName(int body) const noexcept {
    return mj_id2name(model_, mjOBJ_BODY, body) + std::string_view(kCobotPrefix).size();
  }

  std::shared_ptr<const Scene> scene_;
  mjModel* model_;
  DataPtr data_;
  FullVectors full_;
};

Contact MujocoEngine::contact(int i) const noexcept {
  const mjContact& from = data_->contact[i];
  // The engine's normal points from the first shape to the second.
  const int moving = Rank(from.geom[1]) >= Rank(from.geom[0]) ? 1 : 0;
  const int body = model_->geom_bodyid[from.geom[moving]];
  const int other = model_->geom_bodyid[from.geom[1 - moving]];
  const double sign = moving == 1 ? 1 : -1;
  Contact contact;
  contact.p_W = At(from.pos);
  contact.normal_W = sign * At(from.frame);
  contact.depth = -from.dist;
  double force[6];  // in axes of the contact's frame
  mj_contactForce(model_, data(), i, force);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R_CW(from.frame);
  contact.force_W = sign * (R_CW.transpose() * At(force));
  contact.fixture = scene_->fixture_of[static_cast<std::size_t>(from.geom[1 - moving])];
  contact.yields =
      contact.fixture >= 0 && scene_->fixture_yields[static_cast<std::size_t>(contact.fixture)];
  contact.keep_out =
      contact.fixture >= 0 && scene_->fixture_keeps_out[static_cast<std::size_t>(contact.fixture)];
  contact.floor = from.geom[1 - moving] == scene_->floor;
  contact.movable = scene_->movable_of[static_cast<std::size_t>(other)];
  contact.body = scene_->movable_of[static_cast<std::size_t>(body)];
  if (IsLink(body)) contact.link = LinkName(body);
  if (IsLink(other)) contact.other_link = LinkName(other);
  return contact;
}

}  // namespace

std::unique_ptr<Engine> MakeMujocoEngine(const Scenario& scenario, const RobotModel& cobot,
                                         bool wrist_sensor, Holding holding) {
  const auto refuse = [](const std::string& key, const std::string& why) {
    throw InputError::At(key, key + " is hard, but simulation.engine is mujoco, " + why +
                                  ", or set simulation.engine: dart.");
  };
  if (scenario.simulation.joint_limits == JointLimits::kHard)
    refuse("simulation.joint_limits", "whose limits are soft. Set it to soft or none");
  if (scenario.simulation.velocity_limits == VelocityLimits::kHard)
    refuse("simulation.velocity_limits", "which has no limits of velocities. Set it to off");
  return std::make_unique<MujocoEngine>(
      std::make_shared<const Scene>(ComposeScene(scenario, cobot, wrist_sensor, holding)));
}

}  // namespace predictor
