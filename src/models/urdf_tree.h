// Checks, sorts and prunes the tree of a URDF's links.
#pragma once

#include <string>
#include <vector>

#include "models/urdf.h"
#include "models/urdf_xml.h"

namespace predictor {

// A URDF while it is being read: each link and joint with its XML element.
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
