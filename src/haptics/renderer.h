// Haptic rendering: joint velocities that make the real handles follow the virtual ones, by a QP.
//
// Priorities, highest first: joint position and velocity limits (hard); joint acceleration; link
// pairs; relative pose of the handles; tracking. Each level outweighs the next so far that it does
// not yield to it within the numbers' digits; what a level yields is published as slack.
#pragma once

#include <array>
#include <memory>

#include "core/archive.h"
#include "core/messages.h"
#include "haptics/render_arm.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

class Qp;

class Renderer {
 public:
  // `models`: with a handle frame each, absent sides null. lead [s] resolved from the scenario's
  // `auto`. dt: tick [s]. Throws InputError (link pair of an unknown link, too many pairs).
  Renderer(const Scenario& scenario,
           const std::array<std::shared_ptr<const RobotModel>, kHands>& models, double lead,
           double dt);
  ~Renderer();

  // Joint velocities for this tick. `last`: the command last sent. kQp after three ticks in a row
  // without a verified solution, kTracking when the relative slack has been above its limit for
  // longer than safety allows. No heap, lock or exception.
  Status Render(const std::array<RenderArm, kHands>& arms, const RenderTarget& target,
                const std::array<JointVector, kHands>& last, RenderResult* result) noexcept;
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // The problem of the last Render, for benchmarks and tests.
  const Qp& qp() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
