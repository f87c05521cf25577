#include "analysis/identify/identify.h"

#include <algorithm>
#include <cmath>

#include "analysis/identify/fit.h"
#include "analysis/identify/rows.h"
#include "core/error.h"
#include "core/text.h"
#include "models/torque_regressor.h"

namespace predictor {
namespace {

// ---- prior knowledge about the inertia of links and load before any motion

// π = nominal + spread z, where z is normal with mean 0 and variance 1.
struct InertialPrior {
  InertialParameters nominal;
  Eigen::Matrix<double, 10, 10> spread;
};

constexpr double kLoadMass = 1;     // standard deviation of the load's mass, as a share of the mass
constexpr double kLoadCom = 0.1;    // [m]
constexpr double kLoadInertia = 1;  // as a share of the trace

// Returns the six unique elements in the order of InertialParameters.
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

// Returns one column for the mass (density), three columns for x, y and z of the centre of mass,
// and further columns for the elements of the inertia. Each column is the change that corresponds
// to one standard deviation.
InertialPrior PriorOf(const Body& body, double mass_share, double com, double inertia_share) {
  InertialPrior prior;
  prior.nominal = InertialParametersOf(body.mass, body.com, body.inertia);
  prior.spread.setZero();
  prior.spread.col(0) = mass_share * prior.nominal;
  for (int i = 0; i < 3; ++i) {
    const Vector3 e = com * Vector3::Unit(i);
    prior.spread.block<3, 1>(1, 1 + i) = body.mass * e;
    prior.spread.block<6, 1>(4, 1 + i) =
        Elements(-body.mass * (Skew(body.com) * Skew(e) + Skew(e) * Skew(body.com)));
  }
  prior.spread.block<6, 6>(4, 4).diagonal().setConstant(inertia_share * body.inertia.trace());
  return prior;
}

// Returns the prior of a link with parameters π, computed to first order from the uncertainty in
// `options`.
InertialPrior LinkPrior(const InertialParameters& nominal, const IdentifyOptions& options) {
  return PriorOf(BodyOf(nominal), options.mass_uncertainty, options.com_uncertainty,
                 options.inertia_uncertainty);
}

// Returns the prior of the load, of which little is known: the standard deviations are 100 % for
// its mass and 0.1 m for its centre of gravity.
InertialPrior LoadPrior(double mass, const Vector3& com, const Matrix3& inertia) {
  return PriorOf({mass, com, inertia}, kLoadMass, kLoadCom, kLoadInertia);
}

// ---- the equations

constexpr double kMinDuration = 10;     // minimum duration of a run [s]
constexpr double kMinMotionTime = 2;    // minimum time of motion of a joint in each direction [s]
constexpr double kMinSpeedRatio = 1.5;  // minimum ratio of a joint's fast speeds to its slow ones
constexpr double kMaxMassUncertainty = 0.25;  // largest half-width of the load's mass, as a share
                                              // of the mass
constexpr double kStrain = 3;  // threshold, in standard deviations of a sum of squares
constexpr int kBlocks = 10;    // blocks of the cross-validation
constexpr int kBody = 10;      // number of inertial parameters of a body

constexpr const char* kHowToExcite =
    "Record a run in which the controller moves all joints, as in scenarios/excite_cobot.yaml.";

// The parameters are ordered as follows: viscous and Coulomb friction of each joint, then the
// normalised parameters z of each link, and then those of the load.
struct Layout {
  int joints;
  int links() const { return kFrictionColumns * joints; }
  int load() const { return links() + kBody * joints; }
  int parameters() const { return load() + kBody; }
};

std::vector<int> Range(int from, int to) {
  std::vector<int> range;
  range.reserve(static_cast<std::size_t>(std::max(0, to - from)));
  for (int i = from; i < to; ++i) range.push_back(i);
  return range;
}

std::vector<int> Sum(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::sort(a.begin(), a.end());
  return a;
}

std::vector<InertialPrior> PriorsOf(const RowBuilder& builder, const IdentifyOptions& options) {
  std::vector<InertialPrior> priors;
  priors.reserve(static_cast<std::size_t>(builder.robot().dof()) + 1);
  for (int j = 0; j < builder.robot().dof(); ++j)
    priors.push_back(LinkPrior(builder.link_parameters().segment<kBody>(kBody * j), options));
  const ObjectModel& load = builder.load();
  priors.push_back(LoadPrior(load.mass, load.com, load.inertia));
  return priors;
}

// Adds the rows of the prior, in units of its standard deviation.
FitProblem ProblemOf(const RowBuilder& builder, const std::vector<InertialPrior>& priors) {
  const Layout layout{builder.robot().dof()};
  FitProblem problem;
  problem.parameters = layout.parameters();
  for (int j = 0; j < layout.joints; ++j) {
    const JointRows& from = builder.rows()[static_cast<std::size_t>(j)];
    FitRows rows;
    rows.window = from.window;
    const auto count = static_cast<Eigen::Index>(from.y.size());
    rows.y = Eigen::Map<const Eigen::VectorXd>(from.y.data(), count);
    rows.x =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            from.x.data(), count, builder.columns());
    for (std::size_t b = 0; b < priors.size(); ++b) {
      auto body = rows.x.middleCols<kBody>(kFrictionColumns + kBody * static_cast<int>(b));
      rows.y -= body * priors[b].nominal;
      body = (body * priors[b].spread).eval();
    }
    rows.index = Sum({kFrictionColumns * j, kFrictionColumns * j + 1},
                     Range(layout.links(), layout.parameters()));
    problem.joints.push_back(std::move(rows));
  }
  CloseGaps(&problem);
  return problem;
}

FitModel ModelOf(InertiaModel kind, const Layout& layout, const std::vector<int>& base) {
  const std::vector<int> friction = Range(0, layout.links());
  FitModel model;
  model.precision.setZero(layout.parameters());
  switch (kind) {
    case InertiaModel::kFixed:
      model.free = Sum(friction, Range(layout.load(), layout.parameters()));
      model.precision.tail<kBody>().setOnes();
      break;
    case InertiaModel::kRegularised:
      model.free = Range(0, layout.parameters());
      model.precision.tail(layout.parameters() - layout.links()).setOnes();
      break;
    case InertiaModel::kBase:
      model.free = Sum(friction, base);
      break;
  }
  return model;
}

Estimate EstimateAt(const Fit& fit, int at) {
  return {fit.value[at], fit.quantile * std::sqrt(std::max(0.0, fit.covariance(at, at)))};
}

double Quantile(std::vector<float> x, double q) {
  if (x.empty()) return 0;
  const auto at = static_cast<std::size_t>(q * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(at), x.end());
  return x[at];
}

std::string Seconds(double t) { return FormatNumber(std::round(10 * t) / 10) + " s"; }

// Returns the reason why a joint's friction cannot be identified, or "" if it can be.
std::string RefusalOf(const JointIdentification& joint) {
  const auto& [back, forth] = joint.moving;
  if (back < kMinMotionTime || forth < kMinMotionTime) {
    return Quote(joint.name) + " moved backward for " + Seconds(back) + " and forward for " +
           Seconds(forth) + " (faster than " + FormatNumber(kTurning) + " rad/s), but at least " +
           Seconds(kMinMotionTime) + " in each direction are needed to identify its friction. " +
           kHowToExcite;
  }
  if (joint.fast < kMinSpeedRatio * joint.slow) {
    return Quote(joint.name) +
           " always moved at nearly the same speed, so viscous and Coulomb friction cannot be "
           "distinguished. Move the joint slowly and fast. " +
           kHowToExcite;
  }
  return "";
}

// Computes the mass and the centre of gravity of the load from its normalised parameters z.
LoadIdentification LoadOf(const ObjectModel& nominal, const InertialPrior& prior, const Fit& fit,
                          int z_at, int covariance_at) {
  LoadIdentification load;
  load.nominal_mass = nominal.mass;
  load.nominal_com = nominal.com;
  const InertialParameters pi = prior.nominal + prior.spread * fit.value.segment<kBody>(z_at);
  const Eigen::MatrixXd C = prior.spread *
                            fit.covariance.block<kBody, kBody>(covariance_at, covariance_at) *
                            prior.spread.transpose();
  const double m = pi[0];
  load.mass = {m, fit.quantile * std::sqrt(std::max(0.0, C(0, 0)))};
  for (int i = 0; i < 3; ++i) {
    const double c = pi[1 + i] / m;
    const double variance = (C(1 + i, 1 + i) - 2 * c * C(0, 1 + i) + c * c * C(0, 0)) / (m * m);
    load.com[static_cast<std::size_t>(i)] = {c, fit.quantile * std::sqrt(std::max(0.0, variance))};
  }
  if (!(m > 0) || load.mass.half_width > kMaxMassUncertainty * m) {
    load.refusal =
        std::string("The mass of the load cannot be distinguished from the masses of the links. ") +
        "Hold the load in more postures, and rotate it. " + kHowToExcite;
  }
  return load;
}

double Mean(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v;
  return x.empty() ? 0 : sum / static_cast<double>(x.size());
}

// Returns the root mean square of the prediction errors of all joints.
double HeldOut(const CrossValidation& c) {
  double squares = 0, rows = 0;
  for (std::size_t j = 0; j < c.rows.size(); ++j) squares += c.error_squares[j], rows += c.rows[j];
  return rows > 0 ? std::sqrt(squares / rows) : 0;
}

ModelScore ScoreOf(const CrossValidation& c, const CrossValidation& regularised) {
  ModelScore score;
  score.held_out = HeldOut(c);
  std::vector<double> excess;
  for (std::size_t b = 0; b < std::min(c.loss.size(), regularised.loss.size()); ++b)
    excess.push_back(c.loss[b] - regularised.loss[b]);
  score.excess = Mean(excess);
  double squares = 0;
  for (const double e : excess) squares += (e - score.excess) * (e - score.excess);
  const auto n = static_cast<double>(excess.size());
  score.excess_error = n > 1 ? std::sqrt(squares / (n - 1) / n) : 0;
  return score;
}

// Chooses the regularised model, unless another model predicts significantly better.
InertiaModel Choose(const std::array<ModelScore, kInertiaModels>& scores) {
  auto best = InertiaModel::kRegularised;
  double least = 0;
  for (int k = 0; k < kInertiaModels; ++k) {
    const ModelScore& s = scores[static_cast<std::size_t>(k)];
    if (s.excess < -2 * s.excess_error && s.excess < least) {
      least = s.excess;
      best = static_cast<InertiaModel>(k);
    }
  }
  return best;
}

}  // namespace

