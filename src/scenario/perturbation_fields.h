// The field table of a scenario's `perturbation`; see fields.h.
#pragma once

#include "scenario/field_rules.h"
#include "scenario/scenario.h"

namespace predictor {

template <class V>
void Fields(V& v, PerturbationSpec& s) {
  v("consent", s.consent,
    Required(Flag("the person knows that the handles will move by themselves, and agrees")));
  v("amplitude", s.amplitude, Number("m", "amplitude of a displacement", From(0.001, 0.008)));
  v("normal", s.normal, Number("", "normal of the plane of the displacements, in W", Within(1000)));
  v("directions", s.directions,
    Number("", "number of directions, evenly distributed in the plane", From(4, 16)));
  v("ramp", s.ramp, Number("s", "duration of moving out, and of moving back", From(0.12, 0.15)));
  v("hold", s.hold, Number("s", "time between moving out and moving back", From(0.1, 1)));
  v("after", s.after, Number("s", "simulated time before the first displacement", From(0, 86400)));
  v("pause", s.pause, Number("s", "shortest time between two displacements", From(0.3, 60)));
  v("window", s.window,
    Number("s", "a random share of this time is added to pause", From(0.3, 60)));
  v("speed", s.speed,
    Number("m/s", "speed of the virtual handles above which no displacement begins",
           Above(0, 0.1)));
  v("force", s.force,
    Number("N",
           "force of a hand beyond which a displacement is taken back; none begins if a larger "
           "force is expected",
           Above(0, 15)));
  v("margin", s.margin, Number("", "minimum stability margin of the run", From(1.5, 8)));
}

}  // namespace predictor
