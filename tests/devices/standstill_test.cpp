// What is advertised of arms whose program dies: one place, told as it is.
#include "devices/standstill.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/format.h"
#include "devices/ur/ur_arm.h"
#include "devices/ur/ur_script.h"

namespace predictor {
namespace {

TEST(Standstill, IsWhatTheScriptDoes) {
  for (const double cycle : {0.002, 0.008})
    EXPECT_LE(UrWatchdog(cycle), kUrStandstill.silence) << cycle;
  EXPECT_EQ(UrOptions().deceleration, kUrStandstill.deceleration);
}

TEST(Standstill, IsWhatTheDocumentsSay) {
  for (const auto& [name, make] :
       {std::pair{"connect-a-ur", ArmMake::kUr}, std::pair{"connect-a-franka", ArmMake::kFranka}}) {
    const Standstill& s = StandstillOf(make);
    std::ifstream in(std::string(PREDICTOR_SOURCE_DIR) + "/docs/" + name + ".md");
    std::stringstream text;
    text << in.rdbuf();
    const std::string says = Formatted(
        "%.0f ms + v / (%.0f rad/s²) + %.0f ms, v the speed of its fastest joint: %.2f s at 0.8 "
        "rad/s, %.2f s at 2.5 rad/s",
        1e3 * s.silence, s.deceleration, 1e3 * s.settling, s.Within(0.8), s.Within(2.5));
    EXPECT_NE(text.str().find(says), std::string::npos) << name << ": " << says;
  }
}

}  // namespace
}  // namespace predictor
