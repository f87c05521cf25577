// Finds contacts with ODE. The results of this detector depend only on the shapes and their poses.
#pragma once

#include <dart/collision/CollisionDetector.hpp>
#include <memory>

namespace predictor::dart_engine {

// Returns DART's ODE collision detector without DART's memory of earlier contacts. DART 6.12 adds
// up to two earlier contacts of a pair that touches at fewer than three points, even after the
// bodies moved on. If DART added such contacts, a run from a restored state would not match the
// original run bit for bit.
std::shared_ptr<dart::collision::CollisionDetector> MakeContactDetector();

}  // namespace predictor::dart_engine
