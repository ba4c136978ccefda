#include "pipeline/intrinsics/board.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string_view>

namespace gimbal {
namespace {

constexpr int kFewest = 3;
constexpr int kMost = 50;

bool parse_counts(std::string_view text, CalibrationBoard& board) {
  const char* const end = text.data() + text.size();
  const auto columns = std::from_chars(text.data(), end, board.columns);
  if (columns.ec != std::errc() || columns.ptr == end || *columns.ptr != 'x') return false;
  const auto rows = std::from_chars(columns.ptr + 1, end, board.rows);
  return rows.ec == std::errc() && rows.ptr == end;
}

bool is_size(int count) {
  return count >= kFewest && count <= kMost;
}

}  // namespace

int CalibrationBoard::corner_count() const {
  return kind == BoardKind::checkerboard ? columns * rows : (columns - 1) * (rows - 1);
}

Result<CalibrationBoard> parse_board(const std::string& text) {
  const auto colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  CalibrationBoard board;
  board.kind = kind == "charuco" ? BoardKind::charuco : BoardKind::checkerboard;
  const bool is_kind = kind == "charuco" || kind == "checkerboard";
  if (!is_kind || colon == std::string::npos ||
      !parse_counts(std::string_view(text).substr(colon + 1), board)) {
    return bad_input(fmt::format(
        "board \"{}\" is neither of the form checkerboard:9x6 (inner corners) nor charuco:5x7 "
        "(squares)",
        text));
  }
  if (!is_size(board.columns) || !is_size(board.rows)) {
    return bad_input(
        fmt::format("board \"{}\": {} to {} a side are allowed", text, kFewest, kMost));
  }
  return board;
}

}  // namespace gimbal