struct Identifier::Impl {
  Impl(const Scenario& nominal, const IdentifyOptions& o)
      : options(o), builder(nominal, o.window) {}

  void CheckInput() const {
    const int recorded = builder.recorded_joints();
    if (recorded != 0 && recorded != builder.robot().dof()) {
      throw InputError("The recorded cobot has " + std::to_string(recorded) +
                       " joints, but the scenario's cobot has " +
                       std::to_string(builder.robot().dof()) +
                       ". Pass the scenario that was recorded.");
    }
    if (builder.duration() < kMinDuration) {
      throw InputError("The recording lasts " + Seconds(builder.duration()) +
                       ", but identification needs at least " + Seconds(kMinDuration) +
                       "; a minute is better. " + kHowToExcite);
    }
  }

  // Checks the motion of each joint, and determines which joints must be refused.
  void Excitation(Identification* result) const {
    for (int j = 0; j < builder.robot().dof(); ++j) {
      const JointRows& rows = builder.rows()[static_cast<std::size_t>(j)];
      JointIdentification joint;
      joint.name = builder.robot().joint_name(j);
      joint.moving = rows.moving;
      joint.slow = Quantile(rows.speed, 0.1);
      joint.fast = Quantile(rows.speed, 0.9);
      joint.refusal = RefusalOf(joint);
      result->joints.push_back(joint);
    }
  }

