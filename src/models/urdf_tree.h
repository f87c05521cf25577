// The tree of a URDF's links: checked, sorted, cut.
#pragma once

#include <string>
#include <vector>

#include "models/urdf.h"
#include "models/urdf_xml.h"

namespace predictor {

// A URDF while it is read: each link and joint beside its element.
struct UrdfDocument {
  UrdfModel model;
  std::vector<XmlElement*> links, joints;
};

// Refuses anything but one tree; sets the root and sorts the joints depth-first.
void SortTree(const UrdfSource& source, UrdfDocument* urdf);

// Cuts off the links named, with all that hangs on them, from the model and from the XML. Throws
// InputError at the key "remove_links.<number>" of a name that cannot be cut.
void RemoveLinks(const std::vector<std::string>& names, XmlElement* robot, UrdfDocument* urdf);

}  // namespace predictor
