#include "simulation/equilibrium.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/text.h"

namespace predictor {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTolerance = 1e-8;  // tolerance of accelerations [rad/s², m/s²]
// Contacts must be solved more accurately than the equilibrium itself.
constexpr double kContactTolerance = 1e-14;
constexpr int kIterations = 1000;
constexpr double kMaxStep = 0.1;      // maximum change of a coordinate in an iteration [rad, m]
constexpr double kPseudoTime = 0.01;  // first step of the flow, squared [s²]
constexpr double kDifference = 1e-6;  // step of finite differences [rad, m]
// The step while a body rests on a fixture. The step is smaller than the 0.5 µm by which the body
// sinks in.
constexpr double kContactDifference = 1e-8;
// The largest depth to which a body may enter a fixture in an iteration [m]. At a greater depth,
// the contact's force is so large that the search would jump in and out of the fixture.
constexpr double kMaxDepth = 1e-5;
// In each iteration, a body may enter a fixture with a stiffness at most this many times deeper
// than in the last iteration.
constexpr double kDeeper = 2;
constexpr int kHalvings = 30;            // of an iteration that enters a fixture deeper
constexpr double kDeepestStart = 0.001;  // in a fixture, the table or the floor [m]
constexpr double kUnstable = -0.01;  // eigenvalue of M⁻¹ H below which the scene is unstable [1/s²]
constexpr double kNudge = 0.01;      // away from an unstable equilibrium [rad, m]

// Searches by the implicit flow M dq = τ r(q ⊕ dq), where r is the generalised force at rest. While
// the pseudo-time τ is small, the flow is a heavily damped motion. When τ is large, the flow is
// Newton's method.
class EquilibriumSearch {
 public:
  explicit EquilibriumSearch(ControlledScene* scene)
      : scene_(*scene), engine_(scene->engine()), options_(engine_.options()) {
    // The movable objects stay in the places where they start, and do not support the object. The
    // cobot supports neither the object nor itself with its links.
    engine_.SetOptions({.coulomb_friction = false,
                        .tolerance = kContactTolerance,
                        .movables_touch = false,
                        .cobot_touches = false});
  }
  ~EquilibriumSearch() { engine_.SetOptions(options_); }

  // Returns the largest remaining acceleration. The search succeeded if this acceleration is below
  // kTolerance.
  double Run() {
    VectorXd r = Force();
    double tau = kPseudoTime;
    double before = Residual();
    for (int i = 0; i < kIterations; ++i) {
      const MatrixXd H = Stiffness();
      const MatrixXd M = Inertia();
      const Modes modes = ModesOf(Solve(M, H));
      Eigen::Index worst = 0;
      const double softest = modes.eigenvalues.real().minCoeff(&worst);
      if (before < kTolerance && softest > kUnstable) return before;
      if (before < kTolerance) {
        // The equilibrium is unstable (for example, an object is balanced above its joint), so the
        // object is pushed away from the equilibrium.
        const VectorXd away = modes.eigenvectors.col(worst).real();
        Move(kNudge * away / away.lpNorm<Eigen::Infinity>());
        tau = kPseudoTime;
      } else {
        // Limits the pseudo-time so that the flow still leaves unstable equilibria.
        if (softest < 0) tau = std::min(tau, -0.5 / softest);
        Move(Solve(M / tau + H, r));
      }
      r = Force();
      const double now = Residual();
      if (!std::isfinite(now)) return now;
      tau *= std::clamp(2 * before / now, 0.3, 10.0);
      before = now;
    }
    return before;
  }

 private:
  int nv() const { return engine_.dof(); }

  // Returns the generalised force M·qacc at rest in the present posture [N·m, N].
  VectorXd Force() {
    engine_.velocities().setZero();
    engine_.ForgetSolution();
    if (!scene_.Update(&engine_) || !scene_.ApplyController(0, &engine_)) {
      return VectorXd::Constant(nv(), std::nan(""));
    }
    engine_.ComputeAccelerations(false);
    VectorXd r(nv());
    engine_.TimesMass(engine_.accelerations().data(), r.data());
    return r;
  }

  double Residual() const { return engine_.accelerations().lpNorm<Eigen::Infinity>(); }

  MatrixXd Inertia() const {
    MatrixXd M(nv(), nv());
    engine_.MassMatrix(M);
    return M;
  }

  // Moves by dq in the tangent space, limited in each coordinate and at fixtures.
  void Move(VectorXd dq) {
    const double largest = dq.lpNorm<Eigen::Infinity>();
    if (largest > kMaxStep) dq *= kMaxStep / largest;
    const VectorXd start = engine_.positions();
    const double hard = std::max(kMaxDepth, Depth(false));
    const double yielding = std::max(kMaxDepth, kDeeper * Depth(true));
    engine_.Displace(dq.data(), 1);
    for (int i = 0; i < kHalvings && (Depth(false) > hard || Depth(true) > yielding); ++i) {
      dq /= 2;
      engine_.positions() = start;
      engine_.Displace(dq.data(), 1);
    }
  }

