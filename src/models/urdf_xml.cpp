#include "models/urdf_xml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

constexpr int kMaxAttributes = 100;  // maximum number of attributes per element

[[noreturn]] void FailAt(const std::string& text, std::size_t position, const std::string& name,
                         const std::string& sentence) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(position);
  const auto line = 1 + std::count(text.begin(), end, '\n');
  throw InputError(name + ":" + std::to_string(line), sentence);
}

// Returns the end of the tag that begins at `at`. Refuses a tag with an absurd number of
// attributes, because the parser compares each attribute with all previous ones.
std::size_t EndOfTag(const std::string& text, std::size_t at, const std::string& name) {
  int attributes = 0;
  char quote = 0;
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return i;
    } else if (c == '=' && ++attributes > kMaxAttributes) {
      FailAt(text, at, name,
             "An element has more than " + std::to_string(kMaxAttributes) +
                 " attributes. No element of a URDF needs as many attributes as this one.");
    }
  }
  return text.size();
}

// Refuses text that would make the parser use much time or memory although the file is small. This
// check runs before parsing. XML entities can use much time and memory, and they can also read
// other files. Therefore only comments and character data may begin with "<!".
void RefuseHostile(const std::string& text, const std::string& name) {
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos) {
    FailAt(text, zero, name, "The file contains a zero byte, so it is not XML. Give a URDF file.");
  }
  const auto skip = [&text](std::size_t from, const char* end) {
    return std::min(text.find(end, from), text.size());
  };
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = skip(at + 4, "-->");
    } else if (text.compare(at, 9, "<![CDATA[") == 0) {
      at = skip(at + 9, "]]>");
    } else if (text.compare(at, 2, "<?") == 0) {
      at = skip(at + 2, "?>");
    } else if (text.compare(at, 2, "<!") == 0) {
      FailAt(text, at, name,
             "The file declares a document type or an entity, which is not allowed in a URDF. "
             "Remove everything from \"<!\" to its \">\".");
    } else {
      at = EndOfTag(text, at, name);
    }
  }
}

// Reads the numbers in `text`. Returns false if the text contains anything other than numbers.
bool ParseNumbers(const std::string& text, std::vector<double>* numbers) {
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (true) {
    while (at != end && is_space(*at)) ++at;
    if (at == end) return true;
    if (*at == '+') ++at;
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    const bool is_tiny = error == std::errc::result_out_of_range && next != at;
    if (error != std::errc() && !is_tiny) return false;
    if (next != end && !is_space(*next)) return false;
    numbers->push_back(is_tiny ? std::strtod(std::string(at, next).c_str(), nullptr) : value);
    at = next;
  }
}

std::string Of(const XmlElement& element, const char* attribute) {
  return std::string(attribute) + " of <" + element.Name() + ">";
}

// Reads `count` finite numbers.
std::vector<double> Numbers(const UrdfSource& source, const XmlElement& element,
                            const char* attribute, std::size_t count,
                            double largest = UrdfSource::kLargest) {
  const std::string text = element.Attribute(attribute);
  std::vector<double> numbers;
  if (!ParseNumbers(text, &numbers) || numbers.size() != count) {
    const bool is_xacro = text.find("${") != std::string::npos;
    source.Fail(element,
                Of(element, attribute) + " is " + Quote(text) + "; it must be " +
                    (count == 1 ? "a number." : std::to_string(count) + " numbers.") +
                    (is_xacro ? " The value is an expression of xacro. Expand the file first: "
                                "xacro FILE.urdf.xacro > FILE.urdf."
                              : ""));
  }
  for (const double x : numbers) {
    if (std::isfinite(x) && std::abs(x) <= largest) continue;
    source.Fail(element, Of(element, attribute) + " contains " + FormatNumber(x) +
                             "; it must be finite and at most " + FormatNumber(largest) +
                             " in magnitude. Use metres, kilograms and radians.");
  }
  return numbers;
}

}  // namespace

std::string UrdfSource::Place(const tinyxml2::XMLNode& at) const {
  return name + ":" + std::to_string(at.GetLineNum());
}

