// For threads whose work can wait.
#pragma once

namespace curvecast::server {

/// Views come first: next to a busy thread of theirs the calling one gets a tenth of a core. Less, and on a machine with other
/// work to do what it makes would never come. Measured from the main thread's priority: a second call changes nothing.
void lower_priority();

}  // namespace curvecast::server
