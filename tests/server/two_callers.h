// Two who may call a server.
#pragma once

namespace curvecast::server {

/// A file of tokens: anna's is "anna's", bert's is "bert's". For each: printf %s "anna's" | sha256sum
inline constexpr char kTokens[] =
    "anna 8f68ce373d4607a65f1b1ce5c42eef43dcc492fdf17a5bb36bdca6d656ca21da\n"
    "bert a1eeb16073426839c5dfabc8fc71999ccbcee5ee0ce82ca9588a528582c4bb17\n";

}  // namespace curvecast::server
