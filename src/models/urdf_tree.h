// Checks, sorts and prunes the tree of a URDF's links.
#pragma once

#include <string>
#include <vector>

#include "models/urdf.h"
#include "models/urdf_xml.h"

namespace predictor {

// The state of a URDF while it is being read, with the XML element of each link and joint.
struct UrdfDocument {
  UrdfModel model;
  std::vector<XmlElement*> links, joints;
};

// Refuses anything that is not a single tree. Sets the root and sorts the joints depth-first.
void SortTree(const UrdfSource& source, UrdfDocument* urdf);

// Removes the named links with all their descendants from the model and the XML. Throws InputError
// at the key "remove_links.<number>" for a name that cannot be removed.
void RemoveLinks(const std::vector<std::string>& names, XmlElement* robot, UrdfDocument* urdf);

}  // namespace predictor
