// Clients that behave badly, to see what the others notice of it.
#pragma once

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli::bench {

/// While it lives: streams that ask for frames and never read one, a stream that sends views as fast as it can, streams that go
/// away in the middle of a frame, and an upload without end.
class Abusers {
 public:
  /// `view(i)`: the i-th of a sequence of views of a session.
  Abusers(const std::string& address, const std::string& session_id, const std::function<v1::SampleRequest(double)>& view);
  Abusers(const Abusers&) = delete;
  Abusers& operator=(const Abusers&) = delete;
  ~Abusers();  // all of them go

 private:
  std::vector<std::jthread> threads_;
};

}  // namespace curvecast::cli::bench
