#include "pipeline/fill/tone_match.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gimbal {
namespace {

constexpr float kBlack = 16;

CellLook look(float luma, float u, float v) {
  return {{luma, luma, luma, luma}, {u, v}};
}

/// Cells of many tones, darker and warmer in the one picture than in the other.
std::vector<CellPair> pairs(float gain, float offset) {
  std::vector<CellPair> made;
  for (int i = 0; i < 200; ++i) {
    const float luma = 30 + static_cast<float>(i * 37 % 150);
    made.push_back({look(kBlack + gain * (luma - kBlack) + offset, 128 + gain * 10 + 3, 120),
                    look(luma, 138, 120)});
  }
  return made;
}

TEST(ToneMatch, FindsGainAndOffset) {
  const Tone tone = match_tones(pairs(0.8F, 4), kBlack);
  EXPECT_NEAR(tone.gain, 0.8, 0.01);
  EXPECT_NEAR(tone.luma(100), 16 + 0.8 * 84 + 4, 0.5);
  EXPECT_NEAR(tone.chroma(138, 0), 139, 0.2);
  EXPECT_NEAR(tone.chroma(120, 1), 120, 0.2);
}

TEST(ToneMatch, WhatIsSomethingElseHardlyCounts) {
  auto cells = pairs(0.9F, 0);
  for (std::size_t i = 0; i < cells.size(); i += 4) cells[i].wanted = look(230, 90, 160);
  const Tone tone = match_tones(cells, kBlack);
  for (const float luma : {40.F, 100.F, 170.F}) {
    EXPECT_NEAR(tone.luma(luma), kBlack + 0.9 * (luma - kBlack), 2) << luma;
  }
}

TEST(ToneMatch, EvenCellsAreTakenForAGain) {
  const std::vector<CellPair> cells(50, {look(116, 128, 128), look(91, 128, 128)});
  const Tone tone = match_tones(cells, kBlack);
  EXPECT_NEAR(tone.luma(91), 116, 0.1);
  EXPECT_NEAR(tone.luma(kBlack), kBlack, 0.5);
}

TEST(ToneMatch, OfNothingChangesNothing) {
  EXPECT_EQ(match_tones({}, kBlack).luma(77), 77);
}

}  // namespace
}  // namespace gimbal
