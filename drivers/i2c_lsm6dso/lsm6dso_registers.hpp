#pragma once

#include <cstdint>

/// Registers of the LSM6DSO (ST data sheet DS12140, application note AN5192) that the driver uses;
/// the data sheet's names are beside them.
namespace gimbal::lsm6dso {

constexpr std::uint8_t kFifoRates = 0x09;     // FIFO_CTRL3: BDR_GY 7:4, BDR_XL 3:0
constexpr std::uint8_t kFifoMode = 0x0A;      // FIFO_CTRL4: FIFO_MODE 2:0
constexpr std::uint8_t kInterrupt1 = 0x0D;    // INT1_CTRL
constexpr std::uint8_t kIdentity = 0x0F;      // WHO_AM_I
constexpr std::uint8_t kAccelControl = 0x10;  // CTRL1_XL: ODR_XL 7:4, FS_XL 3:2
constexpr std::uint8_t kGyroControl = 0x11;   // CTRL2_G: ODR_G 7:4, FS_G 3:2
constexpr std::uint8_t kControl3 = 0x12;      // CTRL3_C
constexpr std::uint8_t kData = 0x22;          // OUTX_L_G; then OUTX_L_A
constexpr std::uint8_t kFifoStatus = 0x3A;    // FIFO_STATUS1, FIFO_STATUS2
constexpr std::uint8_t kFifoPort = 0x78;      // FIFO_DATA_OUT_TAG; then six bytes of data
constexpr std::uint8_t kPulsedReady = 0x0B;   // COUNTER_BDR_REG1: dataready_pulsed 7

constexpr std::uint8_t kControl3Reset = 0x01;   // SW_RESET
constexpr std::uint8_t kControl3Normal = 0x44;  // BDU, IF_INC
constexpr std::uint8_t kPulsedReadyOn = 0x80;
constexpr std::uint8_t kInterrupt1Gyro = 0x02;  // INT1_DRDY_G
constexpr std::uint8_t kFifoBypass = 0x00;
constexpr std::uint8_t kFifoContinuous = 0x06;
constexpr std::uint8_t kStatus2Overrun = 0x48;  // FIFO_OVR_IA, FIFO_OVR_LATCHED
constexpr std::uint8_t kStatus2Count = 0x03;    // DIFF_FIFO 9:8
constexpr std::uint8_t kTagGyro = 0x01;         // TAG_SENSOR
constexpr std::uint8_t kTagAccel = 0x02;
constexpr std::uint8_t kTagCount = 0x06;  // TAG_CNT: the same for what is of one instant

}  // namespace gimbal::lsm6dso
