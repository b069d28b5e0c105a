#include "core/base/column.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>

namespace curvecast {
namespace {

TEST(Column, IsAValue) {
  const Column<int> three = {1, 2, 3};
  Column<int> copy = three;
  EXPECT_EQ(copy, three);
  EXPECT_NE(copy.data(), three.data());
  copy[1] = 7;
  EXPECT_EQ(three[1], 2);
  const int* const entries = copy.data();
  const Column<int> moved = std::move(copy);
  EXPECT_EQ(moved.data(), entries);
  EXPECT_EQ(moved, (Column<int>{1, 7, 3}));
}

TEST(Column, CanBeFilledWithOneOfItsOwnEntries) {
  for (const std::size_t size : {std::size_t{3}, std::size_t{1} << 20}) {  // small, and in large pages
    Column<std::uint64_t> column;
    for (const std::size_t wanted : {std::size_t{1}, size, 2 * size}) {
      column.assign(size, 42);
      column.assign(wanted, column[0]);
      EXPECT_EQ(column.size(), wanted);
      for (const std::uint64_t value : column) ASSERT_EQ(value, 42u) << wanted << " of " << size;
    }
  }
}

TEST(Column, AViewKeepsAliveWhatItLooksAt) {
  const auto values = std::make_shared<const Column<int>>(Column<int>{4, 5});
  const std::weak_ptr<const Column<int>> watched = values;
  Column<int> view = Column<int>::view(*values, values);
  EXPECT_EQ(view.data(), values->data());
  const Column<int> copy = view;
  EXPECT_NE(copy.data(), values->data());
  EXPECT_EQ(watched.use_count(), 2);
  view.resize(0);
  EXPECT_EQ(watched.use_count(), 1);
  EXPECT_EQ(copy, (Column<int>{4, 5}));
}

TEST(Column, OfNothingIsEmpty) {
  Column<int> column = {1};
  column.assign(0, column[0]);
  EXPECT_TRUE(column.empty());
  EXPECT_EQ(column.begin(), column.end());
  EXPECT_EQ(column, Column<int>());
}

}  // namespace
}  // namespace curvecast
