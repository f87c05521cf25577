// In haptic rendering, a QP computes joint velocities that make the real handles follow the virtual
// handles.
//
// The priorities, beginning with the highest, are: joint position and velocity limits (hard); joint
// acceleration; link pairs; relative pose of the handles; tracking. The weight of each level is
// much larger than the weight of the next level. Within numerical precision, the higher level
// therefore does not yield. The amount by which a level yields is published as slack. The paper's
// formulation (scenario/formulation.h) has no slacks.
#pragma once

#include <array>
#include <memory>

#include "core/archive.h"
#include "core/messages.h"
#include "haptics/render_arm.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

class Assembler;
class Qp;

class Renderer {
 public:
  // Each of the `models` has a handle frame. The entries of absent sides are null. `lead` is the
  // lead of the scenario [s]. The setting `auto` must have been replaced by its value. `dt` is the
  // duration of a tick [s]. Throws InputError if a link of a pair is unknown or if there are too
  // many pairs.
  Renderer(const Scenario& scenario,
           const std::array<std::shared_ptr<const RobotModel>, kHands>& models, double lead,
           double dt);
  ~Renderer();

  // Computes joint velocities for this tick. `last` is the command that was sent last. Returns kQp
  // after three consecutive ticks without a verified solution. Returns kTracking if the slack of
  // the relative pose has exceeded its limit for longer than the safety settings allow. Does not
  // use the heap or a lock, and does not throw.
  Status Render(const std::array<RenderArm, kHands>& arms, const RenderTarget& target,
                const std::array<JointVector, kHands>& last, RenderResult* result) noexcept;
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // Returns the problem of the last Render, for benchmarks and tests.
  const Qp& qp() const;
  const Assembler& assembler() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
