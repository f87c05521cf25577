// Replaces planar joints of a URDF by joints with one degree of freedom each.
#pragma once

#include "models/urdf_xml.h"

namespace predictor {

// Replaces each planar joint NAME by three joints with the links NAME_x_link and NAME_y_link
// between them. NAME_x and NAME_y are prismatic, lie in the plane and have the limits of NAME.
// NAME_yaw is continuous, turns about the plane's normal and has no limits. The links NAME_x_link
// and NAME_y_link have a mass of 1 mg, because a physics engine cannot move a body without mass.
// The normal is the joint's <axis>. The axis x is the joint frame's x axis, projected onto the
// plane (its y axis if x is nearly normal to the plane), and y completes the right-handed frame.
// Throws InputError for a joint without limits or axis, and if one of the names exists.
void SplitPlanarJoints(const UrdfSource& source, XmlElement* robot);

}  // namespace predictor
