#include "person/legs.h"

#include <algorithm>
#include <cmath>

namespace predictor::person {
namespace {

constexpr double kHeelToAnkle = 0.25;  // as a share of the foot's length
constexpr double kFootWidth = 0.055;   // as a share of the person's height

struct Leg {
  std::array<Vector3, 3> com, joints;
  double knee_flexion = 0, stretched = 0;
};

Leg LegOf(const Anthropometry& a, const Vector3& hip, const Vector3& ankle, const Vector3& ahead) {
  Leg leg;
  const double thigh = a.thigh.length, shank = a.shank.length;
  const Vector3 down = ankle - hip;
  const double apart = down.norm();
  const double reach = std::clamp(apart, std::abs(thigh - shank) + 1e-6, thigh + shank);
  leg.stretched = std::max(0.0, apart - thigh - shank);
  // The position of the knee along the line from hip to ankle, and the distance of the knee from
  // that line.
  const double along = (thigh * thigh - shank * shank + reach * reach) / (2 * reach);
  const double out = std::sqrt(std::max(0.0, thigh * thigh - along * along));
  const Vector3 axis = down.normalized();
  const Vector3 forward = (ahead - ahead.dot(axis) * axis).normalized();
  const Vector3 knee = hip + axis * along * apart / reach + forward * out;
  const double cosine = (thigh * thigh + shank * shank - reach * reach) / (2 * thigh * shank);
  leg.knee_flexion = std::acos(-1.0) - std::acos(std::clamp(cosine, -1.0, 1.0));
  leg.joints = {hip, knee, ankle};
  leg.com[0] = hip + (knee - hip) * (a.thigh.com / thigh);
  leg.com[1] = knee + (ankle - knee) * (a.shank.com / shank);
  leg.com[2] = {ankle.x() + a.foot.com - kHeelToAnkle * a.foot.length, ankle.y(),
                a.ankle_height / 2};
  return leg;
}

}  // namespace

BodyLegs LegsOf(const BodyModel& model, const BodyVector& q, double width) {
  const Anthropometry& a = model.anthropometry();
  const Placement at = Place(model, q);
  const Pose pelvis = at.FrameOf(kPelvisList);
  BodyLegs legs;
  for (int side = 0; side < kHands; ++side) {
    const auto k = static_cast<std::size_t>(side);
    const double sign = side == 0 ? 1 : -1;
    const Leg leg = LegOf(a, pelvis * Vector3(0, sign * a.half_hip_width, 0),
                          {0, sign * width / 2, a.ankle_height}, pelvis.q * Vector3::UnitX());
    legs.com[k] = leg.com;
    legs.joints[k] = leg.joints;
    legs.knee_flexion[k] = leg.knee_flexion;
    legs.stretched = std::max(legs.stretched, leg.stretched);
  }
  return legs;
}

double Footprint::MarginOf(double x, double y) const {
  return std::min({x - back, front - x, half_width - std::abs(y)});
}

Footprint FootprintOf(const Anthropometry& a, double width) {
  return {-kHeelToAnkle * a.foot.length, (1 - kHeelToAnkle) * a.foot.length,
          width / 2 + kFootWidth * a.height / 2};
}

}  // namespace predictor::person
