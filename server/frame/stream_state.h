// The states of a conversation of views and frames, and the events that move it from one to the next: tables, without data, locks
// or actions. ClientStream acts by them; server/README.md shows them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace curvecast::server {

/// Where the newest view of a stream is between its arrival and its last frame.
enum class ViewState : std::uint8_t {
  kNone,        // no view has arrived
  kWaiting,     // the view has no frame yet, and no worker makes one
  kAnswering,   // a worker makes a frame of the view
  kOutdated,    // a worker makes a frame of the view from data that have been improved meanwhile
  kCoarse,      // the view has a frame; a better one can be made once the session is improved
  kImprovable,  // the view has a frame; a better one can be made now
  kSettled,     // the view has its last frame
};
inline constexpr std::size_t kViewStates = 7;

enum class ViewEvent : std::uint8_t {
  kArrived,   // the client sent a newer view
  kRefused,   // the view that waits got an error without a worker
  kTaken,     // a worker begins to make a frame of the view that waits or is improvable
  kFinal,     // a worker made a frame, and knows of no better one
  kPromised,  // a worker made a frame, and a better one can be made once the session is improved
  kPart,      // a worker made a part, and the next one can be made at once
  kImproved,  // work on the session's curve or ranks is over, whether anything came of it or not
};
inline constexpr std::size_t kViewEvents = 7;

/// Events that a state knows nothing of leave it as it is: so a frame of a view that was overtaken does not touch the view that
/// waits.
///
///              | kArrived | kRefused | kTaken     | kFinal   | kPromised   | kPart       | kImproved
///  ------------+----------+----------+------------+----------+-------------+-------------+------------
///  kNone       | kWaiting | -        | -          | -        | -           | -           | -
///  kWaiting    | kWaiting | kSettled | kAnswering | -        | -           | -           | -
///  kAnswering  | kWaiting | -        | -          | kSettled | kCoarse     | kImprovable | kOutdated
///  kOutdated   | kWaiting | -        | -          | kSettled | kImprovable | kImprovable | -
///  kCoarse     | kWaiting | -        | -          | -        | -           | -           | kImprovable
///  kImprovable | kWaiting | -        | kAnswering | -        | -           | -           | -
///  kSettled    | kWaiting | -        | -          | -        | -           | -           | -
ViewState next(ViewState state, ViewEvent event);

/// What client and server may still send each other.
enum class LinkState : std::uint8_t {
  kUnopened,    // the client has not named its session
  kOpen,        // both may send
  kHalfClosed,  // the client sends no more, and gets the frames still due
  kEnding,      // nothing is sent any more but the message that the transport has
  kEnded,       // the transport was told of the end
};
inline constexpr std::size_t kLinkStates = 5;

enum class LinkEvent : std::uint8_t {
  kOpened,      // the client named a session that there is
  kHalfClosed,  // the client sends no more
  kDrained,     // all frames that were due have left
  kFailed,      // the client broke the protocol or has gone, or the server stops
  kIdle,        // the transport has no message
};
inline constexpr std::size_t kLinkEvents = 5;

///              | kOpened | kHalfClosed | kDrained | kFailed | kIdle
///  ------------+---------+-------------+----------+---------+-------
///  kUnopened   | kOpen   | kEnding     | -        | kEnding | -
///  kOpen       | -       | kHalfClosed | -        | kEnding | -
///  kHalfClosed | -       | -           | kEnding  | kEnding | -
///  kEnding     | -       | -           | -        | -       | kEnded
///  kEnded      | -       | -           | -        | -       | -
LinkState next(LinkState state, LinkEvent event);

/// Whether a worker is to make a frame. `has_room`: one more frame may be unacknowledged. A client that has half-closed
/// acknowledges nothing: it gets the frame of its last view all the same, and no better one.
bool wants_worker(LinkState link, ViewState view, bool has_room);

/// Whether a better frame of the newest view follows without being asked for: the one meaning of FrameStatistics.refining in a
/// stream.
bool is_better_frame_due(LinkState link, ViewState view);

}  // namespace curvecast::server
