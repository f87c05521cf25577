#include "simulation/dart/dart_engine.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "core/error.h"
#include "simulation/dart/dart_process.h"
#include "simulation/dart/dart_scene.h"
#include "simulation/mujoco/scene.h"

namespace predictor {
namespace {

using dart_engine::BodyMotion;
using dart_engine::Request;
using RowMatrix = Eigen::Matrix<double, 6, dart_engine::kMaxDof, Eigen::RowMajor>;

Eigen::Map<const Vector3> VectorAt(const double* xyz) { return Eigen::Map<const Vector3>(xyz); }

// The data that all states of a scene share.
struct SharedScene {
  SharedScene(ObjectModel model, const dart_engine::SceneData& data, std::string scene_text)
      : object(std::move(model)), process(data), text(std::move(scene_text)) {}
  ObjectModel object;
  DartProcess process;
  std::string text;
  bool has_ball = false, has_hands = false;  // has_ball: a ball's coordinates are the last ones
  std::uint64_t removed = 0;                 // fixtures
  std::array<DofFriction, kMaxCobotJoints> friction = {};
  std::array<double, kHands> hand_mass = {};
  Engine::Options options;
};

class DartEngine final : public Engine {
 public:
  DartEngine(std::shared_ptr<SharedScene> scene, const Layout& layout) : scene_(std::move(scene)) {
    layout_ = layout;
    Clear();
  }

  std::unique_ptr<Engine> Copy() const override {
    auto copy = std::make_unique<DartEngine>(scene_, layout_);
    copy->time_ = time_;
    copy->state_ = state_;
    copy->forces_ = forces_;
    copy->motion_ = motion_;
    copy->acceleration_ = acceleration_;
    return copy;
  }
  const ObjectModel& object_model() const noexcept override { return scene_->object; }

  double time() const noexcept override { return time_; }
  void SetTime(double time) noexcept override { time_ = time; }
  Values positions() noexcept override { return {state_.q, layout_.positions}; }
  Values velocities() noexcept override { return {state_.v, layout_.dof}; }
  Values joint_forces() noexcept override { return {forces_.joint, layout_.dof}; }
  ConstValues accelerations() const noexcept override { return {acceleration_.a, layout_.dof}; }
  void SetObjectWrench(const Wrench& wrench) noexcept override {
    Eigen::Map<Vector6>(forces_.object) = wrench;
  }
  void ForgetSolution() noexcept override {}

  std::size_t state_size() const noexcept override {
    return static_cast<std::size_t>(1 + layout_.positions + 2 * layout_.dof + 6);
  }
  void Save(std::span<double> to) const noexcept override {
    double* next = to.data();
    *next++ = time_;
    next = std::copy_n(state_.q, layout_.positions, next);
    next = std::copy_n(state_.v, layout_.dof, next);
    next = std::copy_n(forces_.joint, layout_.dof, next);
    std::copy_n(forces_.object, 6, next);
  }
  void Restore(std::span<const double> from) noexcept override {
    scene_->process.Revive();
    const double* next = from.data();
    const auto read = [&next](double* to, int count) {
      std::copy_n(next, count, to);
      next += count;
    };
    read(&time_, 1);
    read(state_.q, layout_.positions);
    read(state_.v, layout_.dof);
    read(forces_.joint, layout_.dof);
    read(forces_.object, 6);
  }
  void MoveObject(const FrameMotion& O) noexcept override {
    double* q = state_.q + layout_.object_q;
    Eigen::Map<Vector3>{q} = O.X_W.p;
    WriteBall(O.X_W.q, q + 3);
    double* v = state_.v + layout_.object_v;
    Eigen::Map<Vector3>{v} = O.V_W.head<3>();
    Eigen::Map<Vector3>{v + 3} = O.X_W.q.conjugate() * Vector3(O.V_W.tail<3>());
  }
  void Clear() noexcept override {
    scene_->process.Revive();
    time_ = 0;
    state_ = {};
    forces_ = {};
    acceleration_ = {};
    if (scene_->has_ball) state_.q[layout_.positions - 4] = 1;
  }

  bool Prepare() noexcept override {
    if (IsPrepared()) return true;
    return Ask(Request::kPrepare);
  }
  bool Advance() noexcept override {
    if (!Ask(Request::kAdvance)) return false;
    state_ = scene_->process.memory().state;
    acceleration_ = scene_->process.memory().acceleration;
    time_ += layout_.step;
    return true;
  }
  bool ComputeAccelerations(bool) noexcept override {
    if (!Ask(Request::kAccelerations)) return false;
    acceleration_ = scene_->process.memory().acceleration;
    return true;
  }

