// Output that waits for its reader only for a limited time.
#pragma once

namespace predictor {

// After this call, output to standard error and standard output waits for a reader for at most one
// second. Further output is dropped until the reader continues, and a message reports this. A pager
// that is not scrolled or a stopped terminal (Ctrl-S) must not prevent a run from ending. The
// behaviour of a stream that does not allow such a limit does not change.
void BoundOutput();

}  // namespace predictor
