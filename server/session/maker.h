// Who has meshes kept and sessions made.
#pragma once

#include <string>

namespace curvecast::server {

struct Maker {
  std::string owner = {};   // of what is made; empty: nobody in particular
  std::string caller = {};  // whose share it takes: of the workers, of the store, and of the sessions in the making
};

/// The owner of what a server makes for itself, such as the meshes that it opens when it starts.
inline constexpr char kOperator[] = "this process";

}  // namespace curvecast::server
