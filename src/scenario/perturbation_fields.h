// The field table of a scenario's `perturbation`; see fields.h.
#pragma once

#include "scenario/field_rules.h"
#include "scenario/scenario.h"

namespace predictor {

template <class V>
void Fields(V& v, PerturbationSpec& s) {
  v("consent", s.consent,
    Required(Flag("the person knows that the handles will move by themselves, and agrees")));
  v("amplitude", s.amplitude, Number("m", "of a displacement", From(0.001, 0.008)));
  v("normal", s.normal, Number("", "of the plane of the displacements, in W", Within(1000)));
  v("directions", s.directions, Number("", "evenly distributed in the plane", From(4, 16)));
  v("ramp", s.ramp, Number("s", "of moving out, and of moving back", From(0.12, 0.15)));
  v("hold", s.hold, Number("s", "between moving out and back", From(0.1, 1)));
  v("after", s.after, Number("s", "simulated time before the first displacement", From(0, 86400)));
  v("pause", s.pause, Number("s", "shortest time between two displacements", From(0.3, 60)));
  v("window", s.window, Number("s", "added to pause, a random share of it", From(0.3, 60)));
  v("speed", s.speed,
    Number("m/s", "of the virtual handles, above which none begins", Above(0, 0.1)));
  v("force", s.force,
    Number("N",
           "of a hand, beyond which a displacement is taken back; none "
           "begins if it is expected",
           Above(0, 15)));
  v("margin", s.margin, Number("", "stability margin that the run must have", From(1.5, 8)));
}

}  // namespace predictor
