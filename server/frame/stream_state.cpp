#include "server/frame/stream_state.h"

#include <array>

namespace curvecast::server {
namespace {

template <class State, std::size_t kEvents>
using Row = std::array<State, kEvents>;

constexpr std::array<Row<ViewState, kViewEvents>, kViewStates> kViewTable = [] {
  using enum ViewState;
  return std::array<Row<ViewState, kViewEvents>, kViewStates>{{
      // kArrived, kRefused, kTaken, kFinal, kPromised, kPart, kImproved
      {kWaiting, kNone, kNone, kNone, kNone, kNone, kNone},                                     // kNone
      {kWaiting, kSettled, kAnswering, kWaiting, kWaiting, kWaiting, kWaiting},                 // kWaiting
      {kWaiting, kAnswering, kAnswering, kSettled, kCoarse, kImprovable, kOutdated},            // kAnswering
      {kWaiting, kOutdated, kOutdated, kSettled, kImprovable, kImprovable, kOutdated},          // kOutdated
      {kWaiting, kCoarse, kCoarse, kCoarse, kCoarse, kCoarse, kImprovable},                     // kCoarse
      {kWaiting, kImprovable, kAnswering, kImprovable, kImprovable, kImprovable, kImprovable},  // kImprovable
      {kWaiting, kSettled, kSettled, kSettled, kSettled, kSettled, kSettled},                   // kSettled
  }};
}();

constexpr std::array<Row<LinkState, kLinkEvents>, kLinkStates> kLinkTable = [] {
  using enum LinkState;
  return std::array<Row<LinkState, kLinkEvents>, kLinkStates>{{
      // kOpened, kHalfClosed, kDrained, kFailed, kIdle
      {kOpen, kEnding, kUnopened, kEnding, kUnopened},            // kUnopened
      {kOpen, kHalfClosed, kOpen, kEnding, kOpen},                // kOpen
      {kHalfClosed, kHalfClosed, kEnding, kEnding, kHalfClosed},  // kHalfClosed
      {kEnding, kEnding, kEnding, kEnding, kEnded},               // kEnding
      {kEnded, kEnded, kEnded, kEnded, kEnded},                   // kEnded
  }};
}();

}  // namespace

ViewState next(ViewState state, ViewEvent event) {
  return kViewTable[static_cast<std::size_t>(state)][static_cast<std::size_t>(event)];
}

LinkState next(LinkState state, LinkEvent event) {
  return kLinkTable[static_cast<std::size_t>(state)][static_cast<std::size_t>(event)];
}

bool wants_worker(LinkState link, ViewState view, bool has_room) {
  if (view == ViewState::kWaiting) return link == LinkState::kHalfClosed || (link == LinkState::kOpen && has_room);
  return view == ViewState::kImprovable && link == LinkState::kOpen && has_room;
}

bool is_better_frame_due(LinkState link, ViewState view) {
  return link == LinkState::kOpen && (view == ViewState::kCoarse || view == ViewState::kImprovable);
}

}  // namespace curvecast::server
