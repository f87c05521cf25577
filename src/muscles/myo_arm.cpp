#include "muscles/myo_arm.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "muscles/myo_arm_files.h"

namespace predictor::muscles {
namespace {

using person::ArmJoint;

constexpr int kMaxDofs = 256;

// The muscles of MyoArm that together form one of our muscles.
struct Strands {
  const char* key;  // key in MuscleTable
  std::vector<const char*> names;
};

const std::vector<Strands>& AllStrands() {
  static const std::vector<Strands> kStrands = {{"deltoid_anterior", {"DELT1"}},
                                                {"deltoid_middle", {"DELT2"}},
                                                {"deltoid_posterior", {"DELT3"}},
                                                {"supraspinatus", {"SUPSP"}},
                                                {"infraspinatus", {"INFSP"}},
                                                {"subscapularis", {"SUBSC"}},
                                                {"teres_minor", {"TMIN"}},
                                                {"teres_major", {"TMAJ"}},
                                                {"pectoralis_clavicular", {"PECM1"}},
                                                {"pectoralis_sternal", {"PECM2"}},
                                                {"pectoralis_costal", {"PECM3"}},
                                                {"latissimus_upper", {"LAT1"}},
                                                {"latissimus_lower", {"LAT2", "LAT3"}},
                                                {"coracobrachialis", {"CORB"}},
                                                {"triceps_long", {"TRIlong"}},
                                                {"triceps_lateral", {"TRIlat"}},
                                                {"triceps_medial", {"TRImed"}},
                                                {"anconeus", {"ANC"}},
                                                {"biceps_long", {"BIClong"}},
                                                {"biceps_short", {"BICshort"}},
                                                {"brachialis", {"BRA"}},
                                                {"brachioradialis", {"BRD"}},
                                                {"supinator", {"SUP"}},
                                                {"pronator_teres", {"PT"}},
                                                {"pronator_quadratus", {"PQ"}},
                                                {"ecrl", {"ECRL"}},
                                                {"ecrb", {"ECRB"}},
                                                {"ecu", {"ECU"}},
                                                {"fcr", {"FCR"}},
                                                {"fcu", {"FCU"}},
                                                {"fds", {"FDS2", "FDS3", "FDS4", "FDS5"}},
                                                {"fdp", {"FDP2", "FDP3", "FDP4", "FDP5"}},
                                                {"edc", {"EDC2", "EDC3", "EDC4", "EDC5"}}};
  return kStrands;
}

// A joint of MyoArm with one degree of freedom.
struct MyoJoint {
  int q = -1, v = -1, id = -1;  // index in qpos, index in qvel, number of the joint
};

// A joint whose position is coupled to that of another joint.
struct Coupling {
  MyoJoint dependent, independent;
  std::array<double, 5> polynomial = {};

  double ValueAt(double x) const {
    return ((((polynomial[4] * x + polynomial[3]) * x + polynomial[2]) * x + polynomial[1]) * x) +
           polynomial[0];
  }
  double SlopeAt(double x) const {
    return ((4 * polynomial[4] * x + 3 * polynomial[3]) * x + 2 * polynomial[2]) * x +
           polynomial[1];
  }
};

// A tendon of MyoArm and the tendon's share of one of our muscles.
struct Strand {
  int tendon = -1, muscle = -1;
  double share = 0;
};

// The angles of three successive rotations: about the axis of the plane of elevation, about the
// axis of elevation, and again about the first axis.
struct ShoulderAngles {
  double plane = 0, elevation = 0, rotation = 0;
};

class MyoArm final : public ArmPaths {
 public:
  MyoArm(MyoModel model, const std::string& source);

  const char* name() const override { return "MyoArm"; }
  MuscleLines LinesAt(const ArmVector& q) const noexcept override;
  const MuscleParameters& muscle(int i) const override {
    return muscles_[static_cast<std::size_t>(i)];
  }

