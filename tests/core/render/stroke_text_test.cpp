#include "core/render/stroke_text.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace curvecast {
namespace {

Image white(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * height, 255)};
}

int red(const Image& image, int x, int y) { return image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)]; }

/// Sum of what has been taken off white, in whole pixels.
double ink(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += (255 - image.rgba[i]) / 255.0;
  return sum;
}

TEST(StrokeText, ALineHasItsWidthAndItsPlace) {
  Image image = white(40, 20);
  draw_line(image, {5, 10}, {35, 10}, 2, {0, 0, 0});
  EXPECT_EQ(red(image, 20, 9), 0);
  EXPECT_EQ(red(image, 20, 10), 0);
  EXPECT_EQ(red(image, 20, 6), 255);
  EXPECT_NEAR(ink(image), 60, 6);  // 30 long, 2 wide, round ends
}

TEST(StrokeText, WhatLiesOutsideIsLeftOut) {
  Image image = white(20, 20);
  draw_line(image, {-50, -50}, {70, 70}, 3, {0, 0, 0});
  draw_line(image, {-50, 5}, {-10, 5}, 3, {0, 0, 0});
  EXPECT_EQ(red(image, 10, 10), 0);
  EXPECT_EQ(red(image, 0, 5), 255);
}

TEST(StrokeText, EveryGlyphDiffersAndIsCentred) {
  std::vector<std::vector<std::uint8_t>> seen;
  for (const char c : std::string("0123456789/")) {
    Image image = white(40, 40);
    draw_text(image, std::string(1, c), {20, 30}, 20, {0, 0, 0});
    EXPECT_GT(ink(image), 20) << c;
    EXPECT_EQ(std::count(seen.begin(), seen.end(), image.rgba), 0) << c;
    seen.push_back(image.rgba);
    for (int y = 0; y < 40; ++y) {
      for (const int x : {0, 5, 34, 39}) EXPECT_EQ(red(image, x, y), 255) << c;
    }
  }
  Image blank = white(40, 40);
  draw_text(blank, "x ?", {20, 30}, 20, {0, 0, 0});
  EXPECT_EQ(ink(blank), 0);
}

}  // namespace
}  // namespace curvecast
