#include "assessment/safety/letting_go.h"

#include <algorithm>
#include <cmath>

#include "person/legs.h"

namespace predictor::assessment {
namespace {

Vector3 LinearOf(const MotionRecord& m) { return {m.twist[0], m.twist[1], m.twist[2]}; }

// Returns the speed of the fastest point of the outline [m/s]: |v + ω × r| of a point, and at most
// |ω| times the radius more on the sphere around it.
double FastestOf(const std::vector<OutlinePoint>& outline, const MotionRecord& object) {
  const Quaternion q = FromRecord(object.pose).q;
  const Vector3 v = LinearOf(object), w(object.twist[3], object.twist[4], object.twist[5]);
  double fastest = v.norm();
  for (const OutlinePoint& point : outline)
    fastest = std::max(fastest, (v + w.cross(q * point.p)).norm() + w.norm() * point.radius);
  return fastest;
}

double HorizontalDistance(const PersonSetup& setup, const Vector3& p_W) {
  const Vector3 p = setup.stance.X_WS.Inverse() * p_W;
  return std::hypot(p.x(), p.y());
}

double ShareOf(double value, double limit) { return limit > 0 ? value / limit : INFINITY; }

}  // namespace

SceneMotion::Sample SceneMotion::SampleOf(const TickRecord& record) const {
  Sample sample = {.time = record.run_time,
                   .object = FromRecord(record.object.pose).p,
                   .end_effector = FromRecord(record.end_effector.pose).p,
                   .object_speed = FastestOf(outline_, record.object),
                   .end_effector_speed = LinearOf(record.end_effector).norm()};
  for (const HandRecord& hand : record.hands)
    if (hand.present)
      sample.object_speed = std::max(sample.object_speed, LinearOf(hand.virtual_).norm());
  return sample;
}

void SceneMotion::Add(const TickRecord& record) {
  if (!record.ran) return;
  const Sample now = SampleOf(record);
  if (!any_ || now.speed() > fastest_.speed()) fastest_ = now;
  if (!any_ || now.object.z() > highest_.object.z()) highest_ = now;
  int gripping = 0;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = record.hands[i];
    if (!hand.present || !hand.gripping) continue;
    ++gripping;
    min_lift_[i] = std::min(min_lift_[i], hand.wrench[2]);
  }
  if (any_ && gripping < gripping_) {
    released_ = true;
    releases_.push_back(now);
  } else if (gripping > gripping_) {
    released_ = false;
  }
  if (released_ && now.speed() > releases_.back().speed()) releases_.back() = now;
  gripping_ = gripping;
  any_ = true;
}

double NeededSeparation(double robot_speed) {
  const double stop_time = robot_speed / kStopDeceleration;
  return kApproachSpeed * (kReactionTime + stop_time) + robot_speed * kReactionTime +
         robot_speed * stop_time / 2;
}

Drop DropOf(const SceneMotion& motion, const SceneMasses& masses, const PersonSetup& setup,
            const Scenario& scenario) {
  Drop drop;
  const SceneMotion::Sample& from = motion.highest();
  const Vector3 p = setup.stance.X_WS.Inverse() * from.object;
  drop.time = from.time;
  drop.height = std::max(0.0, p.z());
  drop.energy = masses.object * kStandardGravity * drop.height;
  drop.speed = std::sqrt(2 * kStandardGravity * drop.height);
  const person::Footprint feet =
      person::FootprintOf(person::AnthropometryOf(setup.body), setup.stance.width);
  const double beyond_x = std::max({feet.back - p.x(), 0.0, p.x() - feet.front});
  const double beyond_y = std::max(std::abs(p.y()) - feet.half_width, 0.0);
  drop.beside_feet = std::hypot(beyond_x, beyond_y);
  const int hands = (scenario.Has(0) ? 1 : 0) + (scenario.Has(1) ? 1 : 0);
  drop.weight_of_hand = masses.object * kStandardGravity / hands;
  for (int hand = 0; hand < kHands; ++hand)
    if (std::isfinite(motion.min_lift(hand)))
      drop.jump = std::max(drop.jump, drop.weight_of_hand - motion.min_lift(hand));
  return drop;
}

Separation SeparationOf(const SceneMotion& motion, const PersonSetup& setup) {
  std::vector<SceneMotion::Sample> moments = motion.releases();
  if (moments.empty()) moments.push_back(motion.fastest());
  Separation worst;
  double missing = -INFINITY;
  for (const SceneMotion::Sample& moment : moments) {
    const Separation here = {.time = moment.time,
                             .speed = moment.speed(),
                             .needed = NeededSeparation(moment.speed()),
                             .distance = std::min(HorizontalDistance(setup, moment.object),
                                                  HorizontalDistance(setup, moment.end_effector))};
    if (here.needed - here.distance <= missing) continue;
    missing = here.needed - here.distance;
    worst = here;
  }
  return worst;
}

std::vector<std::string> ClampingFixtures(const Scenario& scenario) {
  std::vector<std::string> names;
  if (scenario.environment.floor) names.emplace_back("the floor");
  if (scenario.environment.table) names.emplace_back("the table");
  // Keep-out volumes are not bodies.
  for (const FixtureSpec& fixture : scenario.environment.fixtures)
    if (!fixture.keep_out && (fixture.Touches("object") || fixture.Touches("cobot")))
      names.push_back(fixture.name.empty() ? "a " + NameOf(fixture.shape) : fixture.name);
  return names;
}

UnintendedContact ContactOf(const SceneMotion& motion, const SceneMasses& masses,
                            const ergonomics::ContactLimits& limits, const Scenario& scenario) {
  using ergonomics::ContactKind;
  UnintendedContact contact;
  contact.edition = limits.edition;
  contact.robot_mass = ergonomics::EffectiveRobotMass(masses.cobot, masses.object);
  contact.speed = motion.fastest().speed();
  contact.time = motion.fastest().time;
  contact.fixtures = ClampingFixtures(scenario);
  // The cobot clamps with at most the bound on the controller's force, or with at most the
  // estimated force at which the cobot stops itself.
  for (const auto& bound : {scenario.cobot.safety.force, scenario.cobot.safety.force_cap})
    if (bound) contact.clamping_force = std::min(contact.clamping_force.value_or(*bound), *bound);
  std::string region;
  for (const ergonomics::ContactLimit& limit : limits.points) {
    if (limit.region == region) continue;
    region = limit.region;
    const double speed =
        MaxContactSpeed(limit, {ContactKind::kTransient, contact.robot_mass, 0}).speed;
    contact.regions.push_back(
        {.limit = limit, .max_speed = speed, .share = ShareOf(contact.speed, speed)});
    if (contact.clamping_force)
      contact.clamped.push_back({.limit = limit,
                                 .max_speed = speed,
                                 .share = ShareOf(*contact.clamping_force,
                                                  ForceLimit(limit, ContactKind::kQuasiStatic))});
  }
  return contact;
}

}  // namespace predictor::assessment
