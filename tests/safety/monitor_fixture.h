// A monitor and the input of a tick without any fault.
#pragma once

#include <gtest/gtest.h>

#include "core/random.h"
#include "safety/monitor.h"

namespace predictor {

// A tick of two running arms without any fault. Each test introduces one fault.
class MonitorTest : public testing::Test {
 protected:
  MonitorTest() : monitor_(safety_, rendering_, {true, true}, 0.001), random_(1, "sensor") {
    input_.present = {true, true};
    input_.running = true;
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      ArmSample& arm = sample_.arms[hand];
      arm.present = true;
      arm.q = JointVector::Constant(7, 0.5);
      arm.v = JointVector::Constant(7, 0.1);
      arm.arm_age = arm.sensor_age = 0.001;
      input_.lower[hand] = JointVector::Constant(7, -2);
      input_.upper[hand] = JointVector::Constant(7, 2);
      input_.wrench[hand].present = true;
      input_.wrench[hand].F_H_W << 3, -4, 10, 0.1, 0.2, -0.1;
      render_.v[hand] = JointVector::Constant(7, 0.1);
    }
    render_.link_distance = 0.5;
    input_.sample = &sample_;
    input_.world = &world_;
    input_.render = &render_;
  }

  // Provides the samples of the next tick, which are fresh and noisy.
  void Refresh() {
    for (ArmSample& arm : sample_.arms) {
      ++arm.arm_sequence;
      ++arm.sensor_sequence;
      arm.F_S_raw[0] = 0.05 * random_.Normal();
    }
  }
  Status Check() {
    Refresh();
    return monitor_.Check(input_);
  }
  // Resets the monitor and passes it one tick. `change` modifies copies of the tick's inputs first.
  template <class Change>
  Status CheckChanged(const Change& change) {
    DeviceSample sample = sample_;
    WorldState world = world_;
    RenderResult render = render_;
    MonitorInput input = input_;
    input.sample = &sample;
    input.world = &world;
    input.render = &render;
    change(&input, &sample, &world, &render);
    monitor_.Reset();
    return monitor_.Check(input);
  }
  // Resets the monitor and passes it one tick without a fault.
  Status CheckAfterReset() {
    monitor_.Reset();
    return Check();
  }

  SafetySpec safety_;
  RenderingSpec rendering_;
  DeviceSample sample_;
  WorldState world_;
  RenderResult render_;
  MonitorInput input_;
  Monitor monitor_;
  RandomStream random_;
};

inline void ExpectStatus(const Status& status, StopCause cause, int hand, double value,
                         double limit) {
  EXPECT_EQ(status.cause, cause) << Name(status.cause) << ", not " << Name(cause);
  EXPECT_EQ(status.hand, hand);
  EXPECT_NEAR(status.value, value, 1e-9);
  EXPECT_DOUBLE_EQ(status.limit, limit);
}

}  // namespace predictor
