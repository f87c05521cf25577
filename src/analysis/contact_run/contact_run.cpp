#include "analysis/contact_run/contact_run.h"

#include <algorithm>

#include "core/error.h"
#include "haptics/stability.h"
#include "models/arm_model.h"
#include "simulation/world.h"

namespace predictor {
namespace {

// Returns an engine in which the object is a free body among the fixtures. The object's motion
// comes from the records, so any engine finds the same contacts, and limits do not matter.
std::unique_ptr<Engine> FreeObject(Scenario scenario) {
  scenario.simulation.engine = EngineKind::kMujoco;
  scenario.simulation.joint_limits = JointLimits::kNone;
  scenario.simulation.velocity_limits = VelocityLimits::kOff;
  return MakeEngine(scenario, *LoadCobotModel(scenario), false, Holding::kFree);
}

std::uint64_t BitOf(std::size_t fixture) { return std::uint64_t{1} << fixture; }

Surface SurfaceOf(const Contact& contact) {
  if (contact.fixture >= 0)
    return {Surface::Kind::kFixture, static_cast<std::size_t>(contact.fixture)};
  if (contact.movable >= 0)
    return {Surface::Kind::kMovable, static_cast<std::size_t>(contact.movable)};
  return {contact.floor ? Surface::Kind::kFloor : Surface::Kind::kTable};
}

// Returns the force of all hands on their handles, in axes of W [N].
Vector3 ForceOfHands(const TickRecord& record) {
  Vector3 force = Vector3::Zero();
  for (const HandRecord& hand : record.hands)
    if (hand.present) force += Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]);
  return force;
}

}  // namespace

bool HasContact(const Scenario& s) { return !SurfacesOf(s, true).empty(); }

bool ContactRun::touched_floor() const {
  return std::ranges::any_of(facts, [](const ContactFacts& f) {
    return f.surface.kind == Surface::Kind::kFloor && f.time > 0;
  });
}

bool ContactRun::has_chapter() const {
  return touched_floor() || !SurfacesOf(scenario, false).empty() || !LinkContacts(scenario).empty();
}

ContactCollector::ContactCollector(const Scenario& scenario)
    : scenario_(scenario),
      events_(scenario),
      engine_(FreeObject(scenario)),
      absent_(events_.obstacles()),
      has_only_floor_(SurfacesOf(scenario, false).empty()) {
  for (const Surface& surface : SurfacesOf(scenario, true)) facts_.push_back({surface});
}

int ContactCollector::NumberOf(const Surface& surface) const {
  const auto at = std::ranges::find(facts_, surface, &ContactFacts::surface);
  return at == facts_.end() ? -1 : static_cast<int>(at - facts_.begin());
}

// Moves the engine's bodies to the poses in the record.
void ContactCollector::Place(const TickRecord& record) {
  const Engine::Layout& at = engine_->layout();
  Engine::Values q = engine_->positions();
  for (std::size_t j = 0; j < record.cobot_dof; ++j) q[at.q[j]] = record.cobot_q[j];
  FrameMotion O;
  O.X_W = FromRecord(record.object.pose);
  O.V_W = Eigen::Map<const Vector6>(record.object.twist.data());
  engine_->MoveObject(O);
  constexpr std::size_t kPositions = 7;  // of a movable object
  Engine::Values movables = engine_->movable_positions();
  for (std::size_t i = 0; i < record.movable_count; ++i) {
    const Pose X = FromRecord(record.movables[i]);
    movables.segment<kPositions>(static_cast<Eigen::Index>(kPositions * i)) << X.p, X.q.w(),
        X.q.vec();
  }
  engine_->SetHeldMovable(record.held - 1);
}

void ContactCollector::AddPoint(const Contact& contact, const FrameMotion& O,
                                std::vector<Touch>* touches) const {
  const bool of_object = contact.link.empty() && contact.body < 0;
  if (!of_object || !contact.other_link.empty() || contact.depth <= 0) return;
  const int number = NumberOf(SurfaceOf(contact));
  if (number < 0) return;
  Touch& touch = (*touches)[static_cast<std::size_t>(number)];
  if (contact.depth > touch.depth) {
    touch.depth = contact.depth;
    touch.normal = contact.normal_W;
  }
  if (contact.fixture < 0) return;
  const FixtureSpec& fixture =
      scenario_.environment.fixtures[static_cast<std::size_t>(contact.fixture)];
  if (!fixture.stiffness) return;
  const Vector3 v = O.V_W.head<3>() + O.V_W.tail<3>().cross(contact.p_W - O.X_W.p);
  touch.force +=
      std::max(0.0, *fixture.stiffness * contact.depth - fixture.damping * contact.normal_W.dot(v));
}

void ContactCollector::Add(const TickRecord& record) {
  if (!record.ran) return;
  if (has_only_floor_ &&
      LowestPoint(engine_->object_model(), FromRecord(record.object.pose)) > kNearFloor)
    return;
  Place(record);
  if (!engine_->Prepare()) return;
  const FrameMotion O = engine_->MotionOf(SceneBody::kObject);
  std::vector<Touch> touches(facts_.size());
  for (int k = 0; k < engine_->contact_count(); ++k) AddPoint(engine_->contact(k), O, &touches);
  absent_ = events_.Absent(record.events, absent_, TouchedFixtures(*engine_));
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    const Touch& touch = touches[i];
    ContactFacts& facts = facts_[i];
    const bool is_absent = facts.surface.kind == Surface::Kind::kFixture &&
                           (absent_ & BitOf(facts.surface.number)) != 0;
    if (touch.depth <= 0 || is_absent) continue;
    facts.time += 1 / scenario_.rate;
    facts.depth = std::max(facts.depth, touch.depth);
    facts.force = std::max(facts.force, touch.force);
    facts.pressing = std::max(facts.pressing, -touch.normal.dot(ForceOfHands(record)));
  }
}

void PredictContacts(std::optional<double> lead, ContactRun* run) try {
  const Scenario& s = run->scenario;
  if (s.mode == Mode::kDirect || !run->has_chapter()) return;
  const World world(s);
  const double dt = 1 / s.rate;
  run->lead = lead ? *lead : ChooseLead(HapticLoop(world.Linearise(), s, dt), s, dt).lead;
  run->predictions = CheckContacts(s, world, run->lead, run->touched_floor());
} catch (const InputError& error) {
  run->problem += std::string("What the arms can render could not be predicted: ") + error.what();
}

}  // namespace predictor
