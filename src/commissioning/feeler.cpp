#include "commissioning/feeler.h"

#include "commissioning/handle.h"

namespace predictor::commissioning {

Feeler::Feeler(const Station& station)
    : station_(station),
      estimator_(station.spec().arm.sensor, station.spec().arm.payload,
                 station.spec().arm.handle.ToPose(), Station::kGravity, Session::kStep) {}

void Feeler::Tare(Session* session) {
  for (;;) {
    session->Ask("Take your hands off the " + station_.name() + " handle, then press Enter.",
                 {kEnter});
    estimator_.BeginTare();
    for (int n = 0; n < PoseRecorder::kReadings;) {
      session->Step();
      if (!station_.fresh_wrench()) continue;
      ++n;
      if (!estimator_.Tare(station_.sample(), station_.EndEffectorPose()).ok())
        throw DeviceError("The " + station_.name() + " sensor is outside its range.");
    }
    if (estimator_.FinishTare().ok()) return;
    session->Show("The readings are not steady: someone or something touches the handle.");
  }
}

Status Feeler::Feel(HandWrench* hand) noexcept {
  FrameMotion E;
  E.X_W = station_.EndEffectorPose();
  return estimator_.Update(station_.sample(), E, hand);
}

}  // namespace predictor::commissioning
