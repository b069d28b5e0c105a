// SPDX-License-Identifier: Apache-2.0
#include "proto/tls/exit_cleanup.h"

#include <openssl/crypto.h>

namespace curvecast::tls {

void skip_cleanup_at_exit() { OPENSSL_init_crypto(OPENSSL_INIT_NO_ATEXIT, nullptr); }

}  // namespace curvecast::tls
