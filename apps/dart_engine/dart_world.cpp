#include "dart_world.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/CollisionObject.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/CapsuleShape.hpp>
#include <dart/dynamics/CylinderShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/TranslationalJoint.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <limits>
#include <stdexcept>

#include "contact_detector.h"

namespace predictor::dart_engine {
namespace {

using dart::dynamics::BodyNode;
using dart::dynamics::Joint;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// If contacts and limits add less than this share of the largest acceleration, the addition counts
// as a rounding error.
constexpr double kRounding = 1e-9;
// DART takes the smaller friction of two shapes and the product of their restitutions. With
// infinite friction and a restitution of 1 for the object, the friction and restitution of the
// surroundings apply.
constexpr double kObjectFriction = std::numeric_limits<double>::infinity();
constexpr double kObjectRestitution = 1;

Vector3d At(const double* xyz) { return Eigen::Map<const Vector3d>(xyz); }
void Write(const Vector3d& from, double* to) { Eigen::Map<Vector3d>{to} = from; }

Eigen::Quaterniond QuaternionAt(const double* wxyz) { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
void Write(const Eigen::Quaterniond& q, double* wxyz) {
  wxyz[0] = q.w(), wxyz[1] = q.x(), wxyz[2] = q.y(), wxyz[3] = q.z();
}

Isometry3d IsometryOf(const FramePose& pose) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = QuaternionAt(pose.q).toRotationMatrix();
  X.translation() = At(pose.p);
  return X;
}

dart::dynamics::Inertia InertiaOf(const Inertia& from) {
  return {from.mass, At(from.com), Eigen::Map<const Matrix3d>(from.inertia)};
}

BodyNode::Properties BodyOf(const std::string& name, const Inertia& inertia) {
  return BodyNode::Properties(BodyNode::AspectProperties(name, InertiaOf(inertia)));
}

// Limits of a joint with one degree of freedom. An infinite limit has no effect.
void SetLimits(Joint* joint, double lower, double upper, double speed) {
  joint->setPositionLowerLimit(0, lower);
  joint->setPositionUpperLimit(0, upper);
  joint->setVelocityLowerLimit(0, -speed);
  joint->setVelocityUpperLimit(0, speed);
  joint->setLimitEnforcement(std::isfinite(lower) || std::isfinite(upper) || std::isfinite(speed));
}

dart::dynamics::ShapePtr ShapeOf(const CollisionShape& shape) {
  const double* size = shape.size;
  switch (shape.kind) {
    case ShapeKind::kBox:
      return std::make_shared<dart::dynamics::BoxShape>(At(size));
    case ShapeKind::kCylinder:
      return std::make_shared<dart::dynamics::CylinderShape>(size[0], size[1]);
    case ShapeKind::kSphere:
      return std::make_shared<dart::dynamics::SphereShape>(size[0]);
    case ShapeKind::kCapsule:
      return std::make_shared<dart::dynamics::CapsuleShape>(size[0], size[1]);
    case ShapeKind::kPlane:
      return std::make_shared<dart::dynamics::PlaneShape>(Vector3d::UnitZ(), 0.0);
  }
  throw std::runtime_error("unknown shape");
}

dart::dynamics::ShapeNode* AddShape(BodyNode* body, const CollisionShape& shape, double friction,
                                    double restitution) {
  auto* node =
      body->createShapeNodeWith<dart::dynamics::CollisionAspect, dart::dynamics::DynamicsAspect>(
          ShapeOf(shape));
  node->setRelativeTransform(IsometryOf(shape.at));
  node->getDynamicsAspect()->setFrictionCoeff(friction);
  node->getDynamicsAspect()->setRestitutionCoeff(restitution);
  return node;
}

template <class J>
J::Properties Properties(const std::string& name, const Isometry3d& parent,
                         const Isometry3d& child) {
  typename J::Properties properties;
  properties.mName = name;
  properties.mT_ParentBodyToJoint = parent;
  properties.mT_ChildBodyToJoint = child;
  return properties;
}

template <class J>
J::Properties WithAxis(typename J::Properties properties, const Vector3d& axis) {
  properties.mAxis = axis;
  return properties;
}

}  // namespace

DartWorld::DartWorld(const SceneData& scene)
    : scene_(scene), world_(dart::simulation::World::create()) {
  world_->setTimeStep(scene.step);
  world_->setGravity({0, 0, -scene.gravity});
  world_->getConstraintSolver()->setCollisionDetector(MakeContactDetector());
  cobot_ = dart::dynamics::Skeleton::create("cobot");
  AddCobot();
  AddObject();
  if (scene.has_hand_masses != 0) AddHands();
  AddShapes();
  AddSurroundings();
  world_->addSkeleton(surroundings_);
  world_->addSkeleton(cobot_);
  damping_.resize(static_cast<Eigen::Index>(cobot_->getNumDofs()));
  for (std::size_t i = 0; i < cobot_->getNumDofs(); ++i)
    damping_[static_cast<Eigen::Index>(i)] = cobot_->getDof(i)->getDampingCoefficient();
}

BodyNode* DartWorld::Carrier(int joint) const {
  return joint < 0 ? nullptr : links_[static_cast<std::size_t>(joint)];
}

void DartWorld::AddCobot() {
  const Isometry3d same = Isometry3d::Identity();
  for (int j = 0; j < scene_.joints; ++j) {
    const CobotJoint& from = scene_.joint[j];
    const std::string name = "joint" + std::to_string(j);
    const Isometry3d at = IsometryOf(from.at);
    const BodyNode::Properties body = BodyOf("link" + std::to_string(j), from.body);
    BodyNode* parent = Carrier(from.parent);
    using Slide = dart::dynamics::PrismaticJoint;
    using Turn = dart::dynamics::RevoluteJoint;
    Joint* joint = nullptr;
    if (from.prismatic != 0) {
      const auto made = cobot_->createJointAndBodyNodePair<Slide>(
          parent, WithAxis<Slide>(Properties<Slide>(name, at, same), At(from.axis)), body);
      joint = made.first;
      links_.push_back(made.second);
    } else {
      const auto made = cobot_->createJointAndBodyNodePair<Turn>(
          parent, WithAxis<Turn>(Properties<Turn>(name, at, same), At(from.axis)), body);
      joint = made.first;
      links_.push_back(made.second);
    }
    joint->setDampingCoefficient(0, from.damping);
    SetLimits(joint, from.lower, from.upper, from.speed);
  }
  for (const BodyNode* link : links_)
    dof_.push_back(static_cast<Eigen::Index>(link->getParentJoint()->getIndexInSkeleton(0)));
}

void DartWorld::AddObject() {
  Isometry3d pivot = Isometry3d::Identity();
  pivot.translation() = At(scene_.pivot);
  const Isometry3d at = IsometryOf(scene_.end_effector) * IsometryOf(scene_.object_at) * pivot;
  BodyNode* carrier = Carrier(scene_.carrier);
  const BodyNode::Properties body = BodyOf("object", scene_.object);
  if (scene_.attachment == Attachment::kFree) return AddFreeObject(body);
  using dart::dynamics::BallJoint;
  using dart::dynamics::PrismaticJoint;
  using dart::dynamics::RevoluteJoint;
  using dart::dynamics::WeldJoint;
  const std::string name = "attachment";
  const auto add = [&](const auto& made) {
    object_ = made.second;
    return made.first;
  };
  Joint* joint = nullptr;
  switch (scene_.attachment) {
    case Attachment::kWeld:
      joint = add(cobot_->createJointAndBodyNodePair<WeldJoint>(
          carrier, Properties<WeldJoint>(name, at, pivot), body));
      break;
    case Attachment::kBall:
      joint = add(cobot_->createJointAndBodyNodePair<BallJoint>(
          carrier, Properties<BallJoint>(name, at, pivot), body));
      break;
    case Attachment::kRevolute:
      joint = add(cobot_->createJointAndBodyNodePair<RevoluteJoint>(
          carrier,
          WithAxis<RevoluteJoint>(Properties<RevoluteJoint>(name, at, pivot), At(scene_.axis)),
          body));
      break;
    case Attachment::kPrismatic:
      joint = add(cobot_->createJointAndBodyNodePair<PrismaticJoint>(
          carrier,
          WithAxis<PrismaticJoint>(Properties<PrismaticJoint>(name, at, pivot), At(scene_.axis)),
          body));
      break;
    case Attachment::kFree:
      break;  // above
  }
  for (std::size_t i = 0; i < joint->getNumDofs(); ++i) {
    joint->setDampingCoefficient(i, scene_.damping);
    dof_.push_back(static_cast<Eigen::Index>(joint->getIndexInSkeleton(i)));
  }
  if (joint->getNumDofs() == 1)
    SetLimits(joint, scene_.lower, scene_.upper, std::numeric_limits<double>::infinity());
}

// DART's own free joint expresses velocities in the axes of the body, but the protocol does not.
// The object therefore has a sliding joint along the axes of W, whose body has no mass, and a ball
// joint.
void DartWorld::AddFreeObject(const BodyNode::Properties& body) {
  using dart::dynamics::BallJoint;
  using dart::dynamics::TranslationalJoint;
  const Isometry3d same = Isometry3d::Identity();
  const auto place = cobot_->createJointAndBodyNodePair<TranslationalJoint>(
      nullptr, Properties<TranslationalJoint>("place", same, same), BodyOf("place", Inertia{}));
  const auto turn = cobot_->createJointAndBodyNodePair<BallJoint>(
      place.second, Properties<BallJoint>("turn", same, same), body);
  object_ = turn.second;
  for (const Joint* joint : {static_cast<Joint*>(place.first), static_cast<Joint*>(turn.first)})
    for (std::size_t i = 0; i < 3; ++i)
      dof_.push_back(static_cast<Eigen::Index>(joint->getIndexInSkeleton(i)));
}

void DartWorld::AddHands() {
  using dart::dynamics::WeldJoint;
  for (int hand = 0; hand < kHandCount; ++hand) {
    Isometry3d at = Isometry3d::Identity();
    at.translation() = At(scene_.handle[hand]);
    const std::string name = "hand" + std::to_string(hand);
    hands_[hand] =
        cobot_
            ->createJointAndBodyNodePair<WeldJoint>(
                object_, Properties<WeldJoint>(name + "_weld", at, Isometry3d::Identity()),
                BodyOf(name, Inertia{}))
            .second;
    hands_[hand]->setGravityMode(false);
  }
}

void DartWorld::AddShapes() {
  for (int i = 0; i < scene_.shapes; ++i)
    AddShape(object_, scene_.shape[i], kObjectFriction, kObjectRestitution);
}

void DartWorld::AddSurroundings() {
  surroundings_ = dart::dynamics::Skeleton::create("surroundings");
  surroundings_->setMobile(false);
  BodyNode* body =
      surroundings_->createJointAndBodyNodePair<dart::dynamics::WeldJoint>(nullptr).second;
  for (int i = 0; i < scene_.obstacles; ++i) {
    const Obstacle& obstacle = scene_.obstacle[i];
    obstacles_.push_back(AddShape(body, obstacle.shape, obstacle.friction, obstacle.restitution));
  }
}

DartWorld::VectorX DartWorld::ToDart(const double* values) const {
  VectorX to(static_cast<Eigen::Index>(dof_.size()));
  for (std::size_t i = 0; i < dof_.size(); ++i) to[dof_[i]] = values[i];
  return to;
}

void DartWorld::FromDart(const VectorX& values, double* to) const {
  for (std::size_t i = 0; i < dof_.size(); ++i) to[i] = values[dof_[i]];
}

bool DartWorld::HasBall() const {
  return scene_.attachment == Attachment::kBall || scene_.attachment == Attachment::kFree;
}

void DartWorld::SetRemoved(std::uint64_t removed) {
  if (removed == removed_) return;
  removed_ = removed;
  for (int i = 0; i < scene_.obstacles; ++i) {
    const std::int32_t fixture = scene_.obstacle[i].fixture;
    if (fixture < 0) continue;
    obstacles_[static_cast<std::size_t>(i)]->getCollisionAspect()->setCollidable(
        (removed >> fixture & 1U) == 0);
  }
}

void DartWorld::SetState(const StateData& state) {
  SetRemoved(state.removed);
  for (int hand = 0; hand < kHandCount; ++hand) {
    if (hands_[hand] == nullptr) continue;
    const double mass = state.hand_mass[hand];
    if (hands_[hand]->getMass() == mass) continue;
    const double inertia = 0.4 * mass * scene_.hand_radius * scene_.hand_radius;
    hands_[hand]->setInertia(
        dart::dynamics::Inertia(mass, Vector3d::Zero(), inertia * Matrix3d::Identity()));
  }
  VectorX q(static_cast<Eigen::Index>(dof_.size()));
  for (std::size_t i = 0; i < dof_.size(); ++i) q[dof_[i]] = state.q[i];
  if (HasBall()) {
    const std::size_t ball = dof_.size() - 3;
    const Vector3d turn = dart::dynamics::BallJoint::convertToPositions(
        QuaternionAt(state.q + ball).toRotationMatrix());
    for (std::size_t i = 0; i < 3; ++i) q[dof_[ball + i]] = turn[static_cast<Eigen::Index>(i)];
  }
  cobot_->setPositions(q);
  cobot_->setVelocities(ToDart(state.v));
}

void DartWorld::ReadState(StateData* state) const {
  const VectorX q = cobot_->getPositions();
  FromDart(cobot_->getVelocities(), state->v);
  if (!HasBall()) return FromDart(q, state->q);
  const std::size_t ball = dof_.size() - 3;
  for (std::size_t i = 0; i < ball; ++i) state->q[i] = q[dof_[i]];
  Vector3d turn;
  for (std::size_t i = 0; i < 3; ++i) turn[static_cast<Eigen::Index>(i)] = q[dof_[ball + i]];
  const Eigen::Quaterniond rotation(dart::dynamics::BallJoint::convertToRotation(turn));
  Write(rotation.normalized(), state->q + ball);
}

void DartWorld::SetForces(const ForceData& forces) {
  cobot_->setForces(ToDart(forces.joint));
  object_->clearExternalForces();
  object_->addExtForce(At(forces.object), object_->getLocalCOM());
  object_->addExtTorque(At(forces.object + 3));
  for (int j = 0; j < scene_.joints; ++j)
    links_[static_cast<std::size_t>(j)]->getParentJoint()->setCoulombFriction(0, forces.coulomb[j]);
}

DartWorld::VectorX DartWorld::Forces(const ForceData& forces) const {
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> wrench(forces.object);
  const dart::math::Jacobian J =
      cobot_->getJacobian(object_, object_->getLocalCOM(), dart::dynamics::Frame::World());
  return ToDart(forces.joint) + J.bottomRows<3>().transpose() * wrench.head<3>() +
         J.topRows<3>().transpose() * wrench.tail<3>() -
         damping_.cwiseProduct(cobot_->getVelocities()) - cobot_->getCoriolisAndGravityForces();
}

void DartWorld::WriteBody(const BodyNode& body, const Vector3d& point, BodyMotion* to) const {
  const auto* world = dart::dynamics::Frame::World();
  Write(body.getLinearVelocity(point), to->twist);
  Write(body.getAngularVelocity(), to->twist + 3);
  const dart::math::Jacobian J = cobot_->getJacobian(&body, point, world);
  const dart::math::Jacobian rate = cobot_->getJacobianClassicDeriv(&body, point, world);
  for (std::size_t i = 0; i < dof_.size(); ++i) {
    for (int row = 0; row < 6; ++row) {
      const int from = (row + 3) % 6;  // DART gives the angular rows first
      const std::size_t at = static_cast<std::size_t>(row) * kMaxDof + i;
      to->jacobian[at] = J(from, dof_[i]);
      to->jacobian_rate[at] = rate(from, dof_[i]);
    }
  }
}

void DartWorld::WriteMotion(const StateData& at, MotionData* motion) const {
  motion->at = at;
  const Isometry3d X_CE = IsometryOf(scene_.end_effector);
  BodyMotion& E = motion->body[0];
  BodyMotion& O = motion->body[1];
  const BodyNode* carrier = Carrier(scene_.carrier);
  Isometry3d X_WE = X_CE;
  E = {};
  if (carrier != nullptr) {
    X_WE = carrier->getWorldTransform() * X_CE;
    WriteBody(*carrier, X_CE.translation(), &E);
  }
  Write(X_WE.translation(), E.pose.p);
  Write(Eigen::Quaterniond(X_WE.linear()).normalized(), E.pose.q);
  const Isometry3d& X_WO = object_->getWorldTransform();
  WriteBody(*object_, Vector3d::Zero(), &O);
  Write(X_WO.translation(), O.pose.p);
  Write(Eigen::Quaterniond(X_WO.linear()).normalized(), O.pose.q);
  Write(object_->getCOM(), motion->com);
  motion->kinetic_energy = cobot_->computeKineticEnergy();
  const MatrixX& M = cobot_->getMassMatrix();
  for (std::size_t i = 0; i < dof_.size(); ++i)
    for (std::size_t k = 0; k < dof_.size(); ++k)
      motion->mass_matrix[k * kMaxDof + i] = M(dof_[i], dof_[k]);
  FromDart(cobot_->getCoriolisAndGravityForces(), motion->bias);
}

std::int32_t DartWorld::FixtureOf(const dart::collision::Contact& contact) const {
  for (const auto* touching : {contact.collisionObject1, contact.collisionObject2})
    for (std::size_t i = 0; i < obstacles_.size(); ++i)
      if (touching->getShapeFrame() == obstacles_[i]) return scene_.obstacle[i].fixture;
  return -1;
}

bool DartWorld::WriteContacts(const dart::collision::CollisionResult& result,
                              MotionData* motion) const {
  motion->contacts = 0;
  if (result.getNumContacts() > kMaxContacts) return false;
  for (std::size_t i = 0; i < result.getNumContacts(); ++i) {
    const dart::collision::Contact& from = result.getContact(i);
    const auto* first = from.collisionObject1->getShapeFrame()->asShapeNode();
    // DART reports the normal and the force of a contact as they act on the first of the two
    // bodies.
    const double sign = first != nullptr && first->getBodyNodePtr().get() == object_ ? 1 : -1;
    ContactData& to = motion->contact[motion->contacts++];
    Write(from.point, to.p);
    Write(sign * from.normal, to.normal);
    Write(sign * from.force, to.force);
    to.depth = from.penetrationDepth;
    to.fixture = FixtureOf(from);
  }
  return true;
}

// Applies the Newton-Euler equations about the object's centre of mass, in the state before a step.
// The hands move with the object and have no weight.
void DartWorld::WriteLoad(const VectorX& a, const ForceData& forces,
                          const std::vector<ContactData>& contacts, AccelerationData* to) {
  FromDart(a, to->a);
  cobot_->setAccelerations(a);
  const Vector3d at = object_->getWorldTransform() * At(scene_.pivot);
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();  // of E on the load, about `at`
  const auto add = [&](const Vector3d& f, const Vector3d& t, const Vector3d& p) {
    force += f;
    torque += t + (p - at).cross(f);
  };
  const auto inertial = [&](const BodyNode& body, double gravity) {
    const double mass = body.getMass();
    const Matrix3d R = body.getWorldTransform().linear();
    const Matrix3d I = R * body.getInertia().getMoment() * R.transpose();
    const Vector3d w = body.getAngularVelocity();
    add(mass * (body.getCOMLinearAcceleration() + gravity * Vector3d::UnitZ()),
        I * body.getAngularAcceleration() + w.cross(I * w), body.getCOM());
  };
  inertial(*object_, scene_.gravity);
  for (const BodyNode* hand : hands_)
    if (hand != nullptr && hand->getMass() > 0) inertial(*hand, 0);
  add(-At(forces.object), -At(forces.object + 3), object_->getCOM());
  for (const ContactData& contact : contacts)
    add(-At(contact.force), Vector3d::Zero(), At(contact.p));
  Write(-force, to->load);
  Write(-torque, to->load + 3);
  Write(at, to->load_at);
}

Result DartWorld::Prepare(Memory* memory) {
  SetState(memory->state);
  WriteMotion(memory->state, &memory->motion);
  memory->motion.contacts = 0;
  if (scene_.shapes == 0) return Result::kDone;
  dart::collision::CollisionResult found;
  dart::collision::CollisionOption option;
  option.maxNumContacts = kMaxContacts + 1;
  option.collisionFilter = world_->getConstraintSolver()->getCollisionOption().collisionFilter;
  world_->getConstraintSolver()->getCollisionGroup()->collide(option, &found);
  return WriteContacts(found, &memory->motion) ? Result::kDone : Result::kTooManyContacts;
}

Result DartWorld::Accelerations(Memory* memory) {
  const Result result = Prepare(memory);
  if (result != Result::kDone) return result;
  const VectorX a = cobot_->getMassMatrix().ldlt().solve(Forces(memory->forces));
  WriteLoad(a, memory->forces, {}, &memory->acceleration);
  return Result::kDone;
}

Result DartWorld::Advance(Memory* memory) {
  SetState(memory->state);
  SetForces(memory->forces);
  const VectorX before = cobot_->getVelocities();
  const VectorX forces = Forces(memory->forces);
  MatrixX M = cobot_->getMassMatrix();
  const VectorX free = M.ldlt().solve(forces);
  M.diagonal() += scene_.step * damping_;  // DART integrates damping implicitly
  const VectorX step = M.ldlt().solve(forces);
  world_->step();
  const VectorX total = (cobot_->getVelocities() - before) / scene_.step;
  if (!total.allFinite() || !cobot_->getPositions().allFinite()) return Result::kNotFinite;
  StateData next = memory->state;
  ReadState(&next);
  if (!WriteContacts(world_->getLastCollisionResult(), &memory->motion))
    return Result::kTooManyContacts;
  // The part of the accelerations that is caused by contacts, limits and friction.
  VectorX reaction = total - step;
  if (reaction.lpNorm<Eigen::Infinity>() <= kRounding * (1 + total.lpNorm<Eigen::Infinity>()))
    reaction.setZero();
  SetState(memory->state);
  const MotionData& motion = memory->motion;
  WriteLoad(free + reaction, memory->forces, {motion.contact, motion.contact + motion.contacts},
            &memory->acceleration);
  SetState(next);
  memory->state = next;
  WriteMotion(next, &memory->motion);
  return Result::kDone;
}

}  // namespace predictor::dart_engine
