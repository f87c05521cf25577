#include "analysis/contact_run/contact_run.h"

#include <algorithm>

#include "core/error.h"
#include "haptics/stability.h"
#include "models/arm_model.h"
#include "simulation/world.h"

namespace predictor {
namespace {

// Returns an engine in which the object is a free body among the fixtures. The object's motion
// comes from the records, so any engine finds the same contacts.
std::unique_ptr<Engine> FreeObject(Scenario scenario) {
  scenario.simulation.engine = EngineKind::kMujoco;
  return MakeEngine(scenario, *LoadCobotModel(scenario), false, Holding::kFree);
}

std::uint64_t BitOf(std::size_t fixture) { return std::uint64_t{1} << fixture; }

// Returns the force of all hands on their handles, in axes of W [N].
Vector3 ForceOfHands(const TickRecord& record) {
  Vector3 force = Vector3::Zero();
  for (const HandRecord& hand : record.hands)
    if (hand.present) force += Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]);
  return force;
}

}  // namespace

bool HasContact(const Scenario& s) {
  const auto& fixtures = s.environment.fixtures;
  return std::any_of(fixtures.begin(), fixtures.end(),
                     [](const FixtureSpec& fixture) { return fixture.Touches("object"); });
}

ContactCollector::ContactCollector(const Scenario& scenario)
    : scenario_(scenario),
      events_(scenario),
      engine_(FreeObject(scenario)),
      facts_(scenario.environment.fixtures.size()),
      absent_(events_.obstacles()) {}

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
}

void ContactCollector::AddPoint(const Contact& contact, const FrameMotion& O,
                                std::vector<Touch>* touches) const {
  const bool of_object = contact.link.empty() && contact.body < 0;
  if (contact.fixture < 0 || !of_object || contact.depth <= 0) return;
  const auto i = static_cast<std::size_t>(contact.fixture);
  Touch& touch = (*touches)[i];
  if (contact.depth > touch.depth) {
    touch.depth = contact.depth;
    touch.normal = contact.normal_W;
  }
  const FixtureSpec& fixture = scenario_.environment.fixtures[i];
  if (!fixture.stiffness) return;
  const Vector3 v = O.V_W.head<3>() + O.V_W.tail<3>().cross(contact.p_W - O.X_W.p);
  touch.force +=
      std::max(0.0, *fixture.stiffness * contact.depth - fixture.damping * contact.normal_W.dot(v));
}

void ContactCollector::Add(const TickRecord& record) {
  if (!record.ran) return;
  Place(record);
  if (!engine_->Prepare()) return;
  const FrameMotion O = engine_->MotionOf(SceneBody::kObject);
  std::vector<Touch> touches(facts_.size());
  for (int k = 0; k < engine_->contact_count(); ++k) AddPoint(engine_->contact(k), O, &touches);
  absent_ = events_.Absent(record.events, absent_, TouchedFixtures(*engine_));
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    const Touch& touch = touches[i];
    if (touch.depth <= 0 || (absent_ & BitOf(i)) != 0) continue;
    ContactFacts& facts = facts_[i];
    facts.time += 1 / scenario_.rate;
    facts.depth = std::max(facts.depth, touch.depth);
    facts.force = std::max(facts.force, touch.force);
    facts.pressing = std::max(facts.pressing, -touch.normal.dot(ForceOfHands(record)));
  }
}

void PredictContacts(std::optional<double> lead, ContactRun* run) try {
  const Scenario& s = run->scenario;
  if (s.mode == Mode::kDirect) return;
  const World world(s);
  const LinearModel linear = world.Linearise();
  const double dt = 1 / s.rate;
  run->lead = lead ? *lead : ChooseLead(HapticLoop(linear, s, dt), s, dt).lead;
  run->predictions = CheckContacts(s, linear, world.state().object.X_W, run->lead);
} catch (const InputError& error) {
  run->problem += std::string("What the arms can render could not be predicted: ") + error.what();
}

}  // namespace predictor
