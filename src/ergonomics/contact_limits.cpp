#include "ergonomics/contact_limits.h"

#include <cmath>
#include <limits>
#include <string_view>

#include "core/error.h"
#include "core/text.h"
#include "ergonomics/limit_file.h"

namespace predictor::ergonomics {
namespace {

constexpr std::string_view kContactHeader =
    "region,point,force_N,pressure_N_per_cm2,transient_factor,stiffness_N_per_mm,mass_kg";
constexpr double kPerSquareCentimetre = 1e4;  // N/cm² in Pa
constexpr double kPerMillimetre = 1e3;        // N/mm in N/m

ContactLimit LimitOf(const std::vector<std::string>& cells, const std::string& place) {
  if (cells[0].empty() || cells[1].empty())
    throw InputError(place, "region or point is empty. Name both.");
  const auto above_zero = [&](std::size_t i, const char* name) {
    return NumberInCell(cells[i], name, 0, false, place);
  };
  ContactLimit limit = {cells[0], cells[1]};
  limit.force = above_zero(2, "force_N");
  limit.pressure = above_zero(3, "pressure_N_per_cm2") * kPerSquareCentimetre;
  limit.transient_factor = NumberInCell(cells[4], "transient_factor", 0, true, place);
  limit.stiffness = above_zero(5, "stiffness_N_per_mm") * kPerMillimetre;
  limit.mass = above_zero(6, "mass_kg");
  if (limit.transient_factor > 0 && limit.transient_factor < 1)
    throw InputError(
        place, "transient_factor is " + Quote(cells[4]) +
                   ". Write 0 if the point must not be hit, and otherwise a value of at least 1.");
  return limit;
}

void AddLimit(ContactLimit limit, const std::string& place, ContactLimits* limits) {
  for (const ContactLimit& other : limits->points) {
    if (other.region != limit.region) continue;
    if (other.point == limit.point)
      throw InputError(place, Quote(limit.region) + " has the point " + Quote(limit.point) +
                                  " twice. Remove one of the rows.");
    if (other.force != limit.force || other.stiffness != limit.stiffness ||
        other.mass != limit.mass)
      throw InputError(place, "force, stiffness or mass of " + Quote(limit.region) +
                                  " differ from an earlier row. These values belong to the region, "
                                  "so give all points of the region the same values.");
  }
  limits->points.push_back(std::move(limit));
}

}  // namespace

ContactLimits ParseContactLimits(const std::string& text, const std::string& name) {
  const LimitTable table = ParseLimitTable(text, name, kContactHeader);
  ContactLimits limits;
  limits.edition = table.edition;
  for (const LimitRow& row : table.rows)
    AddLimit(LimitOf(row.cells, row.place), row.place, &limits);
  return limits;
}

ContactLimits ReadContactLimits(const std::filesystem::path& file) {
  return ParseContactLimits(ReadLimitFile(file), file.string());
}

double ForceLimit(const ContactLimit& limit, ContactKind kind) {
  return limit.force * (kind == ContactKind::kTransient ? limit.transient_factor : 1);
}

double PressureLimit(const ContactLimit& limit, ContactKind kind) {
  return limit.pressure * (kind == ContactKind::kTransient ? limit.transient_factor : 1);
}

double EffectiveRobotMass(double moving_mass, double load) { return moving_mass / 2 + load; }

double ReducedMass(double body_mass, double robot_mass) {
  return body_mass * robot_mass / (body_mass + robot_mass);
}

ContactSpeed MaxContactSpeed(const ContactLimit& limit, const Contact& contact) {
  ContactSpeed result;
  double force = ForceLimit(limit, contact.kind);
  const double by_pressure = PressureLimit(limit, contact.kind) * contact.area;
  if (contact.area > 0 && by_pressure < force) {
    force = by_pressure;
    result.by_pressure = true;
  }
  result.speed = force / std::sqrt(ReducedMass(limit.mass, contact.robot_mass) * limit.stiffness);
  result.energy = force * force / (2 * limit.stiffness);
  return result;
}

ContactRatio CompareContact(const ContactLimit& limit, ContactKind kind, double force,
                            double pressure) {
  const auto ratio = [](double x, double most) {
    return most > 0 ? x / most : x > 0 ? std::numeric_limits<double>::infinity() : 0;
  };
  return {ratio(force, ForceLimit(limit, kind)), ratio(pressure, PressureLimit(limit, kind))};
}

}  // namespace predictor::ergonomics
