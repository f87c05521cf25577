// Tests commissioning with the real drivers, which exchange bytes with fakes on a rig in virtual
// time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>

#include "commissioning/calibrate.h"
#include "commissioning/rig_station.h"
#include "core/error.h"
#include "devices/connect.h"
#include "devices/standstill.h"
#include "fakes/far_rig.h"
#include "fakes/kinds.h"
#include "fakes/memory_network.h"
#include "scenario/scenario_io.h"

namespace predictor::commissioning {
namespace {

struct Make {
  const char* name;
  const char* fake;
  const char* scenario;
  double rate;  // [Hz]
};

std::ostream& operator<<(std::ostream& out, const Make& make) { return out << make.name; }

// The left arm of a scenario: a real driver that is connected to a fake.
class OverDrivers : public testing::TestWithParam<Make> {
 protected:
  OverDrivers() {
    const std::string file =
        std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + GetParam().scenario + ".yaml";
    const Scenario scenario = LoadScenario(file);
    rig_ = std::make_unique<FarRig>(scenario);
    network_.SetWorld([this] { rig_->Step(); });
    fake_ = MakeFake(GetParam().fake, {});
    network_.Add("192.0.2.10", fake_.get(), rig_->Hang(0));
    spec_.connection.make =
        std::string(GetParam().fake) == "franka" ? ArmMake::kFranka : ArmMake::kUr;
    spec_.connection.host = "192.0.2.10";
    spec_.arm = scenario.arm(0);
    spec_.arm.sample_rate = GetParam().rate;
    station_ =
        std::make_unique<Station>(0, spec_, ConnectArm(spec_, ArmUse::kMove, &network_), nullptr);
  }
  // The person sends a letter every 30 ms, or Enter if the prompt is to take the hands off the
  // handle.
  char Held(const std::string& last) {
    if (last.find("then press Enter") != std::string::npos) return kEnter;
    return ++steps_ % 30 == 0 ? kSwingKey : static_cast<char>(0);
  }
  // Returns the speed of the true handle [m/s].
  double Speed() const { return rig_->rig().true_handles()[0].V_W.head<3>().norm(); }

  MemoryNetwork network_;
  std::unique_ptr<FarRig> rig_;
  std::unique_ptr<FakeDevice> fake_;
  MachineArm spec_;
  std::unique_ptr<Station> station_;
  int steps_ = 0;
};

TEST_P(OverDrivers, GivingUpInMotionLeavesTheArmAtRest) {
  int moving = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    moving += Speed() > 0.005;
    if (moving > 300) throw InputError("Ended on request.");
    return Held(last);
  });
  Session session(&network_, &person, {station_.get()});
  EXPECT_THROW(SwingAll(&session, station_.get(), {}), InputError);
  EXPECT_LT(Speed(), 5e-4);
  EXPECT_NE(person.All().find("The left arm was brought to rest within"), std::string::npos)
      << person.All();
  rig_->Mark();
  // Neither a time-out of the arm nor a reflex has stopped the arm, so it still accepts commands.
  const JointVector rest = JointVector::Zero(station_->model().dof());
  ASSERT_NO_THROW({
    for (int k = 0; k < 300; ++k) {
      network_.Wait(Session::kStep);
      station_->Sense();
      station_->Move(rest);
    }
  });
  EXPECT_LT(rig_->motion().distance, 1e-3);
}

TEST_P(OverDrivers, IfTheProgramHangsTheArmBrakesByItselfAndAMessageIsShown) {
  int moving = 0;
  ScriptedPerson person([&](const std::string& last) -> char {
    moving += Speed() > 0.005;
    if (moving == 300) {
      ++moving;
      rig_->Mark();
      network_.Pass(0.6);
    }
    return Held(last);
  });
  Session session(&network_, &person, {station_.get()});
  EXPECT_THROW(SwingAll(&session, station_.get(), {}), DeviceError);
  EXPECT_LT(Speed(), 5e-4);
  const FarRig::Motion& motion = rig_->motion();
  EXPECT_LT(motion.rest_after, StandstillOf(spec_.connection.make).Within(motion.joint));
  EXPECT_NE(person.All().find("no longer accepts commands"), std::string::npos) << person.All();
}

INSTANTIATE_TEST_SUITE_P(Of, OverDrivers,
                         testing::Values(Make{"UR", "ur", "dual_ur5", 500},
                                         Make{"Franka", "franka", "box_9kg", 1000}),
                         [](const testing::TestParamInfo<Make>& make) {
                           return std::string(make.param.name);
                         });

}  // namespace
}  // namespace predictor::commissioning
