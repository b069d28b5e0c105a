// What a set of tiles is made of, as a query and as a part of its tiles' addresses.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <string_view>

#include "curvecast/v1/curvecast.pb.h"
#include "proto/formats/tileset.h"
#include "server/web/resources/resource.h"

namespace curvecast::server {

struct TilesetTerms {
  v1::SampleRequest sample;         // without a budget, where none was given
  formats::TilesetOptions options;  // all but the folder
};

/// Reads n, density, up and glb. InvalidArgument names the part at fault: one that tiles have not, or a density that only a
/// camera gives a sense.
absl::StatusOr<TilesetTerms> read_tileset_query(const WebResource::Query& query);

/// Returns the query in one spelling, in which it is part of addresses, with `points` where it has no n. InvalidArgument: it is
/// too long for that. Precondition: read_tileset_query() takes it.
absl::StatusOr<std::string> tileset_text(const WebResource::Query& query, std::uint64_t points);

/// Where the tiles of a set are, below its session: a name for their bytes, and what it takes to make them again.
struct TilesetAddress {
  std::string digest;  // 32 hexadecimal digits
  std::string text;    // as of tileset_text()

  /// Returns one part of a path.
  std::string part() const;
};

/// The error of an address that names no set.
absl::Status no_such_tileset();
/// Reads such a part. no_such_tileset(): it is none.
absl::StatusOr<TilesetAddress> read_tileset_address(std::string_view part);

}  // namespace curvecast::server
