// Elements and attributes of a URDF, read with errors that say file and line.
#pragma once

#include <tinyxml2.h>

#include <array>
#include <filesystem>
#include <limits>
#include <string>

#include "core/types.h"
#include "models/urdf.h"

namespace predictor {

using XmlElement = tinyxml2::XMLElement;

// Where a URDF comes from, for messages and for the meshes it names.
struct UrdfSource {
  std::string name;
  std::filesystem::path folder;
  std::filesystem::path scenario_folder = {};  // what may be read lies there; if empty, in `folder`

  std::string Place(const tinyxml2::XMLNode& at) const;  // "file:line"
  [[noreturn]] void Fail(const tinyxml2::XMLNode& at, const std::string& sentence) const;

  // Value of an attribute; refused if it is not there or empty.
  std::string Text(const XmlElement& element, const char* attribute) const;
  // A finite number of at most kLargest; `missing` if the attribute is not there, refused if NaN.
  double Number(const XmlElement& element, const char* attribute, double missing = kNone,
                double largest = kLargest) const;
  // Three or four such numbers.
  Vector3 Triple(const XmlElement& element, const char* attribute, const Vector3& missing) const;
  std::array<double, 4> Color(const XmlElement& element, const char* attribute) const;
  // Pose of the child <origin>, identity if there is none.
  Pose Origin(const XmlElement& element) const;
  // The only child of this name, or nullptr; refused if there are several.
  const XmlElement* Child(const XmlElement& element, const char* name) const;
  // The same, refused if there is none.
  const XmlElement& Required(const XmlElement& element, const char* name) const;

  static constexpr double kLargest = 1e6;  // any length, mass, ... of a robot, in SI units
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

// Parses; refuses document types, entities and malformed XML. `doc` owns the elements.
XmlElement* ParseXml(const std::string& text, const UrdfSource& source, tinyxml2::XMLDocument* doc);

// Mass, centre of mass and inertia of a link, checked. What the file's decimals rounded away is put
// back, in the XML too: the physics engine forgives no rounding.
void ReadInertial(const UrdfSource& source, XmlElement* link, UrdfLink* to);
// Shapes of a link; mesh paths are checked, and made absolute in the XML too.
void ReadShapes(const UrdfSource& source, const XmlElement& robot, XmlElement* link, UrdfLink* to);
// Type, pose, axis and limits of a joint; its name and links are known already.
void ReadJoint(const UrdfSource& source, const XmlElement& joint, UrdfJoint* to);

// Whether the principal moments A, B, C can be a rigid body's: none negative and A + B >= C, each
// up to rounding. Returns what is wrong as the end of a sentence, or "".
std::string WhatIsWrongWithInertia(const Matrix3& inertia);

}  // namespace predictor