  // Returns the depth to which the object or the cobot has entered a fixture [m]. `yields` selects
  // the fixtures with a stiffness or those without one. The depth is 0 if the search does not
  // include contacts.
  double Depth(bool yields) {
    if (!engine_.has_contacts_at_rest()) return 0;
    engine_.Prepare();
    double depth = 0;
    for (int i = 0; i < engine_.contact_count(); ++i) {
      const Contact contact = engine_.contact(i);
      if (contact.fixture >= 0 && contact.yields == yields) depth = std::max(depth, contact.depth);
    }
    return depth;
  }

  bool TouchesFixture() const {
    if (!engine_.has_contacts_at_rest()) return false;
    for (int i = 0; i < engine_.contact_count(); ++i)
      if (engine_.contact(i).fixture >= 0) return true;
    return false;
  }

  // Computes H = −∂r/∂q by central differences.
  MatrixXd Stiffness() {
    Engine::Values q = engine_.positions();
    const VectorXd start = q;
    MatrixXd H(nv(), nv());
    const double difference = TouchesFixture() ? kContactDifference : kDifference;
    for (int i = 0; i < nv(); ++i) {
      const VectorXd step = difference * VectorXd::Unit(nv(), i);
      engine_.Displace(step.data(), 1);
      const VectorXd ahead = Force();
      q = start;
      engine_.Displace(step.data(), -1);
      H.col(i) = (Force() - ahead) / (2 * difference);
      q = start;
    }
    Force();
    return H;
  }

