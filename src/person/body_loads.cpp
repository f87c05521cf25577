#include "person/body_loads.h"

#include <cmath>

namespace predictor::person {

DiscLoads BodyDynamics::DiscOf(const Placement& at, const JointLoads& loads) const {
  // `force` and `moment` act on the upper body, in the pelvis's axes. Flexion and lateral bending
  // are positive about y and x, so the muscles that resist them produce the opposite moments.
  const Matrix3 to_pelvis = at.R[kPelvisList].transpose();
  const Vector3 force = to_pelvis * loads.force[kTorsoFlexion];
  const Vector3 moment = to_pelvis * loads.moment[kTorsoFlexion];
  DiscLoads disc;
  disc.flexion_moment = -moment.y();
  disc.lateral_moment = -moment.x();
  disc.twist_moment = moment.z();
  const Vector3 normal(std::sin(kSacralAngle), 0, std::cos(kSacralAngle));
  const Vector3 forward(std::cos(kSacralAngle), 0, -std::sin(kSacralAngle));
  disc.compression =
      force.dot(normal) + std::hypot(disc.flexion_moment, disc.lateral_moment) / muscle_arm_;
  disc.shear = -force.dot(forward);
  return disc;
}

Balance BodyDynamics::BalanceOf(const BodyMotion& motion, const Placement& at,
                                const JointLoads& loads) const {
  const Anthropometry& a = model_.anthropometry();
  Vector3 force = loads.force[kPelvisX];
  Vector3 moment = loads.moment[kPelvisX] + at.p[kPelvisX].cross(force);
  const BodyLegs legs = LegsOf(model_, motion.q, stance_.width);
  const std::array<double, 3> masses = {a.thigh.mass, a.shank.mass, a.foot.mass};
  for (const auto& leg : legs.com) {
    for (std::size_t part = 0; part < masses.size(); ++part) {
      const Vector3 support(0, 0, masses[part] * kStandardGravity);
      force += support;
      moment += leg[part].cross(support);
    }
  }
  Balance balance;
  balance.ground_force = force.z();
  balance.x = -moment.y() / force.z();
  balance.y = moment.x() / force.z();
  balance.margin = FootprintOf(a, stance_.width).MarginOf(balance.x, balance.y);
  return balance;
}

BodyLoads BodyDynamics::Evaluate(const BodyMotion& motion, const BodySample& sample) const {
  const auto wrenches = WrenchesOn(sample, stance_);
  const JointLoads with = InverseDynamics(model_, motion.q, motion.v, motion.a, wrenches);
  const JointLoads without = InverseDynamics(model_, motion.q, motion.v, motion.a, {});
  const Placement at = Place(model_, motion.q);
  BodyLoads loads;
  loads.torque = with.torque;
  loads.overload = with.torque - without.torque;
  for (int hand = 0; hand < kHands; ++hand) {
    const auto shoulder = static_cast<std::size_t>(Of(hand, ArmJoint::kShoulderFlexion));
    loads.shoulder_moment[static_cast<std::size_t>(hand)] = with.moment[shoulder].norm();
  }
  loads.l5s1 = DiscOf(at, with);
  loads.balance = BalanceOf(motion, at, with);
  return loads;
}

}  // namespace predictor::person
