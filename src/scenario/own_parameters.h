// The parameters of a kind of part. The code of the kind declares these parameters, in a module
// that the scenario module does not know. Such kinds are the controllers of the virtual cobot, the
// hazards, the actions of the operator, and the tasks and limits of rendering.
//
// A kind declares a struct with a field table, like every part of a scenario (fields.h):
//   struct DampingParameters { double damping = 5; };
//   template <class V>
//   void Fields(V& v, DampingParameters& p) {
//     v("damping", p.damping, Number("N·m·s/rad", "of each joint", From(0, 1e3)));
//   }
// The scenario holds the parameters of a kind as a tree (ControllerSpec::parameters,
// ActionSpec::parameters). Loading, saving, the schema and overrides find the table
// by the name of the kind.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "scenario/field_rules.h"
#include "scenario/field_values.h"
#include "scenario/scenario.h"

namespace predictor {

// The visitor of a kind's field table. The members of the table may have the following types.
class ParameterVisitor {
 public:
  using Member = std::variant<bool*, int*, double*, std::string*, Vector3*, std::vector<double>*,
                              std::vector<std::string>*, std::vector<Waypoint>*>;
  using GroupWalk = std::function<void(ParameterVisitor&)>;

  virtual ~ParameterVisitor() = default;
  template <class T>
  void operator()(const char* key, T& member, const Rule& rule) {
    Visit(key, &member, rule);
  }
  virtual void Group(const char* key, const char* doc, const GroupWalk& walk) = 0;

 private:
  virtual void Visit(const char* key, Member member, const Rule& rule) = 0;
};

// Lets a visitor of the scenario's field tables visit a kind's table.
template <class V>
class AnyVisitor final : public ParameterVisitor {
 public:
  explicit AnyVisitor(V* v) : v_(*v) {}
  void Group(const char* key, const char* doc, const GroupWalk& walk) override {
    v_.Group(key, doc, [&](V& group) {
      AnyVisitor inner(&group);
      walk(inner);
    });
  }

 private:
  void Visit(const char* key, Member member, const Rule& rule) override {
    std::visit([&](auto* x) { v_(key, *x, rule); }, member);
  }
  V& v_;
};

// The parameters of a part.
class OwnParameters {
 public:
  virtual ~OwnParameters() = default;
  virtual void Walk(ParameterVisitor& v) = 0;
};

template <class P>
struct ParametersOf final : OwnParameters {
  void Walk(ParameterVisitor& v) override { Fields(v, value); }
  P value;
};

// Returns the struct of parameters that NewParameters<P> made.
template <class P>
const P& ValueOf(const OwnParameters& parameters) {
  return static_cast<const ParametersOf<P>&>(parameters).value;
}

template <class P>
std::unique_ptr<OwnParameters> NewParameters() {
  return std::make_unique<ParametersOf<P>>();
}

// The parameters of a kind that has no parameters.
struct NoParameters {};
template <class V>
void Fields(V&, NoParameters&) {}

// The place in which the code of a controller runs.
enum class ControllerPlace { kProgram, kLibrary, kProcess };

struct ParameterKind {
  const char* name;  // the word that chooses it: the controller's `type`, the entry's `action`
  const char* doc;
  std::unique_ptr<OwnParameters> (*parameters)();  // makes the parameters with their defaults
  ControllerPlace place = ControllerPlace::kProgram;
  bool is_tunable = false;  // of a controller: a run may change its stiffness and damping
};
using ParameterKinds = std::span<const ParameterKind* const>;

std::vector<std::string> NamesOf(ParameterKinds kinds);
// Returns null for an unknown name.
const ParameterKind* FindKind(ParameterKinds kinds, const std::string& name) noexcept;
// Returns the kinds except `kind` that have a parameter `key`.
std::vector<std::string> OthersWith(const std::string& key, const ParameterKind& kind,
                                    ParameterKinds kinds);

// Reads the parameters of a kind. Reports invalid values, missing values, and keys that this kind
// does not have.
std::unique_ptr<OwnParameters> ReadParameters(const ParameterKind& kind, const PathNode& at,
                                              Problems* problems);
YamlNode WriteParameters(OwnParameters* parameters);
// Returns `given` with every default, or unchanged if its kind is unknown or a value is invalid.
YamlNode CompleteParameters(ParameterKinds kinds, const std::string& type, const YamlNode& given);

// A group of keys in a tree that contains the own parameters of a kind.
struct KindGroup {
  std::string path;  // "cobot.controller"
  std::string key;   // key that names the kind: "type"
  ParameterKinds kinds;
  YamlNode* group;
};
// Removes the parameters of other kinds from a group, but only those that come from a file and not
// from an override. Returns whether there were any such parameters.
bool RemoveForeignParameters(const KindGroup& group);

// ---- parts that are all present
// ------------------------------------------------------------------

// Returns the parameters of one part. `all` contains a group for each part, under the name of the
// part (RenderingSpec::parts). `path` is the path of the groups of the parts.
std::unique_ptr<OwnParameters> ParametersOfPart(const ParameterKind& part, const YamlNode& all,
                                                const std::string& path, Problems* problems);
void SetPart(const ParameterKind& part, OwnParameters* parameters, YamlNode* all);

// Visits the groups of the parts that have parameters.
template <class V>
void WalkParts(V& v, ParameterKinds parts, YamlNode* all) {
  for (const ParameterKind* part : parts) {
    Problems ignored;  // invalid values keep their defaults
    const auto own = ParametersOfPart(*part, *all, "", &ignored);
    if (WriteParameters(own.get()).items.empty()) continue;
    v.Group(part->name, part->doc, [&](auto& group) {
      AnyVisitor visitor(&group);
      own->Walk(visitor);
    });
    SetPart(*part, own.get(), all);
  }
}

// ---- declared by other modules
// -------------------------------------------------------------------

// Returns the controllers of the virtual cobot, which the simulation declares when the program
// starts. A program without the simulation has no controllers, and keeps the parameters as given.
ParameterKinds Controllers() noexcept;
void DeclareControllers(ParameterKinds kinds) noexcept;

// Returns the hazards that an event may trigger. The simulation declares these hazards.
ParameterKinds Hazards() noexcept;
void DeclareHazards(ParameterKinds kinds) noexcept;

// Returns the tasks and limits of rendering, which the haptics module declares.
ParameterKinds RenderingParts() noexcept;
void DeclareRenderingParts(ParameterKinds parts) noexcept;

}  // namespace predictor