  Identification Finish() const {
    CheckInput();
    Identification result;
    result.duration = builder.duration();
    result.not_finite = builder.not_finite();
    Excitation(&result);
    const Layout layout{builder.robot().dof()};
    const std::vector<InertialPrior> priors = PriorsOf(builder, options);
    const FitProblem problem = ProblemOf(builder, priors);
    const std::vector<int> wanted =
        Sum(Range(0, layout.links()), Range(layout.load(), layout.parameters()));
    const auto model = [&](InertiaModel kind, const std::vector<int>& base) {
      return ModelOf(kind, layout, base);
    };
    std::array<Fit, kInertiaModels> fits;
    const auto regularised = static_cast<std::size_t>(InertiaModel::kRegularised);
    fits[regularised] = FitRobustly(problem, model(InertiaModel::kRegularised, {}), wanted);
    const std::vector<int> base =
        BaseParameters(problem, fits[regularised], Range(0, layout.links()),
                       Range(layout.links(), layout.parameters()), &result.condition);
    result.base_parameters = static_cast<int>(base.size());
    std::array<CrossValidation, kInertiaModels> validations;
    for (std::size_t k = 0; k < kInertiaModels; ++k) {
      const FitModel m = model(static_cast<InertiaModel>(k), base);
      if (k != regularised) fits[k] = FitRobustly(problem, m, wanted);
      validations[k] = CrossValidate(problem, m, fits[k], fits[regularised].scale, kBlocks);
    }
    for (std::size_t k = 0; k < kInertiaModels; ++k)
      result.scores[k] = ScoreOf(validations[k], validations[regularised]);
    result.model = Choose(result.scores);
    const auto chosen = static_cast<std::size_t>(result.model);
    Strain(fits[regularised].value.segment(layout.links(), kBody * layout.joints), &result);
    Report(layout, priors, fits[chosen], validations[chosen], &result);
    return result;
  }

