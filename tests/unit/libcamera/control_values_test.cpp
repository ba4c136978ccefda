#include "drivers/libcamera/control_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace gimbal {
namespace {

namespace controls = libcamera::controls;
using libcamera::ControlInfo;
using libcamera::ControlValue;
using ::testing::HasSubstr;

const libcamera::ControlInfoMap& known() {
  static const libcamera::ControlInfoMap map(
      {{&controls::ExposureTime, ControlInfo(std::int32_t{100}, std::int32_t{66'666})},
       {&controls::AnalogueGain, ControlInfo(1.0F, 16.0F)},
       {&controls::AeEnable, ControlInfo(false, true)},
       {&controls::ColourGains, ControlInfo(0.0F, 32.0F)}},
      controls::controls);
  return map;
}

std::string error_of(const std::map<std::string, std::vector<double>>& values) {
  const auto list = control_list(known(), values);
  return list ? std::string() : list.error().message;
}

TEST(ControlList, EachValueHasItsControlsType) {
  const auto list = control_list(known(), {{"ExposureTime", {8000}},
                                           {"AnalogueGain", {2.5}},
                                           {"AeEnable", {0}},
                                           {"ColourGains", {1.5, 2}}});
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_EQ(list->get(controls::ExposureTime), 8000);
  EXPECT_EQ(list->get(controls::AnalogueGain), 2.5F);
  EXPECT_EQ(list->get(controls::AeEnable), false);
  const auto gains = list->get(controls::ColourGains);
  ASSERT_TRUE(gains);
  EXPECT_EQ((*gains)[0], 1.5F);
  EXPECT_EQ((*gains)[1], 2.0F);
}

TEST(ControlList, AnUnknownNameListsThoseThatThereAre) {
  EXPECT_EQ(error_of({{"Exposure", {1}}}),
            "has no control Exposure; it has AeEnable, AnalogueGain, ColourGains, ExposureTime");
}

TEST(ControlList, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(error_of({{"ExposureTime", {99}}}), HasSubstr("[100..66666]"));
  EXPECT_THAT(error_of({{"AnalogueGain", {17}}}), HasSubstr("has to be"));
  EXPECT_THAT(error_of({{"ExposureTime", {1000.5}}}), HasSubstr("does not take 1000.5"));
  EXPECT_THAT(error_of({{"ExposureTime", {1e12}}}), HasSubstr("does not take"));
  EXPECT_THAT(error_of({{"AnalogueGain", {std::nan("")}}}), HasSubstr("does not take nan"));
  EXPECT_THAT(error_of({{"ExposureTime", {}}}), HasSubstr("has no value"));
}

}  // namespace
}  // namespace gimbal
