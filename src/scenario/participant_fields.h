// The field tables of a participant (see fields.h).
#pragma once

#include "scenario/operator_fields.h"
#include "scenario/participant.h"

namespace predictor {

template <class V>
void Fields(V& v, ConsentSpec& s) {
  v("version", s.version, Required(Word("version of the consent text")));
  v("date", s.date, Required(Word("day on which the person signed it: YYYY-MM-DD")));
}

template <class V>
void Fields(V& v, ParticipantSpec& s) {
  v("pseudonym", s.pseudonym, Required(Word("pseudonym from `predictor pseudonym`; never a name")));
  v("consent", s.consent, Required(Part("what the person agreed to")));
  v("handedness", s.handedness,
    Word("the hand that the person prefers", {"unknown", "left", "right", "ambidextrous"}));
}

template <class V>
void Fields(V& v, ParticipantFile& s) {
  Fields(v, static_cast<ParticipantSpec&>(s));
  v("body", s.body, Part("height, mass and sex; null: as the scenario says"));
}

}  // namespace predictor
