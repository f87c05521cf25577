// The field tables of a scenario's `environment` (see fields.h).
#pragma once

#include "scenario/field_rules.h"
#include "scenario/scenario.h"

namespace predictor {

inline constexpr std::size_t kMaxFixtures = 64;  // each is a bit of the absent fixtures

template <class V>
void Fields(V& v, TableSpec& s) {
  v("size", s.size, Number("m", "length, width, thickness", Above(0, 100)));
  v("top", s.top, Number("m", "centre of the top face, in W", Within(100)));
}

template <class V>
void Fields(V& v, FixtureSpec& s) {
  v("shape", s.shape, Required(Word("its form")));
  v("size", s.size,
    Number("m",
           "box: x, y, z; cylinder, capsule: radius, length, 0; sphere: radius, 0, 0; plane: x and "
           "y as drawn, 0",
           From(0, 100)));
  PoseFields(v, s);
  v("friction", s.friction,
    Number("", "sliding friction of its contacts; null: environment.friction", From(0, 10)));
  v("time_constant", s.time_constant,
    Number("s", "time constant of its contacts; a smaller value is stiffer", From(0.002, 1)));
  v("damping_ratio", s.damping_ratio,
    Number("", "damping ratio of its contacts; 1: no bounce", From(0.01, 10)));
  v("stiffness", s.stiffness,
    Number("N/m",
           "stiffness of each point of contact, instead of time_constant and damping_ratio; null: "
           "as stiff as time_constant says",
           From(1, 1e7)));
  v("damping", s.damping,
    Number("N·s/m", "damping of each point of contact, with a stiffness", From(0, 1e5)));
  v("touches", s.touches, List(Word("what collides with it", {"object", "cobot"}), 1, 2));
  v("keep_out", s.keep_out,
    Flag("a volume that the cobot must not enter, and that nothing else touches"));
  v("color", s.color, Number("", "red, green, blue", From(0, 1)));
  v("name", s.name, Word("name by which events refer to it"));
}

template <class V>
void Fields(V& v, MovableSpec& s) {
  v("name", s.name, Required(Word("name by which events and messages refer to it")));
  v("model", s.model, Word("URDF: package://..., or relative to this file; empty: the primitive"));
  v("primitive", s.primitive, Part("a simple body, instead of a model"));
  PoseFields(v, s);
  v("friction", s.friction,
    Number("",
           "sliding friction of its contacts; if the other body has one too, the lower one; null: "
           "that of the other body or environment.friction",
           From(0, 10)));
  v("touches", s.touches,
    List(Word("what else collides with it, apart from floor, table, fixtures and other objects",
              {"object", "cobot"}),
         1, 2));
  v("color", s.color, Number("", "red, green, blue of a primitive", From(0, 1)));
}

template <class V>
void Fields(V& v, EnvironmentSpec& s) {
  v("gravity", s.gravity, Number("m/s²", "gravitational acceleration, along -z of W", From(0, 30)));
  v("floor", s.floor, Flag("a floor with contact at z = 0"));
  v("table", s.table, Part("a table with contact; null: none"));
  v("fixtures", s.fixtures,
    List(Part("bodies that never move and that others can touch"), 0, kMaxFixtures));
  v("objects", s.objects,
    List(Part("movable objects: bodies that nothing holds at the start and that others push"), 0,
         kMaxMovables));
  v("friction", s.friction, Number("", "coefficient of sliding friction in contacts", From(0, 10)));
  v("shift", s.shift,
    Part("pose of W in the frame of the arms' bases: moved, and turned about the vertical; "
         "null: the same frame"));
}

}  // namespace predictor
