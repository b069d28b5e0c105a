// SPDX-License-Identifier: Apache-2.0
// How OpenSSL ends in programs that gRPC has threads in.
#pragma once

namespace curvecast::tls {

/// Leaves what OpenSSL holds to the end of the process. Otherwise its own handler cleans up at exit, while gRPC's threads, which
/// nobody can wait for, may still connect anew: they would find it gone, and what it keeps for each of them would never be freed.
/// For the whole process; call it before anything else uses OpenSSL.
void skip_cleanup_at_exit();

}  // namespace curvecast::tls
