// Functions that the writers of URDF and SDF share.
#pragma once

#include <array>
#include <string>

#include "core/types.h"
#include "models/urdf_xml.h"

namespace predictor::scene_export {

inline XmlElement* Add(XmlElement* parent, const char* name) {
  return parent->InsertNewChildElement(name);
}
inline void Set(XmlElement* element, const char* attribute, const std::string& value) {
  element->SetAttribute(attribute, value.c_str());
}

// Returns numbers separated by spaces. Values that differ from zero only by a rounding error become
// 0.
std::string Text(double x);
std::string Text(const Vector3& x);
std::string Text(const std::array<double, 4>& x);

// Returns the roll, pitch and yaw [rad] of a rotation. Roll is computed last, from the rotation
// that remains after yaw. The three angles are therefore consistent even if the pitch is ±90°. At
// this pitch, roll and yaw are not unique.
Vector3 RollPitchYaw(const Matrix3& R);

}  // namespace predictor::scene_export
