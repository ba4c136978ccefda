#include "pipeline/calibration/flashing_light.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "pipeline/calibration/line_bands.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFewestFrames = 10;
constexpr double kLeastContrast = 0.001;
constexpr double kLeastShare = 0.03;  // of the changes, that the best sine explains
constexpr double kLeastOfBest = 0.1;  // less is rather a harmonic of what explains more
constexpr double kFewestBands = 1.5;
constexpr double kNarrowestBand_lines = 6;
constexpr double kBandStep = 0.1;
constexpr double kLeastCoherence = 0.5;
constexpr double kMostAstray_rad = 0.2;  // a frame
constexpr std::size_t kMostPeaks = 6;
constexpr std::size_t kParts = 6;  // of the recording, for the uncertainty
constexpr std::array<double, 2> kMains_hz = {100, 120};
constexpr std::array<int, 1> kFundamental = {1};
constexpr std::array<int, 3> kOddHarmonics = {1, 3, 5};

using Spectrum = std::vector<std::pair<double, double>>;

Spectrum spectrum_of(const LineBands& bands) {
  const double most = static_cast<double>(bands.lines()) / kNarrowestBand_lines;
  const auto steps = static_cast<int>((most - kFewestBands) / kBandStep);
  Spectrum spectrum;
  for (int step = 0; step <= steps; ++step) {
    const double number = kFewestBands + step * kBandStep;
    spectrum.emplace_back(number, bands.explained(number));
  }
  return spectrum;
}