 private:
  int IdOf(mjtObj kind, const std::string& name, const char* what) const;
  MyoJoint JointOf(const std::string& name) const;
  void ReadCouplings();
  void ReadMuscle(const Strands& strands, int muscle);
  void SetGrip();
  void SetFrames();
  ShoulderAngles ShoulderAt(const Matrix3& R) const noexcept;
  void SetPosture(const ArmVector& q, const Matrix3& R_upper_arm) const noexcept;
  Vector3 AxisOf(const MyoJoint& joint) const noexcept {
    return Eigen::Map<const Vector3>(data_->xaxis + 3 * joint.id);
  }

  std::string source_;
  MyoModel model_;
  MyoData data_;
  MyoJoint plane_, elevation_, rotation_, elbow_, pronation_, flexion_, deviation_;
  // Three additional joints at the centre of the shoulder. The axes of these joints are never in
  // one plane. If the upper arm hangs, the axes of plane, elevation and rotation are in one plane,
  // so this posture is singular.
  std::array<MyoJoint, 3> ball_;
  std::vector<Coupling> couplings_;
  std::vector<Strand> strands_;
  std::array<MuscleParameters, kMuscles> muscles_;
  std::vector<double> rest_;  // qpos of the joints that do not move
  person::BodyModel body_{BodySpec{}};
  Matrix3 R_WS_ = Matrix3::Identity();        // rotation of our torso's axes in MyoArm's world
  Matrix3 R_shoulder_ = Matrix3::Identity();  // columns: elevation axis, normal, plane axis
};

MyoArm::MyoArm(MyoModel model, const std::string& source)
    : source_(source), model_(std::move(model)), data_(mj_makeData(model_.get())) {
  if (model_->nv > kMaxDofs)
    throw InputError(source_, "The model has " + std::to_string(model_->nv) +
                                  " degrees of freedom, but " + std::to_string(kMaxDofs) +
                                  " is the limit. Give a model of the arm alone.");
  plane_ = JointOf("elv_angle");
  elevation_ = JointOf("shoulder_elv");
  rotation_ = JointOf("shoulder_rot");
  elbow_ = JointOf("elbow_flexion");
  pronation_ = JointOf("pro_sup");
  flexion_ = JointOf("flexion");
  deviation_ = JointOf("deviation");
  ball_ = {JointOf("unrothum_r1"), JointOf("unrothum_r2"), JointOf("unrothum_r3")};
  ReadCouplings();
  for (int i = 0; i < kMuscles; ++i) {
    const char* key = MuscleTable()[static_cast<std::size_t>(i)].key;
    for (const Strands& strands : AllStrands())
      if (std::string(strands.key) == key) ReadMuscle(strands, i);
  }
  SetGrip();
  SetFrames();
}

// The names of the joints and muscles of the right arm may end with _r.
int MyoArm::IdOf(mjtObj kind, const std::string& name, const char* what) const {
  for (const std::string& full : {name + "_r", name})
    if (const int id = mj_name2id(model_.get(), kind, full.c_str()); id >= 0) return id;
  throw InputError(source_,
                   std::string("The model has no ") + what + " " + Quote(name) +
                       ", so it is not MyoArm. Give the folder myo_sim/models of the package "
                       "myo-sim 0.2.4, or an MJCF file that contains its whole right arm.");
}

MyoJoint MyoArm::JointOf(const std::string& name) const {
  const int id = IdOf(mjOBJ_JOINT, name, "joint");
  return {model_->jnt_qposadr[id], model_->jnt_dofadr[id], id};
}

void MyoArm::ReadCouplings() {
  const mjModel* m = model_.get();
  const auto joint = [&](int id) -> MyoJoint {
    return {m->jnt_qposadr[id], m->jnt_dofadr[id], id};
  };
  for (int i = 0; i < m->neq; ++i) {
    if (m->eq_type[i] != mjEQ_JOINT || m->eq_obj2id[i] < 0) continue;
    Coupling coupling{joint(m->eq_obj1id[i]), joint(m->eq_obj2id[i]), {}};
    std::copy_n(m->eq_data + i * mjNEQDATA, coupling.polynomial.size(),
                coupling.polynomial.begin());
    couplings_.push_back(coupling);
  }
}

void MyoArm::ReadMuscle(const Strands& strands, int muscle) {
  const mjModel* m = model_.get();
  MuscleParameters& sum = muscles_[static_cast<std::size_t>(muscle)];
  const std::size_t first = strands_.size();
  for (const char* name : strands.names) {
    const int id = IdOf(mjOBJ_ACTUATOR, name, "muscle");
    const mjtNum* parameters = m->actuator_gainprm + static_cast<std::ptrdiff_t>(id) * mjNGAIN;
    const mjtNum* lengths = m->actuator_lengthrange + 2 * static_cast<std::ptrdiff_t>(id);
    const double force = parameters[2], range = parameters[1] - parameters[0];
    const double fibre = (lengths[1] - lengths[0]) / range;
    if (m->actuator_trntype[id] != mjTRN_TENDON || !(force > 0) || !(fibre > 0) ||
        !std::isfinite(fibre))
      throw InputError(source_, "The muscle " + Quote(name) +
                                    " has no tendon, or no positive force and range of lengths.");
    strands_.push_back({m->actuator_trnid[2 * static_cast<std::ptrdiff_t>(id)], muscle, force});
    sum.max_force += force;
    sum.fibre_length += force * fibre;
    sum.tendon_slack += force * (lengths[0] - parameters[0] * fibre);
  }
  sum.fibre_length /= sum.max_force;
  sum.tendon_slack /= sum.max_force;
  for (std::size_t i = first; i < strands_.size(); ++i) strands_[i].share /= sum.max_force;
}

// Sets the joints beyond the wrist (fingers and thumb) to the middle of their ranges.
void MyoArm::SetGrip() {
  const mjModel* m = model_.get();
  rest_.assign(m->qpos0, m->qpos0 + m->nq);
  const int hand = m->jnt_bodyid[flexion_.id];
  for (int i = 0; i < m->njnt; ++i) {
    int body = m->body_parentid[m->jnt_bodyid[i]];
    while (body > 0 && body != hand) body = m->body_parentid[body];
    if (body == hand && m->jnt_limited[i] != 0)
      rest_[static_cast<std::size_t>(m->jnt_qposadr[i])] =
          (m->jnt_range[2 * i] + m->jnt_range[2 * i + 1]) / 2;
  }
}

// In MyoArm's posture of zero angles, the upper arm has the axes of the torso: x forward, y up, z
// to the right.
void MyoArm::SetFrames() {
  std::copy(rest_.begin(), rest_.end(), data_->qpos);
  mj_kinematics(model_.get(), data_.get());
  const int upper_arm = model_->jnt_bodyid[rotation_.id];
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data_->xmat +
                                                                         9 * upper_arm);
  R_WS_.col(0) = R.col(0);
  R_WS_.col(1) = -R.col(2);
  R_WS_.col(2) = R.col(1);
  R_shoulder_.col(2) = AxisOf(plane_);
  R_shoulder_.col(0) =
      (AxisOf(elevation_) - AxisOf(elevation_).dot(AxisOf(plane_)) * AxisOf(plane_)).normalized();
  R_shoulder_.col(1) = R_shoulder_.col(2).cross(R_shoulder_.col(0));
}

// Returns the angles of R = Rz Rx Rz in the axes of the shoulder. If the arm hangs, only the sum of
// plane and rotation is known, so the plane is set to 0.
ShoulderAngles MyoArm::ShoulderAt(const Matrix3& R) const noexcept {
  const Matrix3 S = R_shoulder_.transpose() * R * R_shoulder_;
  ShoulderAngles angles;
  const double side = std::hypot(S(0, 2), S(1, 2));
  angles.elevation = std::atan2(side, S(2, 2));
  constexpr double kHanging = 1e-9;
  if (side < kHanging) {
    angles.rotation = std::atan2(S(1, 0), S(0, 0));
    return angles;
  }
  angles.plane = std::atan2(S(0, 2), -S(1, 2));
  angles.rotation = std::atan2(S(2, 0), S(2, 1));
  return angles;
}

// `R_upper_arm` is the rotation of the upper arm from the zero posture, in the axes of the world.
void MyoArm::SetPosture(const ArmVector& q, const Matrix3& R_upper_arm) const noexcept {
  mjtNum* qpos = data_->qpos;
  std::copy(rest_.begin(), rest_.end(), qpos);
  const ShoulderAngles shoulder = ShoulderAt(R_upper_arm);
  qpos[plane_.q] = shoulder.plane;
  qpos[elevation_.q] = shoulder.elevation;
  // A coupled joint turns the upper arm back by the angle of the plane (see couplings_), so this
  // angle is added to the rotation.
  qpos[rotation_.q] = shoulder.rotation + shoulder.plane;
  const auto at = [&](ArmJoint joint) { return q[static_cast<int>(joint)]; };
  qpos[elbow_.q] = at(ArmJoint::kElbowFlexion);
  qpos[pronation_.q] = at(ArmJoint::kPronation);
  qpos[flexion_.q] = at(ArmJoint::kWristFlexion);
  qpos[deviation_.q] = -at(ArmJoint::kWristDeviation);
  for (const Coupling& coupling : couplings_)
    qpos[coupling.dependent.q] = coupling.ValueAt(qpos[coupling.independent.q]);
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_tendon(model_.get(), data_.get());
}

MuscleLines MyoArm::LinesAt(const ArmVector& q) const noexcept {
  constexpr int kShoulder = 3;
  constexpr auto kFirst = person::kRightArm;
  person::BodyVector all = person::BodyVector::Zero();
  all.segment<person::kArmJoints>(kFirst) = q;
  const person::Placement at = person::Place(body_, all);
  const Matrix3 R = R_WS_ * at.R[kFirst + kShoulder - 1] * R_WS_.transpose();
  SetPosture(q, R);

  // The shoulder turns about three axes, and its girdle follows the elevation. The slope of the
  // elevation is -e·(a × u)/sin(elevation), where a is the axis, e is the vertical and u is the
  // direction of the upper arm.
  const mjModel* m = model_.get();
  const Vector3 vertical = R_shoulder_.col(2), along = R * vertical;
  const double elevation = data_->qpos[elevation_.q], sine = std::sin(elevation);
  Matrix3 ball, axes;
  Vector3 slopes = Vector3::Zero();
  for (int k = 0; k < kShoulder; ++k) {
    ball.row(k) = AxisOf(ball_[static_cast<std::size_t>(k)]);
    axes.row(k) = R_WS_ * at.axis[static_cast<std::size_t>(kFirst + k)];
    if (sine > 1e-9) slopes[k] = -vertical.dot(axes.row(k).transpose().cross(along)) / sine;
  }
  const Matrix3 to_axes = axes * ball.inverse();
  std::array<double, kMaxDofs> arms;  // moment arms about MyoArm's own joints
  MuscleLines lines;
  lines.length.setZero();
  lines.moment_arm.setZero();
  for (const Strand& strand : strands_) {
    arms.fill(0);
    const int begin = m->ten_J_rowadr[strand.tendon];
    for (int n = begin; n < begin + m->ten_J_rownnz[strand.tendon]; ++n)
      arms[static_cast<std::size_t>(m->ten_J_colind[n])] = -data_->ten_J[n];
    const auto of = [&](const MyoJoint& joint) { return arms[static_cast<std::size_t>(joint.v)]; };
    double girdle = 0;
    for (const Coupling& coupling : couplings_)
      if (coupling.independent.id == elevation_.id)
        girdle += of(coupling.dependent) * coupling.SlopeAt(elevation);
    ArmVector R_eff;
    R_eff.head<kShoulder>() =
        to_axes * Vector3(of(ball_[0]), of(ball_[1]), of(ball_[2])) + girdle * slopes;
    R_eff.tail<4>() << of(elbow_), of(pronation_), of(flexion_), -of(deviation_);
    lines.length[strand.muscle] += strand.share * data_->ten_length[strand.tendon];
    lines.moment_arm.col(strand.muscle) += strand.share * R_eff;
  }
  return lines;
}

}  // namespace

std::shared_ptr<const ArmPaths> LoadMyoArm(const std::filesystem::path& model) {
  return std::make_shared<const MyoArm>(ReadMyoArm(model), model.string());
}

}  // namespace predictor::muscles
