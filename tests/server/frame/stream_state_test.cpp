#include "server/frame/stream_state.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace curvecast::server {
namespace {

using V = ViewState;
using L = LinkState;

template <class Enum>
std::vector<Enum> all(std::size_t count) {
  std::vector<Enum> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<Enum>(i));
  return out;
}

const std::vector<ViewState> kAllViews = all<ViewState>(kViewStates);
const std::vector<ViewEvent> kAllViewEvents = all<ViewEvent>(kViewEvents);
const std::vector<LinkState> kAllLinks = all<LinkState>(kLinkStates);
const std::vector<LinkEvent> kAllLinkEvents = all<LinkEvent>(kLinkEvents);

TEST(StreamState, EveryViewStateAndEvent) {
  struct Change {
    ViewState from;
    ViewEvent event;
    ViewState to;
  };
  // The arrival of a view aside, all that is not in this list leaves the state as it is.
  const std::vector<Change> changes = {
      {V::kWaiting, ViewEvent::kRefused, V::kSettled},    {V::kWaiting, ViewEvent::kTaken, V::kAnswering},
      {V::kAnswering, ViewEvent::kFinal, V::kSettled},    {V::kAnswering, ViewEvent::kPromised, V::kCoarse},
      {V::kAnswering, ViewEvent::kPart, V::kImprovable},  {V::kAnswering, ViewEvent::kImproved, V::kOutdated},
      {V::kOutdated, ViewEvent::kFinal, V::kSettled},     {V::kOutdated, ViewEvent::kPromised, V::kImprovable},
      {V::kOutdated, ViewEvent::kPart, V::kImprovable},   {V::kCoarse, ViewEvent::kImproved, V::kImprovable},
      {V::kImprovable, ViewEvent::kTaken, V::kAnswering},
  };
  for (const ViewState from : kAllViews) {
    for (const ViewEvent event : kAllViewEvents) {
      ViewState expected = event == ViewEvent::kArrived ? V::kWaiting : from;
      for (const Change& change : changes) {
        if (change.from == from && change.event == event) expected = change.to;
      }
      EXPECT_EQ(next(from, event), expected) << static_cast<int>(from) << " " << static_cast<int>(event);
    }
  }
}

TEST(StreamState, EveryLinkStateAndEvent) {
  struct Change {
    LinkState from;
    LinkEvent event;
    LinkState to;
  };
  const std::vector<Change> changes = {
      {L::kUnopened, LinkEvent::kOpened, L::kOpen},     {L::kUnopened, LinkEvent::kHalfClosed, L::kEnding},
      {L::kUnopened, LinkEvent::kFailed, L::kEnding},   {L::kOpen, LinkEvent::kHalfClosed, L::kHalfClosed},
      {L::kOpen, LinkEvent::kFailed, L::kEnding},       {L::kHalfClosed, LinkEvent::kDrained, L::kEnding},
      {L::kHalfClosed, LinkEvent::kFailed, L::kEnding}, {L::kEnding, LinkEvent::kIdle, L::kEnded},
  };
  for (const LinkState from : kAllLinks) {
    for (const LinkEvent event : kAllLinkEvents) {
      LinkState expected = from;
      for (const Change& change : changes) {
        if (change.from == from && change.event == event) expected = change.to;
      }
      EXPECT_EQ(next(from, event), expected) << static_cast<int>(from) << " " << static_cast<int>(event);
    }
  }
}

TEST(StreamState, AWorkerIsWantedForTheViewsThatAreDue) {
  for (const LinkState link : kAllLinks) {
    for (const ViewState view : kAllViews) {
      const bool may_begin = link == L::kOpen && (view == V::kWaiting || view == V::kImprovable);
      EXPECT_EQ(wants_worker(link, view, true), may_begin || (link == L::kHalfClosed && view == V::kWaiting));
      EXPECT_EQ(wants_worker(link, view, false), link == L::kHalfClosed && view == V::kWaiting);
    }
  }
}

TEST(StreamState, ABetterFrameIsDueOnlyWhereSomethingLeadsToIt) {
  for (const LinkState link : kAllLinks) {
    for (const ViewState view : kAllViews) {
      EXPECT_EQ(is_better_frame_due(link, view), link == L::kOpen && (view == V::kCoarse || view == V::kImprovable));
      if (!is_better_frame_due(link, view)) continue;
      // By a worker at once, or after an improvement.
      EXPECT_TRUE(wants_worker(link, view, true) || wants_worker(link, next(view, ViewEvent::kImproved), true));
    }
  }
}

TEST(StreamState, OnlyTheClientLeavesASettledViewAndNothingLeavesTheEnd) {
  for (const ViewEvent event : kAllViewEvents) {
    EXPECT_EQ(next(V::kSettled, event), event == ViewEvent::kArrived ? V::kWaiting : V::kSettled);
  }
  for (const LinkEvent event : kAllLinkEvents) EXPECT_EQ(next(L::kEnded, event), L::kEnded);
}

TEST(StreamState, EveryStateIsReached) {
  std::set<ViewState> views = {V::kNone};
  std::set<LinkState> links = {L::kUnopened};
  for (std::size_t round = 0; round < kViewStates; ++round) {
    for (const ViewState view : std::set<ViewState>(views)) {
      for (const ViewEvent event : kAllViewEvents) views.insert(next(view, event));
    }
    for (const LinkState link : std::set<LinkState>(links)) {
      for (const LinkEvent event : kAllLinkEvents) links.insert(next(link, event));
    }
  }
  EXPECT_EQ(views.size(), kViewStates);
  EXPECT_EQ(links.size(), kLinkStates);
}

}  // namespace
}  // namespace curvecast::server
