// Limits of force and pressure on the body in an *unintended* contact with a robot, after the model
// of ISO/TS 15066. Such a contact occurs, for example, if a person lets go and is hit, if a person
// is clamped against a fixture, or if the cobot moves unexpectedly.
//
// These limits never judge the forces at a handle, because holding a handle is intended contact
// (hand guiding). The limits also do not prove conformity, because a real application must be
// measured (ISO/PAS 5672).
//
// The limits come from a file that the user provides. This file names the edition of the
// specification. The formulas of the model (spring and two masses) are verified.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor::ergonomics {

// One point of the body.
struct ContactLimit {
  std::string region;           // "hand/finger"
  std::string point;            // "palm"
  double force = 0;             // [N] quasi-static, of the region
  double pressure = 0;          // [Pa] quasi-static, of the point
  double transient_factor = 0;  // transient limit / quasi-static limit; 0: must not be hit
  double stiffness = 0;         // [N/m] of the region
  double mass = 0;              // [kg] effective, of the region
};

struct ContactLimits {
  std::string edition;  // edition of the limits, as given in the file
  std::vector<ContactLimit> points;
};

// Reads a file of this form (CSV; lines that begin with # and empty lines are ignored):
//
//   edition,ISO/TS 15066:2016 Annex A
//   region,point,force_N,pressure_N_per_cm2,transient_factor,stiffness_N_per_mm,mass_kg
//   chest,sternum,140,120,2,25,40
//
// Throws InputError with file, line and advice.
ContactLimits ReadContactLimits(const std::filesystem::path& file);
ContactLimits ParseContactLimits(const std::string& text, const std::string& name);

enum class ContactKind {
  kTransient,    // the body part can recoil
  kQuasiStatic,  // the body part is clamped, for example against a fixture
};

// These functions return the limits at this point of the body, or 0 if the point must not be hit.
double ForceLimit(const ContactLimit& limit, ContactKind kind);     // [N]
double PressureLimit(const ContactLimit& limit, ContactKind kind);  // [Pa]

// Returns m_R = M/2 + m_L [kg], which is half of the moving mass of the robot plus its load,
// including the object.
double EffectiveRobotMass(double moving_mass, double load);
// Returns 1 / (1/m_H + 1/m_R) [kg]. If the load is heavy, this mass hardly depends on the robot.
double ReducedMass(double body_mass, double robot_mass);

// A transient contact or a clamping contact. `area` is the area of the contact [m²]. A value of 0
// means that the area is unknown. In this case, only the force counts.
struct Contact {
  ContactKind kind = ContactKind::kTransient;
  double robot_mass = 0;  // [kg] effective
  double area = 0;        // [m²]
};

struct ContactSpeed {
  double speed = 0;          // [m/s] relative speed at which the limit is reached
  double energy = 0;         // [J] energy F²/2k that the body part then absorbs
  bool by_pressure = false;  // the limit of pressure is reached first
};
// The permitted speed is 0 if the point must not be hit.
ContactSpeed MaxContactSpeed(const ContactLimit& limit, const Contact& contact);

// A measured or simulated peak as a multiple of the limits. The multiple is infinite if the point
// must not be hit.
struct ContactRatio {
  double force = 0, pressure = 0;
  bool within() const { return force <= 1 && pressure <= 1; }
};
ContactRatio CompareContact(const ContactLimit& limit, ContactKind kind, double force,  // [N]
                            double pressure);                                           // [Pa]

}  // namespace predictor::ergonomics
