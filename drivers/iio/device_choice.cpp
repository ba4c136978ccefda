#include "drivers/iio/device_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace gimbal {
namespace {

using Candidates = std::vector<IioCandidate>;

constexpr std::string_view kAuto = "auto";
constexpr std::string_view kNone = "none";

bool is_called(const IioCandidate& candidate, std::string_view wanted) {
  return candidate.id == wanted || candidate.name == wanted || candidate.label == wanted;
}

/// What is left of "icm42605-gyro" and "icm42605-accel" when the sensor's kind is taken out.
std::string family_of(const IioCandidate& candidate) {
  std::string name = candidate.name;
  for (const std::string_view kind : {"anglvel", "accel", "gyro"}) {
    if (const auto at = name.find(kind); at != std::string::npos) name.erase(at, kind.size());
  }
  return name;
}

template <typename Fits>
const IioCandidate* find(const Candidates& candidates, Fits fits) {
  const auto found = std::find_if(candidates.begin(), candidates.end(), fits);
  return found != candidates.end() ? &*found : nullptr;
}

/// The first that fits and is usable, else the first that fits.
template <typename Fits>
const IioCandidate* find_best(const Candidates& candidates, Fits fits) {
  const auto* usable =
      find(candidates, [&](const auto& it) { return fits(it) && it.obstacle.empty(); });
  return usable != nullptr ? usable : find(candidates, fits);
}

std::string titles_of(const Candidates& candidates) {
  std::string titles;
  for (const auto& candidate : candidates) {
    titles += (titles.empty() ? "" : ", ") + candidate.title();
  }
  return titles.empty() ? "none" : titles;
}

const IioCandidate* automatic_gyro(const Candidates& candidates) {
  const auto is_6_axis = [](const auto& it) {
    return it.has_gyro && it.has_accel && it.obstacle.empty();
  };
  if (const auto* found = find(candidates, is_6_axis)) return found;
  return find_best(candidates, [](const auto& it) { return it.has_gyro; });
}

const IioCandidate* automatic_accel(const Candidates& candidates, const IioCandidate& gyro) {
  if (gyro.has_accel) return &gyro;
  const auto* kin = find(candidates, [&](const auto& it) {
    return it.has_accel && it.obstacle.empty() && family_of(it) == family_of(gyro);
  });
  if (kin != nullptr) return kin;
  return find(candidates, [](const auto& it) { return it.has_accel && it.obstacle.empty(); });
}

Result<const IioCandidate*> choose_gyro(const Candidates& candidates, std::string_view wanted) {
  const auto* gyro =
      wanted == kAuto ? automatic_gyro(candidates) : find_best(candidates, [&](const auto& it) {
        return it.has_gyro && is_called(it, wanted);
      });
  if (gyro == nullptr) {
    return bad_input(fmt::format("iio: no gyroscope \"{}\"; inertial devices here: {}", wanted,
                                 titles_of(candidates)));
  }
  if (!gyro->obstacle.empty()) {
    return bad_input(fmt::format("{}: {}", gyro->title(), gyro->obstacle));
  }
  return gyro;
}

Result<const IioCandidate*> choose_accel(const Candidates& candidates, std::string_view wanted,
                                         const IioCandidate& gyro) {
  if (wanted == kAuto) {
    if (const auto* accel = automatic_accel(candidates, gyro)) return accel;
    return bad_input(fmt::format(
        "{}: no usable accelerometer goes with it; say accel_device = \"none\" to do without",
        gyro.title()));
  }
  const auto* accel =
      find_best(candidates, [&](const auto& it) { return it.has_accel && is_called(it, wanted); });
  if (accel == nullptr) {
    return bad_input(fmt::format("iio: no accelerometer \"{}\"; inertial devices here: {}", wanted,
                                 titles_of(candidates)));
  }
  if (!accel->obstacle.empty()) {
    return bad_input(fmt::format("{}: {}", accel->title(), accel->obstacle));
  }
  return accel;
}

}  // namespace

std::string IioCandidate::title() const {
  return name.empty() ? id : fmt::format("{} ({})", id, name);
}

Result<IioChoice> choose_devices(const Candidates& candidates, const IioImuSettings& settings) {
  const auto gyro = choose_gyro(candidates, settings.device);
  if (!gyro) return tl::unexpected(gyro.error());
  IioChoice choice{.gyro = (*gyro)->id, .accel = {}};
  if (settings.accel_device == kNone) return choice;
  const auto accel = choose_accel(candidates, settings.accel_device, **gyro);
  if (!accel) return tl::unexpected(accel.error());
  choice.accel = (*accel)->id;
  return choice;
}

}  // namespace gimbal
