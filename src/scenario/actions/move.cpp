// Displaces the object by `by`.
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"
#include "scenario/actions/transport.h"

namespace predictor::actions {
namespace {

struct MoveParameters {
  double duration = 1;           // [s]
  Vector3 by = Vector3::Zero();  // displacement in W [m]
};

template <class V>
void Fields(V& v, MoveParameters& p) {
  v("duration", p.duration, DurationRule());
  v("by", p.by, Required(Number("m", "intended displacement of the object, in W", Within(10))));
}

class Move final : public Transport {
 public:
  explicit Move(const MoveParameters& p)
      : Transport(p.duration, NotZero("by", p.by), Vector3::Zero()) {}
  static std::string Sentence(const MoveParameters& p, double facing) {
    return MoveSentence(p.by, facing);
  }
};

}  // namespace

const ActionKind kMove =
    ActionKindOf<Move, MoveParameters>("move", "displaces the object", ActionMotion::kMoves);

}  // namespace predictor::actions
