// Estimates the wrench of the hand at a station's handle in the same way as a run.
#pragma once

#include "commissioning/session.h"
#include "sensing/hand_estimator.h"

namespace predictor::commissioning {

class Feeler {
 public:
  explicit Feeler(const Station& station);
  // Asks the person to take the hands off, and tares the sensor. Throws DeviceError if the sensor
  // is beyond its range.
  void Tare(Session* session);
  // Estimates the wrench from the station's last reading. If this reading cannot be used, returns
  // kSensor and a wrench of zero.
  Status Feel(HandWrench* hand) noexcept;

 private:
  const Station& station_;
  HandEstimator estimator_;
};

}  // namespace predictor::commissioning
