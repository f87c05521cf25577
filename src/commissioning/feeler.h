// The wrench of the hand at a station's handle, as a run would estimate it.
#pragma once

#include "commissioning/session.h"
#include "sensing/hand_estimator.h"

namespace predictor {

class Feeler {
 public:
  explicit Feeler(const Station& station);
  // Asks for hands off, and takes what is read then as none. Throws DeviceError: the sensor is
  // beyond its range.
  void Tare(Session* session);
  // Of the station's last reading. kSensor where that cannot be used; the wrench is zero then.
  Status Feel(HandWrench* hand) noexcept;

 private:
  const Station& station_;
  HandEstimator estimator_;
};

}  // namespace predictor
