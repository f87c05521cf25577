// A DART world, built from the scene that the run describes. The world keeps no state between calls
// except the scene, so equal requests have equal answers.
#pragma once

#include <Eigen/Core>
#include <dart/collision/CollisionResult.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/ShapeNode.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>
#include <vector>

#include "simulation/dart/protocol.h"

namespace predictor::dart_engine {

class DartWorld {
 public:
  explicit DartWorld(const SceneData& scene);

  // Each of these functions reads the state and the forces from `memory` and writes the answer
  // there.
  Result Prepare(Memory* memory);
  Result Accelerations(Memory* memory);
  Result Advance(Memory* memory);

 private:
  using VectorX = Eigen::VectorXd;
  using MatrixX = Eigen::MatrixXd;

  void AddCobot();
  void AddObject();
  void AddHands();
  void AddFreeObject(const dart::dynamics::BodyNode::Properties& body);
  void AddShapes();
  void AddSurroundings();
  dart::dynamics::BodyNode* Carrier(int joint) const;

  // Returns whether the last three coordinates belong to a ball joint.
  bool HasBall() const;
  void SetState(const StateData& state);
  void SetRemoved(std::uint64_t removed);
  void SetForces(const ForceData& forces);
  VectorX ToDart(const double* values) const;
  void FromDart(const VectorX& values, double* to) const;
  void ReadState(StateData* state) const;
  // Returns all forces except inertial ones: applied forces, damping, Coriolis and gravity.
  VectorX Forces(const ForceData& forces) const;
  void WriteMotion(const StateData& at, MotionData* motion) const;
  void WriteBody(const dart::dynamics::BodyNode& body, const Eigen::Vector3d& point,
                 BodyMotion* to) const;
  std::int32_t FixtureOf(const dart::collision::Contact& contact) const;
  bool WriteContacts(const dart::collision::CollisionResult& result, MotionData* motion) const;
  void WriteLoad(const VectorX& a, const ForceData& forces,
                 const std::vector<ContactData>& contacts, AccelerationData* to);

  const SceneData& scene_;
  dart::simulation::WorldPtr world_;
  dart::dynamics::SkeletonPtr cobot_, surroundings_;
  std::vector<dart::dynamics::BodyNode*> links_;
  dart::dynamics::BodyNode* object_ = nullptr;
  dart::dynamics::BodyNode* hands_[kHandCount] = {};
  std::vector<dart::dynamics::ShapeNode*> obstacles_;  // as in the scene
  std::uint64_t removed_ = 0;                          // fixtures
  std::vector<Eigen::Index> dof_;                      // DART's index of each of our coordinates
  VectorX damping_;                                    // in DART's order
};

}  // namespace predictor::dart_engine