  Pose PoseOf(SceneBody body) const noexcept override {
    const dart_engine::FramePose& X = MotionData(body).pose;
    return {VectorAt(X.p), Quaternion(X.q[0], X.q[1], X.q[2], X.q[3])};
  }
  FrameMotion MotionOf(SceneBody body) const noexcept override {
    FrameMotion motion;
    motion.X_W = PoseOf(body);
    motion.V_W = Eigen::Map<const Vector6>(MotionData(body).twist);
    return motion;
  }
  Vector3 object_com() const noexcept override { return VectorAt(motion_.com); }
  double KineticEnergy() noexcept override { return motion_.kinetic_energy; }

  void Jacobian(SceneBody body, const Vector3& p_W, Jacobian6 J) noexcept override {
    const BodyMotion& from = MotionData(body);
    J = Eigen::Map<const RowMatrix>(from.jacobian).leftCols(layout_.dof);
    const Vector3 r = p_W - VectorAt(from.pose.p);
    J.topRows<3>() -= Skew(r).lazyProduct(J.bottomRows<3>());
  }
  void JacobianRate(SceneBody body, const Vector3& p_W, Jacobian6 J) noexcept override {
    const BodyMotion& from = MotionData(body);
    J = Eigen::Map<const RowMatrix>(from.jacobian_rate).leftCols(layout_.dof);
    const Vector3 r = p_W - VectorAt(from.pose.p);
    const Vector3 rate = VectorAt(from.twist + 3).cross(r);
    const auto turn = Eigen::Map<const RowMatrix>(from.jacobian).leftCols(layout_.dof);
    J.topRows<3>() -= Skew(r).lazyProduct(J.bottomRows<3>());
    J.topRows<3>() -= Skew(rate).lazyProduct(turn.bottomRows<3>());
  }
  void MassMatrix(Eigen::Ref<Eigen::MatrixXd> M) const noexcept override {
    M = Mass().topLeftCorner(layout_.dof, layout_.dof);
  }
  void TimesMass(const double* a, double* force) const noexcept override {
    Values(force, layout_.dof) =
        Mass().topLeftCorner(layout_.dof, layout_.dof).lazyProduct(ConstValues(a, layout_.dof));
  }
  // These functions serve the attachment of a free object, which MakeEngine refuses.
  void StepMatrix(Eigen::Ref<Eigen::MatrixXd> M) const noexcept override { MassMatrix(M); }
  void Forces(Eigen::Ref<Eigen::VectorXd> forces) noexcept override { forces.setZero(); }
  bool has_reactions() const noexcept override { return false; }
  void AddReactions(Eigen::Ref<Eigen::MatrixXd>) const noexcept override {}
  void Displace(const double* change, double scale) noexcept override {
    const int single = layout_.dof - (scene_->has_ball ? 3 : 0);
    for (int i = 0; i < single; ++i) state_.q[i] += scale * change[i];
    if (!scene_->has_ball) return;
    double* q = state_.q + single;
    const Quaternion turned = Quaternion(q[0], q[1], q[2], q[3]) *
                              RotationFromVector(scale * Vector3(VectorAt(change + single)));
    WriteBall(turned, q);
  }

  Wrench LoadWrench(Vector3* p_WA) const noexcept override {
    *p_WA = VectorAt(acceleration_.load_at);
    return Eigen::Map<const Vector6>(acceleration_.load);
  }

  int contact_count() const noexcept override { return motion_.contacts; }
  Contact contact(int i) const noexcept override {
    const dart_engine::ContactData& from = motion_.contact[i];
    Contact contact;
    contact.p_W = VectorAt(from.p);
    contact.normal_W = VectorAt(from.normal);
    contact.force_W = VectorAt(from.force);
    contact.depth = from.depth;
    contact.fixture = from.fixture;
    return contact;
  }
  bool has_contacts_at_rest() const noexcept override { return false; }

