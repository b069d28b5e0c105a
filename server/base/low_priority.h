// For threads whose work can wait.
#pragma once

namespace curvecast::server {

/// Lowers the priority of the calling thread by ten steps from the main thread's, so that next to a busy thread of views it gets
/// a tenth of a core. With less, its work would never be done on a machine that is busy. A second call changes nothing.
void lower_priority();

}  // namespace curvecast::server
