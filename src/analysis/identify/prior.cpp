#include "analysis/identify/prior.h"

namespace predictor {
namespace {

constexpr double kLoadMass = 1;     // standard deviation of the load's mass, as a share of the mass
constexpr double kLoadCom = 0.1;    // [m]
constexpr double kLoadInertia = 1;  // as a share of the trace

// The six unique elements in the order of InertialParameters.
Vector6 Elements(const Matrix3& I) {
  Vector6 e;
  e << I(0, 0), I(0, 1), I(1, 1), I(0, 2), I(1, 2), I(2, 2);
  return e;
}

struct Body {
  double mass;
  Vector3 com;
  Matrix3 inertia;  // about the centre of mass
};

Body BodyOf(const InertialParameters& p) {
  Body body{p[0], Vector3::Zero(), Matrix3::Zero()};
  if (body.mass > 0) body.com = p.segment<3>(1) / body.mass;
  body.inertia << p[4], p[5], p[7], p[5], p[6], p[8], p[7], p[8], p[9];
  body.inertia += body.mass * Skew(body.com) * Skew(body.com);
  return body;
}

// Columns for mass (density), centre of mass x y z, and elements of the inertia, each for one
// standard deviation.
InertialPrior PriorOf(const Body& body, double mass_share, double com, double inertia_share) {
  InertialPrior prior;
  prior.believed = InertialParametersOf(body.mass, body.com, body.inertia);
  prior.spread.setZero();
  prior.spread.col(0) = mass_share * prior.believed;
  for (int i = 0; i < 3; ++i) {
    const Vector3 e = com * Vector3::Unit(i);
    prior.spread.block<3, 1>(1, 1 + i) = body.mass * e;
    prior.spread.block<6, 1>(4, 1 + i) =
        Elements(-body.mass * (Skew(body.com) * Skew(e) + Skew(e) * Skew(body.com)));
  }
  prior.spread.block<6, 6>(4, 4).diagonal().setConstant(inertia_share * body.inertia.trace());
  return prior;
}

}  // namespace

InertialPrior LinkPrior(const InertialParameters& believed, const IdentifyOptions& options) {
  return PriorOf(BodyOf(believed), options.mass_uncertainty, options.com_uncertainty,
                 options.inertia_uncertainty);
}

InertialPrior LoadPrior(double mass, const Vector3& com, const Matrix3& inertia) {
  return PriorOf({mass, com, inertia}, kLoadMass, kLoadCom, kLoadInertia);
}

}  // namespace predictor