/// Numbers of bands that explain more than their neighbours do, the best first.
std::vector<double> peaks_of(const Spectrum& spectrum) {
  Spectrum peaks;
  for (std::size_t i = 1; i + 1 < spectrum.size(); ++i) {
    const double here = spectrum[i].second;
    if (here > spectrum[i - 1].second && here >= spectrum[i + 1].second) {
      peaks.push_back(spectrum[i]);
    }
  }
  std::sort(peaks.begin(), peaks.end(),
            [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<double> numbers;
  for (const auto& [number, share] : peaks) {
    const bool counts = share > kLeastShare && share > kLeastOfBest * peaks.front().second;
    if (counts && numbers.size() < kMostPeaks) numbers.push_back(number);
  }
  return numbers;
}

/// The best number within a step of the spectrum, by golden sections.
double refined(const LineBands& bands, double near) {
  constexpr double kGolden = 0.6180339887498949;
  double low = near - kBandStep;
  double high = near + kBandStep;
  for (int round = 0; round < 24; ++round) {
    const double left = high - kGolden * (high - low);
    const double right = low + kGolden * (high - low);
    (bands.explained(left) > bands.explained(right) ? high : low) =
        bands.explained(left) > bands.explained(right) ? right : left;
  }
  return (low + high) / 2;
}

/// How the bands move on from frame to frame, against a light of this frequency: 1 if as that, on a
/// circle about zero if as another, near zero if at random.
std::complex<double> coherence(const LineBands& bands, double number,
                               std::span<const LineProfile> profiles, double light_hz) {
  const Eigen::MatrixXcd amplitudes = bands.amplitudes(number, kFundamental);
  std::complex<double> together = 0;
  double all = 0;
  for (std::size_t i = 0; i + 1 < profiles.size(); ++i) {
    const double turns = light_hz * (profiles[i + 1].time_s - profiles[i].time_s);
    const auto expected = std::polar(1.0, 2 * std::numbers::pi * (turns - std::floor(turns)));
    const std::complex<double> now = amplitudes(0, static_cast<Eigen::Index>(i));
    const std::complex<double> next = amplitudes(0, static_cast<Eigen::Index>(i + 1));
    together += next * std::conj(now * expected);
    all += std::abs(next) * std::abs(now);
  }
  return all > 0 ? together / all : 0;
}

bool is_of(const LineBands& bands, double number, std::span<const LineProfile> profiles,
           double light_hz) {
  const auto found = coherence(bands, refined(bands, number), profiles, light_hz);
  return std::abs(found) > kLeastCoherence && std::abs(std::arg(found)) < kMostAstray_rad;
}

/// How parts of the recording differ from each other tells how much the whole may be off.
double bands_sigma(std::span<const LineProfile> profiles, double number) {
  const std::size_t length = profiles.size() / kParts;
  if (length < 2) return number;
  std::vector<double> numbers;
  for (std::size_t part = 0; part < kParts; ++part) {
    numbers.push_back(refined(LineBands(profiles.subspan(part * length, length)), number));
  }
  double sum = 0;
  for (const double of_part : numbers) sum += (of_part - number) * (of_part - number);
  return std::sqrt(sum / (kParts * (kParts - 1)));
}

/// sin(pi x) / (pi x): what is left of a sine after x of its periods were exposed.
double sinc(double x) {
  const double angle = std::numbers::pi * x;
  return x == 0 ? 1 : std::sin(angle) / angle;
}

/// Periods of the light that are exposed, less than half of one, since as much less than a whole
/// leaves the same harmonics; from how much of the square wave's harmonics is left: the
/// n-th, odd, of 1/n of the first.
std::optional<double> exposed_periods(const LineBands& bands, double number) {
  constexpr int kSteps = 2000;
  constexpr double kMostMisfit = 0.05;
  const Eigen::MatrixXcd amplitudes = bands.amplitudes(number, kOddHarmonics);
  const Eigen::Vector3d found = amplitudes.cwiseAbs2().rowwise().mean().cwiseSqrt();
  double least = found.squaredNorm();
  std::optional<double> periods;
  for (int step = 1; step < kSteps; ++step) {
    const double exposed = 0.5 * step / kSteps;
    Eigen::Vector3d model;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const int harmonic = kOddHarmonics.at(static_cast<std::size_t>(i));
      model[i] = std::abs(sinc(harmonic * exposed)) / harmonic;
    }
    const double misfit = found.squaredNorm() - std::pow(found.dot(model), 2) / model.squaredNorm();
    if (misfit >= least) continue;
    least = misfit;
    periods = exposed;
  }
  if (least > kMostMisfit * kMostMisfit * found.squaredNorm()) return std::nullopt;
  return periods;
}

/// What else the bands may come from.
std::string other_light(const LineBands& bands, std::span<const double> peaks,
                        std::span<const LineProfile> profiles, double light_hz) {
  for (const double mains_hz : kMains_hz) {
    if (is_of(bands, peaks.front(), profiles, mains_hz)) {
      return fmt::format(
          "the bands are those of a lamp on the mains ({:g} Hz), not of {:g} Hz; "
          "switch it off",
          mains_hz, light_hz);
    }
  }
  return fmt::format("the bands do not move on from frame to frame as those of {:g} Hz would",
                     light_hz);
}

/// Whether frames cannot tell two lights apart.
bool move_alike(double light_hz, double other_hz, double interval_s) {
  const double turns = (light_hz - other_hz) * interval_s;
  return 2 * std::numbers::pi * std::abs(turns - std::round(turns)) < 1.5 * kMostAstray_rad;
}

std::string unfit(std::span<const LineProfile> profiles, double light_hz) {
  if (profiles.size() < kFewestFrames) {
    return fmt::format("there are only {} frames; {} are needed", profiles.size(), kFewestFrames);
  }
  const double span_s = profiles.back().time_s - profiles.front().time_s;
  const double interval_s = span_s / static_cast<double>(profiles.size() - 1);
  if (move_alike(light_hz, 0, interval_s)) {
    return fmt::format(
        "{:g} Hz is a multiple of the frame rate, so that the bands stand still; "
        "take some Hz more",
        light_hz);
  }
  for (const double mains_hz : kMains_hz) {
    if (move_alike(light_hz, mains_hz, interval_s)) {
      return fmt::format(
          "at this frame rate {:g} Hz looks like a lamp on the mains ({:g} Hz); "
          "take some Hz more",
          light_hz, mains_hz);
    }
  }
  return "";
}

}  // namespace

FlashingLight measure_flashing_light(std::span<const LineProfile> profiles, double light_hz) {
  FlashingLight found;
  found.reason = unfit(profiles, light_hz);
  if (!found.reason.empty()) return found;
  const LineBands bands(profiles);
  found.spectrum = spectrum_of(bands);
  const std::vector<double> peaks = peaks_of(found.spectrum);
  if (bands.contrast() < kLeastContrast || peaks.empty()) {
    found.reason = "there are no bands; light the whole picture and take a short exposure";
    return found;
  }
  const auto right = std::find_if(peaks.begin(), peaks.end(), [&](double number) {
    return is_of(bands, number, profiles, light_hz);
  });
  if (right == peaks.end()) {
    found.reason = other_light(bands, peaks, profiles, light_hz);
    return found;
  }
  found.bands = refined(bands, *right);
  found.coherence = std::abs(coherence(bands, found.bands, profiles, light_hz));
  found.readout_s = found.bands / light_hz;
  found.readout_sigma_s = bands_sigma(profiles, found.bands) / light_hz;
  if (const auto periods = exposed_periods(bands, found.bands)) {
    found.exposure_s = *periods / light_hz;
  }
  if (!(found.readout_sigma_s < 0.01 * found.readout_s)) {
    found.reason = fmt::format("the readout is only known to {:.1f} %; record for longer",
                               200 * found.readout_sigma_s / found.readout_s);
  }
  return found;
}

}  // namespace gimbal
