#include "pipeline/fill/tone_match.hpp"

#include <algorithm>

namespace gimbal {
namespace {

constexpr int kPasses = 4;

/// Cells further off count for less: less than noise and a wrong sub-pixel do.
constexpr float kUsualDifference = 6;

/// Luma that varies less says little about the gain.
constexpr float kTellingDeviation = 8;

constexpr float kLeastGain = 0.5F;
constexpr float kMostGain = 2;

float weight_of(const CellPair& pair, const Tone& tone) {
  const float off =
      (pair.wanted.mean_luma() - tone.luma(pair.given.mean_luma())) / kUsualDifference;
  return 1 / (1 + off * off);
}

struct LumaSums {
  float weight = 0;
  float wanted = 0;
  float given = 0;
  float given_square = 0;
  float product = 0;

  void add(float w, float wanted_luma, float given_luma) {
    weight += w;
    wanted += w * wanted_luma;
    given += w * given_luma;
    given_square += w * given_luma * given_luma;
    product += w * wanted_luma * given_luma;
  }
};

/// Luma is counted from black.
void match_luma(const LumaSums& sums, Tone& tone) {
  const float wanted = sums.wanted / sums.weight;
  const float given = std::max(sums.given / sums.weight, 1.0F);
  const float variance = sums.given_square / sums.weight - given * given;
  const float covariance = sums.product / sums.weight - wanted * given;
  const float prior = kTellingDeviation * kTellingDeviation;
  const float as_gain = wanted / given;
  tone.gain =
      std::clamp((covariance + prior * as_gain) / (variance + prior), kLeastGain, kMostGain);
  tone.luma_offset = wanted - tone.gain * given;
}

}  // namespace

Tone match_tones(const std::vector<CellPair>& pairs, float black) {
  Tone tone;
  tone.black = black;
  if (pairs.empty()) return tone;
  // From what half of the cells are above and below, lest those that differ draw it to them.
  std::vector<float> differences;
  for (const CellPair& pair : pairs) {
    differences.push_back(pair.wanted.mean_luma() - pair.given.mean_luma());
  }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  tone.luma_offset = *middle;
  for (int pass = 0; pass < kPasses; ++pass) {
    LumaSums sums;
    for (const CellPair& pair : pairs) {
      sums.add(weight_of(pair, tone), pair.wanted.mean_luma() - black,
               pair.given.mean_luma() - black);
    }
    match_luma(sums, tone);
  }
  float weights = 0;
  std::array<float, 2> off{};
  for (const CellPair& pair : pairs) {
    const float weight = weight_of(pair, tone);
    weights += weight;
    for (std::size_t i = 0; i < off.size(); ++i) {
      off[i] += weight * (pair.wanted.chroma[i] - tone.chroma(pair.given.chroma[i], i));
    }
  }
  for (std::size_t i = 0; i < off.size(); ++i) tone.chroma_offset[i] = off[i] / weights;
  return tone;
}

}  // namespace gimbal
