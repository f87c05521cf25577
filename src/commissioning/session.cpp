#include "commissioning/session.h"

#include "core/error.h"

namespace predictor {

bool HeldKey::Update(char key, double now) {
  if (key != 0 && key != key_) {
    repeats_ = false;
    since_ = -1e9;
  } else if (key == key_) {
    repeats_ = now - since_ < kFirstRepeat;
    since_ = now;
  }
  if (now - since_ > kSilence && repeats_) {
    repeats_ = false;
    since_ = -1e9;
  }
  return repeats_;
}

void Session::Step() { Step(nullptr, {}); }

void Session::Step(Station* moving, const JointVector& v) {
  network_->Wait(kStep);
  for (Station* station : stations_) {
    if (station == moving)
      station->Move(v);
    else
      station->Watch();
  }
  key_ = person_->Key();
  if (key_ == kGiveUp) throw InputError("Given up. Nothing was written.");
}

char Session::Ask(const std::string& prompt, const std::string& keys) {
  Tell(prompt);
  for (;;) {
    Step();
    if (key_ != 0 && keys.find(key_) != std::string::npos) return key_;
  }
}

}  // namespace predictor