  ControlledScene& scene_;
  Engine& engine_;
  Engine::Options options_;
};

// The reason why the cobot cannot hold the object in the posture in which the search ended, and the
// scenario's key for the cause. The text is "" if nothing prevents the cobot from holding the
// object.
struct Obstacle {
  std::string key, text;
  std::string remedy = "Increase the stiffness of cobot.controller, choose";
};

Obstacle ObstacleIn(const ControlledScene& scene) {
  const RobotModel& robot = scene.robot();
  if (scene.outcome() == ControllerOutcome::kFailed)
    return {"cobot.controller", "its program does not answer, or its torques are not finite"};
  for (int j = 0; j < robot.dof(); ++j) {
    const double limit = scene.effort_limit()[j];
    if (std::fabs(scene.torque()[j]) < limit) continue;
    return {"cobot.effort_limit",
            "joint " + Quote(robot.joint_name(j)) + " would need more than its effort limit of " +
                FormatNumber(limit) + " " + robot.effort_unit(j) +
                (limit == robot.effort_limit()[j] ? " (from the cobot's model)"
                                                  : " (set by this key; [] means the model's)"),
            "Raise cobot.effort_limit, choose"};
  }
  for (int j = 0; j < robot.dof(); ++j) {
    const double q = scene.q()[j];
    if (q >= robot.position_lower()[j] && q <= robot.position_upper()[j]) continue;
    return {"cobot.controller",
            "it sags until joint " + Quote(robot.joint_name(j)) + " reaches its position limit"};
  }
  return {};
}

std::string KeyOfMovable(int i) { return "environment.objects." + std::to_string(i); }

std::string Millimetres(double metres) {
  return FormatNumber(std::round(metres * 1e4) / 10) + " mm";
}

// Returns whether a body that has entered the floor or the table has entered the table. A body
// touches the floor below the plane z = 0.
bool IsInTable(const Contact& contact, const EnvironmentSpec& environment) {
  return environment.table && (!environment.floor || contact.p_W.z() > 0);
}

// Throws InputError for a movable object that overlaps its surroundings or another movable object.
void RefuseOverlap(const Contact& contact, const EnvironmentSpec& environment) {
  const std::string key = KeyOfMovable(contact.body);
  const std::string other = contact.movable >= 0 ? KeyOfMovable(contact.movable)
                            : contact.fixture >= 0
                                ? "environment.fixtures." + std::to_string(contact.fixture)
                            : IsInTable(contact, environment) ? "environment.table"
                                                              : "the floor";
  throw InputError::At(key + ".xyz", key + ".xyz: at the start, this object is " +
                                         Millimetres(contact.depth) + " inside " + other +
                                         ". Move it away by at least this distance.");
}

// Throws InputError for a contact of a link with the object or with another link.
[[noreturn]] void RefuseTouchOfLink(const Contact& contact) {
  const bool is_object = contact.link.empty();
  std::string text = "cobot.touches: at the start, after the cobot sagged under its load, ";
  text += is_object ? "the object" : "the cobot's link " + Quote(contact.link);
  text += " is " + Millimetres(contact.depth) + " inside the cobot's link ";
  text += Quote(contact.other_link) + ". Choose another cobot.posture";
  text += is_object ? ", place the object further away with object.attachment.on_end_effector" : "";
  text += std::string(", or remove ") + (is_object ? "object" : "cobot") + " from this list.";
  throw InputError::At("cobot.touches", text);
}

// The search includes neither the movable objects nor the contacts of cobot.touches. If one of them
// touched the object or the cobot, the run would not begin at rest.
void RefuseTouch(Engine* engine) {
  if (engine->movables().count == 0 && engine->contact_pairs().empty()) return;
  engine->Prepare();
  for (int i = 0; i < engine->contact_count(); ++i) {
    const Contact contact = engine->contact(i);
    if (!contact.other_link.empty()) RefuseTouchOfLink(contact);
    if (contact.movable < 0 || contact.body >= 0) continue;
    const std::string key = KeyOfMovable(contact.movable);
    const std::string other =
        contact.link.empty() ? "the carried object" : "the cobot's link " + Quote(contact.link);
    std::string text = key;
    text +=
        ".xyz: at the start, after the cobot sagged under its load, this movable object touches ";
    text += other;
    text += " (overlap " + Millimetres(contact.depth) +
            "). Leave a gap between them, for example 1 mm.";
    throw InputError::At(key + ".xyz", text);
  }
}

// Throws InputError for a fixture that the object or a link of the cobot has entered.
void RefuseFixture(const Contact& contact) {
  const std::string key = "environment.fixtures." + std::to_string(contact.fixture);
  const bool is_object = contact.link.empty();
  const std::string what = contact.keep_out ? "keep-out volume" : "fixture";
  throw InputError::At(
      key,
      key + ": at cobot.posture, " +
          (is_object ? "the object" : "the cobot's link " + Quote(contact.link)) + " is " +
          Millimetres(contact.depth) + " inside this " + what + ". Move the " + what +
          ", or change cobot.posture" +
          (is_object || contact.keep_out ? "." : ", or remove cobot from the fixture's touches."));
}

// Without this check, the search would push the bodies apart, and the run would not start as the
// scenario describes.
void CheckStart(Engine* engine, const EnvironmentSpec& environment) {
  engine->Prepare();
  for (int i = 0; i < engine->contact_count(); ++i) {
    const Contact contact = engine->contact(i);
    if (contact.depth <= kDeepestStart) continue;
    if (contact.body >= 0) RefuseOverlap(contact, environment);
    if (contact.movable >= 0 || !contact.other_link.empty()) continue;  // RefuseTouch
    if (contact.fixture >= 0) RefuseFixture(contact);
    const bool table = IsInTable(contact, environment);
    const std::string key = table ? "environment.table" : "environment.floor";
    throw InputError::At(key, key + ": at cobot.posture, the object is " +
                                  Millimetres(contact.depth) + " inside the " +
                                  (table ? "table. Lower the table" : "floor. Raise cobot.base") +
                                  ", or change cobot.posture.");
  }
}

// The search does not include contacts that the engine computes only in a step.
void RefuseContact(Engine* engine) {
  if (engine->has_contacts_at_rest() || !engine->Prepare() || engine->contact_count() == 0) return;
  throw InputError::At("simulation.engine",
                       "simulation.engine is dart, but the object touches the floor, the table or "
                       "a fixture at the start. Lift the object by a change of cobot.posture, or "
                       "set simulation.engine: mujoco.");
}

}  // namespace

void FindEquilibrium(const EnvironmentSpec& environment, ControlledScene* scene) {
  Engine& engine = scene->engine();
  engine.Clear();
  Engine::Values q = engine.positions();
  for (int j = 0; j < scene->posture().size(); ++j)
    q[engine.layout().q[static_cast<std::size_t>(j)]] = scene->posture()[j];
  CheckStart(&engine, environment);
  const double residual = EquilibriumSearch(scene).Run();
  Obstacle obstacle = ObstacleIn(*scene);
  if (residual < kTolerance && obstacle.text.empty()) {
    RefuseTouch(&engine);
    return RefuseContact(&engine);
  }
  if (obstacle.text.empty()) obstacle = {"cobot.posture", "no static equilibrium was found"};
  throw InputError::At(
      obstacle.key,
      obstacle.key + ": the cobot cannot hold the object at cobot.posture: " + obstacle.text +
          ". " + obstacle.remedy + " another cobot.posture, use a lighter object, or " +
          (engine.has_contacts_at_rest()
               ? "add a table."
               : "set simulation.engine: mujoco if a table should support it."));
}

}  // namespace predictor
