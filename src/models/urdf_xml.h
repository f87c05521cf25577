// Reads elements and attributes of a URDF. Errors contain file and line.
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

// The source of a URDF, for messages and for the meshes to which the URDF refers.
struct UrdfSource {
  std::string name;
  std::filesystem::path folder;
  // Folder of the scenario. Meshes must be in a place that this scenario may read. If this folder
  // is empty, `folder` is used.
  std::filesystem::path scenario_folder = {};

  std::string Place(const tinyxml2::XMLNode& at) const;  // "file:line"
  [[noreturn]] void Fail(const tinyxml2::XMLNode& at, const std::string& sentence) const;

  // Returns the value of an attribute. Throws if the attribute is missing or empty.
  std::string Text(const XmlElement& element, const char* attribute) const;
  // Returns a finite number whose magnitude is at most `largest`. If the attribute is missing,
  // returns `missing`, or throws if `missing` is NaN.
  double Number(const XmlElement& element, const char* attribute, double missing = kNone,
                double largest = kLargest) const;
  // Reads three or four finite numbers.
  Vector3 Triple(const XmlElement& element, const char* attribute, const Vector3& missing) const;
  std::array<double, 4> Color(const XmlElement& element, const char* attribute) const;
  // Returns the pose of the child <origin>, or the identity without one.
  Pose Origin(const XmlElement& element) const;
  // Returns the only child of this name, or nullptr if there is no such child. Throws if there are
  // several.
  const XmlElement* Child(const XmlElement& element, const char* name) const;
  // Returns the only child of this name. Throws if there is no such child or if there are several.
  const XmlElement& Required(const XmlElement& element, const char* name) const;

  static constexpr double kLargest = 1e6;  // larger than any length, mass, ... of a robot, in SI
                                           // units
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

// Parses the text. Refuses document types, entities and malformed XML. `doc` owns the elements.
XmlElement* ParseXml(const std::string& text, const UrdfSource& source, tinyxml2::XMLDocument* doc);

// Reads and checks mass, centre of mass and inertia of a link. Errors from the file's rounded
// decimals are corrected, also in the XML, because the physics engine does not tolerate them.
void ReadInertial(const UrdfSource& source, XmlElement* link, UrdfLink* to);
// Reads the shapes of a link. Mesh paths are checked and made absolute, also in the XML.
void ReadShapes(const UrdfSource& source, const XmlElement& robot, XmlElement* link, UrdfLink* to);
// Reads type, pose, axis and limits of a joint. The joint's name and links are already known.
void ReadJoint(const UrdfSource& source, const XmlElement& joint, UrdfJoint* to);

// Checks whether principal moments A, B, C are possible for a rigid body: none is negative and A +
// B >= C, each up to rounding. Returns the error as the end of a sentence, or "".
std::string WhatIsWrongWithInertia(const Matrix3& inertia);

}  // namespace predictor