  // Computes the strain from the links' normalised parameters z, which have a variance of 1 if the
  // prior is correct.
  static void Strain(const Eigen::VectorXd& z, Identification* result) {
    const double k = std::max(1, result->base_parameters);
    result->strain = std::sqrt(z.squaredNorm() / k);
    result->strained = z.squaredNorm() > k + kStrain * std::sqrt(2 * k);
  }

  void Report(const Layout& layout, const std::vector<InertialPrior>& priors, const Fit& fit,
              const CrossValidation& validation, Identification* result) const {
    for (int j = 0; j < layout.joints; ++j) {
      const auto i = static_cast<std::size_t>(j);
      JointIdentification& joint = result->joints[i];
      joint.viscous = EstimateAt(fit, kFrictionColumns * j);
      joint.coulomb = EstimateAt(fit, kFrictionColumns * j + 1);
      if (validation.rows[i] > 0)
        joint.held_out = std::sqrt(validation.error_squares[i] / validation.rows[i]);
    }
    result->load = LoadOf(builder.load(), priors.back(), fit, layout.load(), layout.links());
    if (result->model == InertiaModel::kBase || result->strained) {
      result->load.refusal =
          "The links differ more from their model than assumed, so the load cannot be "
          "distinguished from the links. Give a better model of the cobot, or the true "
          "--mass-uncertainty and --com-uncertainty.";
    }
  }

  const IdentifyOptions options;
  RowBuilder builder;
};

Identifier::Identifier(const Scenario& nominal, const IdentifyOptions& options)
    : impl_(std::make_unique<Impl>(nominal, options)) {}
Identifier::~Identifier() = default;
void Identifier::Add(const TickRecord& record) { impl_->builder.Add(record); }
Identification Identifier::Finish() const { return impl_->Finish(); }

bool Identification::complete() const {
  return std::all_of(joints.begin(), joints.end(),
                     [](const JointIdentification& j) { return j.identified(); });
}

bool IsWide(const Estimate& estimate) {
  constexpr double kWide = 0.05;
  constexpr double kNothing = 0.005;  // [N·m], [N·m·s/rad]; for the load [kg], [m]
  return !(estimate.half_width <= kWide * std::abs(estimate.value) ||
           estimate.half_width <= kNothing);
}

Scenario WithFriction(const Scenario& scenario, const Identification& identification) {
  Scenario changed = scenario;
  JointFriction& friction = changed.cobot.joint_friction;
  const JointFriction before = friction;
  friction.viscous.clear();
  friction.coulomb.clear();
  for (std::size_t j = 0; j < identification.joints.size(); ++j) {
    const JointIdentification& joint = identification.joints[j];
    const int i = static_cast<int>(j);
    const bool known = joint.identified();
    friction.viscous.push_back(known ? std::max(0.0, joint.viscous.value)
                                     : OneOrEach(before.viscous, i));
    friction.coulomb.push_back(known ? std::max(0.0, joint.coulomb.value)
                                     : OneOrEach(before.coulomb, i));
  }
  return changed;
}

}  // namespace predictor
