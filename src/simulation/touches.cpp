#include "simulation/touches.h"

#include <string>

#include "core/error.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

bool IsKeepOut(const FixtureSpec& fixture) { return fixture.keep_out; }
bool IsKeepOut(const MovableSpec&) { return false; }

// `key` is that of a fixture or a movable object, and `what` is the word for it.
template <class Body>
void RefuseWithoutShape(const Body& body, const std::string& key, const std::string& what,
                        Toucher toucher, const Scenario& scenario) {
  const bool is_object = toucher == Toucher::kObject;
  const std::string word = is_object ? "object" : "cobot";
  if (!body.Touches(word.c_str())) return;
  const std::string shapes = is_object ? "<collision>" : "<collision> in a link that a joint moves";
  const auto file =
      ResolveModelPath(is_object ? scenario.object.model : scenario.cobot.model, scenario.folder());
  const std::string remedy = body.touches.size() > 1 && !IsKeepOut(body) ? word + " from this list."
                                                                         : "this " + what + ".";
  const std::string member = key + (IsKeepOut(body) ? ".keep_out" : ".touches");
  throw InputError::At(member, member + (IsKeepOut(body) ? " is true" : " contains " + word) +
                                   ", but " + file.string() + " has no " + shapes +
                                   ", so nothing would collide. Add <collision> to the "
                                   "links in this file, or remove " +
                                   remedy);
}

}  // namespace

void RequireShapes(const Scenario& scenario, Toucher toucher, std::size_t shapes) {
  if (shapes > 0) return;
  const EnvironmentSpec& environment = scenario.environment;
  for (std::size_t i = 0; i < environment.objects.size(); ++i)
    RefuseWithoutShape(environment.objects[i], "environment.objects." + std::to_string(i),
                       "movable object", toucher, scenario);
  // For a fixture, the word "object" also stands for the movable objects.
  if (toucher == Toucher::kObject && !environment.objects.empty()) return;
  for (std::size_t i = 0; i < environment.fixtures.size(); ++i)
    RefuseWithoutShape(environment.fixtures[i], "environment.fixtures." + std::to_string(i),
                       "fixture", toucher, scenario);
}

void RequireShapesOfCobotTouches(const Scenario& scenario, bool cobot, bool object) {
  const auto refuse = [&](const std::string& what, const std::string& model,
                          const std::string& remedy) {
    throw InputError::At("cobot.touches",
                         "cobot.touches " + what + ", but " +
                             ResolveModelPath(model, scenario.folder()).string() +
                             " has no <collision>, so nothing would collide. Add <collision> to "
                             "the links in this file, or remove " +
                             remedy);
  };
  if (scenario.cobot.Touches("object") && !object)
    refuse("contains object", scenario.object.model, "object from this list.");
  if (!scenario.cobot.touches.empty() && !cobot)
    refuse("is given", scenario.cobot.model, "this key.");
}

void RequirePairsOfCobotTouches(const Scenario& scenario, bool cobot, bool object) {
  const auto require = [&](bool can_touch, const char* word, const char* reason) {
    if (!scenario.cobot.Touches(word) || can_touch) return;
    throw InputError::At("cobot.touches",
                         std::string("cobot.touches contains ") + word +
                             ", but the only links of " +
                             ResolveModelPath(scenario.cobot.model, scenario.folder()).string() +
                             " with <collision> " + reason +
                             ", so nothing would collide. Add <collision> to other links, or "
                             "remove " +
                             word + " from this list.");
  };
  require(object, "object", "belong to the hand that holds the object");
  require(cobot, "cobot", "are neighbours");
}

}  // namespace predictor
