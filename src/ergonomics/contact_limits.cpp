#include "ergonomics/contact_limits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "core/error.h"
#include "core/text.h"

namespace predictor::ergonomics {
namespace {

constexpr std::string_view kEdition = "edition";
constexpr std::string_view kContactHeader =
    "region,point,force_N,pressure_N_per_cm2,transient_factor,stiffness_N_per_mm,mass_kg";
constexpr std::size_t kContactColumns = 7;
constexpr std::size_t kMaxContactBytes = 1u << 20;
constexpr double kPerSquareCentimetre = 1e4;  // N/cm² in Pa
constexpr double kPerMillimetre = 1e3;        // N/mm in N/m

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = std::min(text.find_first_not_of(" \t\r"), text.size());
  return text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

std::vector<std::string> CellsOfLine(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.emplace_back(Trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

// Parses the number in a cell. `least` is the smallest allowed value.
double NumberIn(const std::string& cell, std::size_t column, double least, bool or_equal,
                const std::string& place) {
  double x = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
  const bool number = error == std::errc() && end == cell.data() + cell.size() && std::isfinite(x);
  if (!number || x < least || (x == least && !or_equal)) {
    const std::string name = CellsOfLine(kContactHeader)[column];
    throw InputError(place, name + " is " + Quote(cell) + ". Give a number " +
                                (or_equal ? "of at least " : "above ") + FormatNumber(least) +
                                ", with a point and without a unit.");
  }
  return x;
}

ContactLimit LimitOf(const std::vector<std::string>& cells, const std::string& place) {
  if (cells.size() != kContactColumns)
    throw InputError(place, "this row has " + std::to_string(cells.size()) +
                                " values. Give one for each of the " +
                                std::to_string(kContactColumns) +
                                " columns: " + std::string(kContactHeader) + ".");
  if (cells[0].empty() || cells[1].empty())
    throw InputError(place, "region or point is empty. Name both.");
  const auto above_zero = [&](std::size_t i) { return NumberIn(cells[i], i, 0, false, place); };
  ContactLimit limit = {cells[0], cells[1]};
  limit.force = above_zero(2);
  limit.pressure = above_zero(3) * kPerSquareCentimetre;
  limit.transient_factor = NumberIn(cells[4], 4, 0, true, place);
  limit.stiffness = above_zero(5) * kPerMillimetre;
  limit.mass = above_zero(6);
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
  ContactLimits limits;
  bool header = false;
  std::istringstream lines(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = name + ":" + std::to_string(++number);
    const std::string_view content = Trimmed(line);
    if (content.empty() || content.starts_with('#')) continue;
    const std::vector<std::string> cells = CellsOfLine(content);
    if (limits.edition.empty()) {
      if (cells.size() < 2 || cells[0] != kEdition || cells[1].empty())
        throw InputError(place,
                         "the file does not name its edition. Begin the file with a line such as "
                         "\"edition,ISO/TS 15066:2016 Annex A\".");
      limits.edition = std::string(Trimmed(content.substr(content.find(',') + 1)));
    } else if (!header) {
      if (Join(cells, ",") != kContactHeader)
        throw InputError(place, "the header is " + Quote(content) + "; it must be " +
                                    std::string(kContactHeader) + ".");
      header = true;
    } else {
      AddLimit(LimitOf(cells, place), place, &limits);
    }
  }
  if (limits.points.empty())
    throw InputError(name, "the file contains no limits. Give the edition, then the header " +
                               std::string(kContactHeader) + ", then a row for each point.");
  return limits;
}

ContactLimits ReadContactLimits(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw InputError(file.string(), "the file cannot be read. Check its name and permissions.");
  std::string text(kMaxContactBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxContactBytes)
    throw InputError(file.string(), "the file is larger than 1 MiB. Give a table of limits.");
  return ParseContactLimits(text, file.string());
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
