// Measures the velocity loop on a machine with an enabling device.
#include <gtest/gtest.h>

#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "commissioning/rig_bench.h"
#include "core/words.h"

namespace predictor::commissioning {
namespace {

class MeasureLoopWithADevice : public testing::Test {
 protected:
  static constexpr int kInput = 3;
  MeasureLoopWithADevice() { options_.enabling = {&bench_.station, kInput}; }
  void Press(bool pressed) { bench_.hand.inputs = pressed ? 1U << kInput : 0; }
  bool Moves() const { return bench_.hand.sample().v.cwiseAbs().maxCoeff() > 0.03; }
  // In each step, calls `act` with the time since the prompt for the first joint [s]. `act` returns
  // a key.
  std::string Swing(const std::function<char(double)>& act) {
    double since = -1;
    person_ = std::make_unique<ScriptedPerson>([this, since, act](const std::string& last) mutable {
      if (last.find("then press Enter") != std::string::npos) return kEnter;
      if (last.find("Joint 1 of") != std::string::npos && since < 0) since = 0;
      if (since < 0) return char{0};
      since += Session::kStep;
      return act(since);
    });
    Session session(&bench_.time, person_.get(), {&bench_.station});
    try {
      SwingAll(&session, &bench_.station, options_);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  Bench bench_;
  SwingOptions options_ = Short();
  std::unique_ptr<ScriptedPerson> person_;
};

TEST_F(MeasureLoopWithADevice, MovesWhileItIsHeldOnceTheKeyWasTouched) {
  bool moved = false;
  Swing([&](double t) -> char {
    Press(t > 0.2 && t < 2.5);
    if (std::abs(t - 0.3) < 0.5 * Session::kStep) return kSwingKey;
    if (t > 0.9 && t < 2.5) moved = moved || Moves();
    EXPECT_FALSE(t > 2.5 + 0.2 && Moves()) << t;
    if (t > 4) return kGiveUp;
    return 0;
  });
  EXPECT_TRUE(moved);
  EXPECT_NE(person_->All().find(HowToHold('s', true)), std::string::npos);
  EXPECT_NE(person_->All().find("pressed another key. This joint will be measured again"),
            std::string::npos);
}

TEST_F(MeasureLoopWithADevice, AHeldKeyIsNotEnough) {
  Swing([&](double t) -> char {
    EXPECT_FALSE(Moves());
    if (t > 3) return kGiveUp;
    return std::fmod(t, 0.03) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_NE(person_->All().find("Not accepted yet: " + HowToHold('s', true) + "."),
            std::string::npos)
      << person_->All();
}

TEST_F(MeasureLoopWithADevice, TheDeviceAloneIsNotEnough) {
  Swing([&](double t) -> char {
    Press(t > 0.2);
    EXPECT_FALSE(Moves());
    return t > 3 ? kGiveUp : char{0};
  });
}

TEST_F(MeasureLoopWithADevice, ADeviceThatIsTapedDownDoesNotCount) {
  Press(true);
  Swing([&](double t) -> char {
    EXPECT_FALSE(Moves());
    if (t > 3) return kGiveUp;
    return std::fmod(t, 0.9) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_NE(person_->All().find("release the enabling device, hold it again and tap s."),
            std::string::npos)
      << person_->All();
}

TEST_F(MeasureLoopWithADevice, AnyOtherKeyStopsUntilItIsReleased) {
  bool moved = false;
  Swing([&](double t) -> char {
    Press(t > 0.2);
    if (t > 0.3 && t < 2) moved = moved || Moves();
    EXPECT_FALSE(t > 2.2 && Moves()) << t;
    if (t > 4) return kGiveUp;
    if (t > 2 && t < 2 + 1.5 * Session::kStep) return 'x';
    return std::fmod(t, 0.9) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_TRUE(moved);
}

// Letters typed while the connection was stalled do not count as a touch of the key. A jammed key
// also does not count as a touch of the key.
TEST_F(MeasureLoopWithADevice, BufferedLettersAreNotATouch) {
  Swing([&](double t) -> char {
    Press(t > 0.2);
    EXPECT_FALSE(Moves()) << t;
    if (t > 3) return kGiveUp;
    return t > 1.5 && t < 1.505 ? kSwingKey : char{0};
  });
}

TEST_F(MeasureLoopWithADevice, AJammedKeyIsNotATouch) {
  Swing([&](double t) -> char {
    Press(t > 0.5);
    EXPECT_FALSE(Moves()) << t;
    if (t > 3) return kGiveUp;
    return std::fmod(t, 0.03) < Session::kStep ? kSwingKey : char{0};
  });
  EXPECT_NE(person_->All().find("release s for a second, then tap it"), std::string::npos)
      << person_->All();
}

}  // namespace
}  // namespace predictor::commissioning