  DofFriction JointFriction(int j) const noexcept override {
    return scene_->friction[static_cast<std::size_t>(j)];
  }
  void SetJointFriction(int j, const DofFriction& friction) noexcept override {
    scene_->friction[static_cast<std::size_t>(j)] = friction;
  }
  void RemoveFixtures(std::uint64_t which) noexcept override { scene_->removed = which; }
  double HandMass(int hand) const noexcept override {
    return scene_->hand_mass[static_cast<std::size_t>(hand)];
  }
  bool SetHandMass(int hand, double mass) noexcept override {
    double& present = scene_->hand_mass[static_cast<std::size_t>(hand)];
    if (!scene_->has_hands || present == mass) return false;
    present = mass;
    return true;
  }
  void ArchiveMasses(StateArchive&) noexcept override {}

  Options options() const noexcept override { return scene_->options; }
  void SetOptions(const Options& options) noexcept override { scene_->options = options; }
  std::string SceneText() const override { return scene_->text; }
  std::string Failure() const override { return scene_->process.Failure(); }

 private:
  static void WriteBall(const Quaternion& turned, double* q) noexcept {
    const Quaternion unit = turned.normalized();
    q[0] = unit.w(), q[1] = unit.x(), q[2] = unit.y(), q[3] = unit.z();
  }
  const BodyMotion& MotionData(SceneBody body) const noexcept {
    return motion_.body[body == SceneBody::kObject ? 1 : 0];
  }
  Eigen::Map<const Eigen::Matrix<double, dart_engine::kMaxDof, dart_engine::kMaxDof>> Mass()
      const noexcept {
    return Eigen::Map<const Eigen::Matrix<double, dart_engine::kMaxDof, dart_engine::kMaxDof>>(
        motion_.mass_matrix);
  }

  // Returns whether the present state is the state in the last answer.
  bool IsPrepared() noexcept {
    TakeShared();
    const auto same = [](const auto& a, const auto& b) {
      return std::equal(std::begin(a), std::end(a), std::begin(b));
    };
    const dart_engine::StateData& at = motion_.at;
    return is_prepared_ && same(state_.q, at.q) && same(state_.v, at.v) &&
           same(state_.hand_mass, at.hand_mass) && state_.removed == at.removed;
  }
  // Copies the data that all states of the scene share.
  void TakeShared() noexcept {
    std::copy_n(scene_->hand_mass.data(), kHands, state_.hand_mass);
    state_.removed = scene_->removed;
  }
  bool Ask(Request kind) noexcept {
    DartProcess& process = scene_->process;
    TakeShared();
    for (std::size_t j = 0; j < kMaxCobotJoints; ++j)
      forces_.coulomb[j] = scene_->options.coulomb_friction ? scene_->friction[j].torque : 0;
    process.memory().state = state_;
    process.memory().forces = forces_;
    is_prepared_ = process.Ask(kind);
    if (is_prepared_) motion_ = process.memory().motion;
    return is_prepared_;
  }

  std::shared_ptr<SharedScene> scene_;
  double time_ = 0;
  dart_engine::StateData state_ = {};
  dart_engine::ForceData forces_ = {};
  dart_engine::MotionData motion_ = {};
  dart_engine::AccelerationData acceleration_ = {};
  bool is_prepared_ = false;
};

}  // namespace

std::unique_ptr<Engine> MakeDartEngine(const Scenario& scenario, const RobotModel& cobot,
                                       Holding holding) {
  // Both engines refuse such scenarios with the same messages.
  Scenario same = scenario;
  same.simulation = {};
  const Scene checked = ComposeScene(same, cobot, false, holding);
  const double step = checked.model->opt.timestep;
  auto scene = std::make_shared<SharedScene>(
      checked.object_model, DartScene(scenario, cobot, checked.object_model, step, holding),
      SceneText(checked));
  const bool is_free = holding == Holding::kFree;
  const JointType joint = scenario.object.attachment.joint;
  scene->has_ball = is_free || joint == JointType::kSpherical;
  scene->has_hands = scenario.mode == Mode::kDirect;
  Engine::Layout layout;
  layout.step = step;
  const int own = is_free ? 6 : scene->has_ball ? 3 : joint == JointType::kFixed ? 0 : 1;
  layout.dof = cobot.dof() + own;
  layout.positions = layout.dof + (scene->has_ball ? 1 : 0);
  if (is_free) layout.object_q = layout.object_v = cobot.dof();
  for (int j = 0; j < cobot.dof(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    layout.q[i] = layout.v[i] = j;
    scene->friction[i] = {OneOrEach(scenario.cobot.joint_friction.coulomb, j), 1};
  }
  return std::make_unique<DartEngine>(std::move(scene), layout);
}

}  // namespace predictor
