// SPDX-License-Identifier: Apache-2.0
// Included ahead of everything with ThreadSanitizer: otherwise Protobuf's header gives map fields two members of which what is
// compiled without the sanitiser, the generated code and the system's library, knows nothing: it takes them for the next field.
#pragma once

#include <memory>  // before the macro goes: the standard library looks at it once

#pragma push_macro("__SANITIZE_THREAD__")
#undef __SANITIZE_THREAD__
#include <google/protobuf/map_field.h>
#pragma pop_macro("__SANITIZE_THREAD__")
