#include "core/held_key.h"

namespace predictor {

KeySign HeldKey::Update(char key, double now) {
  if (key != 0 && key != key_) LetGo();
  if (held() && now - sign_ > kSilence) LetGo();
  const KeySign settled = Settle(now);
  const KeySign sign = key == key_ ? Take(now) : KeySign::kNone;
  if (settled != KeySign::kNone) return settled;
  if (sign != KeySign::kNone || !open_ || now - last_ <= kFirstRepeat) return sign;
  LetGo();
  return late_ ? KeySign::kLate : KeySign::kNotHeld;
}

// Decides whether the last letter counts. This requires kTogether without another letter. The
// letter is no longer reported if more than kSilence has passed since it arrived.
KeySign HeldKey::Settle(double now) {
  if (!waits_ || now - last_ < kTogether) return KeySign::kNone;
  waits_ = false;
  if (now - last_ > kSilence) return KeySign::kNone;
  ++letters_;
  if (!held()) return fresh_ ? KeySign::kTouched : KeySign::kNone;
  open_ = false;
  sign_ = last_;
  return KeySign::kHeld;
}

KeySign HeldKey::Take(double now) {
  const bool together = now - last_ < kTogether;
  fresh_ = now - last_ > kFirstRepeat;
  last_ = now;
  if (held()) {
    if (together) return KeySign::kNone;
    sign_ = now;
    return KeySign::kContinues;
  }
  if (together || fresh_) letters_ = 0;
  waits_ = !together;
  open_ = true;
  late_ = together;
  return KeySign::kNone;
}

}  // namespace predictor
