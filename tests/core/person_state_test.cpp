#include "core/person_state.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/person_json.h"
#include "core/ring.h"

namespace predictor {
namespace {

PersonState Judged() {
  PersonState state;
  state.tick = 5210;
  state.run_time = 4.205;
  state.status = PersonStatus::kJudged;
  state.reached = 1;
  state.warnings = 1U << static_cast<unsigned>(PersonWarning::kBalance);
  state.points[0] = {1, -0.05F, 0.1F};
  state.parts[0].load = 0.25F;
  state.gauges[0] = {1160, 830, 1640};
  state.scores[0] = {3, 2, 0, {0, 0.75F, 0.25F, 0, 0}};
  return state;
}

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(PersonJson, SaysWhatIsKnownAndNullForTheRest) {
  const std::string text = PersonJson(Judged());
  EXPECT_TRUE(text.starts_with(R"({"type":"person","tick":5210,"run_time":4.205,)")) << text;
  for (const char* part : {R"("status":"judged")", R"("reached":true)", R"("warnings":["balance"])",
                           R"("points":{"pelvis":[1,-0.05,0.1],"l5s1":[0,0,0],)",
                           R"("lower_back":{"load":0.25,"capacity":null,"damage":null,)"
                           R"("day_share":null,"load_over_range":null})",
                           R"("lower_back_compression":{"value":1160,"low":830,"high":1640})",
                           R"("lower_back_shear":{"value":null,"low":null,"high":null})",
                           R"("rula":{"score":3,"level":2,"probability":[0,0.75,0.25,0]})",
                           R"("reba":{"score":0,"level":0,"probability":null})"})
    EXPECT_TRUE(Contains(text, part)) << part << "\n" << text;
}

TEST(PersonJson, HasNoPointsOfAPersonWhoIsNotJudged) {
  PersonState state = Judged();
  state.status = PersonStatus::kNoHand;
  EXPECT_TRUE(Contains(PersonJson(state), R"("points":{"pelvis":null,"l5s1":null,)"));
}

// Another process writes the memory of the state, so it may contain any bytes. `nan`, `inf` and
// names beyond the table are not valid JSON.
TEST(PersonJson, IsValidForAnyBytes) {
  for (const int byte : {0x00, 0x7f, 0xff}) {
    PersonState state;
    std::memset(static_cast<void*>(&state), byte, sizeof state);
    const std::string text = PersonJson(state);
    EXPECT_FALSE(Contains(text, "nan")) << text;
    EXPECT_FALSE(Contains(text, "inf")) << text;
    EXPECT_TRUE(Contains(text, R"("status":)"));
    EXPECT_LT(text.size(), 8192u);
  }
}

TEST(PersonSchema, DescribesEachMember) {
  const std::string schema = PersonSchema();
  EXPECT_TRUE(Contains(schema, R"("type":{"const":"person"})")) << schema;
  for (const char* name : kBodyPointNames) EXPECT_TRUE(Contains(schema, name)) << name;
  for (const auto& row : kPersonGaugeRows) EXPECT_TRUE(Contains(schema, row.name)) << row.name;
  EXPECT_TRUE(Contains(schema, R"("description":"[m] largest distance)")) << schema;
}

// A warning that began and ended at the same threshold would flicker.
TEST(PersonWarnings, HaveTwoThresholds) {
  for (const auto& row : kPersonWarningRows) EXPECT_NE(row.on, row.off) << row.name;
}

TEST(PersonState, FitsIntoARing) {
  auto ring = std::make_unique<RingStorage<PersonState, 4>>();
  ring->Publish(Judged());
  PersonState state;
  ASSERT_TRUE(ring->Get(0, &state));
  EXPECT_EQ(state.gauges[0].high, 1640);
  EXPECT_TRUE(Has(state, PersonWarning::kBalance));
  EXPECT_FALSE(Has(state, PersonWarning::kReach));
}

}  // namespace
}  // namespace predictor
