// Whether other machines can connect to an address.
#pragma once

#include <string>

namespace curvecast::server {

/// Whether "host:port" is of the loopback, all addresses that a name stands for. True for what is no address or a name that is
/// not known: nobody can listen there.
bool is_loopback(const std::string& address);

}  // namespace curvecast::server
