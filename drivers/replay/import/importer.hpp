#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "drivers/replay/lens_file.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A kind of recording that is not a session folder. `recognises` looks at names and contents only,
/// and answers for at most one kind. `read` gives a session with the recording's stamps as they are
/// (odd ones included: opening the written session deals with them), its video where it lies, no
/// folder, and in `notes` where each number comes from.
struct Importer {
  std::string_view kind;
  bool (*recognises)(const std::filesystem::path& input);
  Result<Session> (*read)(const std::filesystem::path& input);
};

/// All of them, in the order in which they are asked.
[[nodiscard]] std::span<const Importer> importers();

/// Turns a recording of any known kind into a session folder, which must not exist or be empty, and
/// opens it: the answer's warnings say what is odd about the recording. Leaves nothing behind if
/// the recording turns out to be unusable. `lens`: what is known of the camera from elsewhere, in
/// the place of what the recording says; fitted to the recording's size.
[[nodiscard]] Result<Session> import_session(const std::filesystem::path& input,
                                             const std::filesystem::path& folder,
                                             const std::optional<LensFile>& lens = std::nullopt);

/// One a kind, for the table.
extern const Importer kMetaJsonImporter;
extern const Importer kGoProImporter;
extern const Importer kIosLoggerImporter;
extern const Importer kCoreMotionLogImporter;
extern const Importer kAndroidLogImporter;
extern const Importer kGyroflowImporter;

}  // namespace gimbal
