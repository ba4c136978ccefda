#include "daemon/journal.hpp"

#include <gtest/gtest.h>

namespace gimbal {
namespace {

using Fields = std::vector<std::string>;

TEST(Journal, AnEntryHasWhatOneSearchesFor) {
  const Fields expected{"MESSAGE=output rtsp: refused", "PRIORITY=3", "SYSLOG_IDENTIFIER=gimbald",
                        "GIMBALD_PART=output", "GIMBALD_NAME=rtsp"};
  EXPECT_EQ(journal_fields(LogLevel::error, "output rtsp: refused", {"output", "rtsp"}, 0),
            expected);
}

TEST(Journal, WhatIsNotKnownIsLeftOut) {
  const Fields expected{"MESSAGE=all is well", "PRIORITY=6", "SYSLOG_IDENTIFIER=gimbald"};
  EXPECT_EQ(journal_fields(LogLevel::info, "all is well", {}, 0), expected);
}

TEST(Journal, LinesThatWereHeldBackAreCounted) {
  const Fields fields = journal_fields(LogLevel::warning, "late", {"camera", {}}, 17);
  EXPECT_EQ(fields.back(), "GIMBALD_HELD_BACK=17");
}

/// A terminal or a file may be standard error in a service as well.
TEST(Journal, AStreamThatIsNotTheJournalGetsTheLine) {
  ::setenv("JOURNAL_STREAM", "1:1", 1);
  ::testing::internal::CaptureStderr();
  log_line(LogLevel::info, "to whom it may concern", {"camera", {}});
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "gimbald: to whom it may concern\n");
  ::unsetenv("JOURNAL_STREAM");
}

}  // namespace
}  // namespace gimbal