void UrdfSource::Fail(const tinyxml2::XMLNode& at, const std::string& sentence) const {
  throw InputError(Place(at), sentence);
}

std::string UrdfSource::Text(const XmlElement& element, const char* attribute) const {
  const char* value = element.Attribute(attribute);
  if (value == nullptr || *value == '\0') {
    Fail(element, std::string("<") + element.Name() + "> has no " + attribute + ". Add it.");
  }
  return value;
}

double UrdfSource::Number(const XmlElement& element, const char* attribute, double missing,
                          double largest) const {
  if (element.Attribute(attribute) == nullptr && !std::isnan(missing)) return missing;
  Text(element, attribute);
  return Numbers(*this, element, attribute, 1, largest)[0];
}

Vector3 UrdfSource::Triple(const XmlElement& element, const char* attribute,
                           const Vector3& missing) const {
  if (element.Attribute(attribute) == nullptr) return missing;
  return Vector3(Numbers(*this, element, attribute, 3).data());
}

std::array<double, 4> UrdfSource::Color(const XmlElement& element, const char* attribute) const {
  Text(element, attribute);
  const std::vector<double> c = Numbers(*this, element, attribute, 4);
  if (*std::min_element(c.begin(), c.end()) < 0 || *std::max_element(c.begin(), c.end()) > 1) {
    Fail(element, "A colour is " + Quote(element.Attribute(attribute)) +
                      "; its red, green, blue and opacity must be between 0 and 1.");
  }
  return {c[0], c[1], c[2], c[3]};
}

Pose UrdfSource::Origin(const XmlElement& element) const {
  const XmlElement* origin = Child(element, "origin");
  if (origin == nullptr) return {};
  return PoseFromXyzRpy(Triple(*origin, "xyz", Vector3::Zero()),
                        Triple(*origin, "rpy", Vector3::Zero()));
}

const XmlElement* UrdfSource::Child(const XmlElement& element, const char* child_name) const {
  const XmlElement* child = element.FirstChildElement(child_name);
  if (child != nullptr && child->NextSiblingElement(child_name) != nullptr) {
    Fail(*child->NextSiblingElement(child_name), std::string("<") + element.Name() +
                                                     "> has a second <" + child_name +
                                                     ">. Remove one of them.");
  }
  return child;
}

const XmlElement& UrdfSource::Required(const XmlElement& element, const char* child_name) const {
  const XmlElement* child = Child(element, child_name);
  if (child == nullptr) {
    const char* of = element.Attribute("name");
    Fail(element, std::string("<") + element.Name() + ">" + (of ? " " + Quote(of) : "") +
                      " has no <" + child_name + ">. Add it.");
  }
  return *child;
}

XmlElement* ParseXml(const std::string& text, const UrdfSource& source,
                     tinyxml2::XMLDocument* doc) {
  RefuseHostile(text, source.name);
  const tinyxml2::XMLError error = doc->Parse(text.data(), text.size());
  if (error == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) {
    throw InputError(source.name + ":" + std::to_string(doc->ErrorLineNum()),
                     "Elements are nested more than " + std::to_string(TINYXML2_MAX_ELEMENT_DEPTH) +
                         " levels deep. A URDF needs at most six levels.");
  }
  if (error != tinyxml2::XML_SUCCESS) {
    throw InputError(source.name + ":" + std::to_string(doc->ErrorLineNum()),
                     std::string("This is not well-formed XML (") +
                         tinyxml2::XMLDocument::ErrorIDToName(error) +
                         "). Look for an unclosed tag or a missing quotation mark.");
  }
  XmlElement* robot = doc->RootElement();
  if (robot == nullptr || std::string(robot->Name()) != "robot") {
    throw InputError(source.name + ":" + std::to_string(robot ? robot->GetLineNum() : 1),
                     "The outermost element is " +
                         (robot ? Quote(robot->Name()) : std::string("missing")) +
                         "; in a URDF it must be <robot>.");
  }
  if (robot->NextSiblingElement() != nullptr) {
    source.Fail(*robot->NextSiblingElement(),
                "A second element follows <robot>. A URDF must have only one root element. Delete "
                "the other.");
  }
  return robot;
}

}  // namespace predictor
