// Replaces planar joints of a URDF by joints with one degree of freedom each.
#pragma once

#include "models/urdf_xml.h"

namespace predictor {

// Replaces each planar joint NAME by three joints in its place: NAME_x and NAME_y (prismatic, in
// the plane, with the limits of NAME) and NAME_yaw (continuous, about the plane's normal, without
// limits), with the links NAME_x_link and NAME_y_link between them. Those have a mass of 1 mg,
// because an engine does not move a body without mass. The normal is the joint's <axis>. x is the
// joint frame's x axis, projected onto the plane (its y axis if x is nearly normal to the plane),
// and y completes the right-handed frame. Throws InputError for a joint without limits or axis, and
// if one of the names exists.
void SplitPlanarJoints(const UrdfSource& source, XmlElement* robot);

}  // namespace predictor
