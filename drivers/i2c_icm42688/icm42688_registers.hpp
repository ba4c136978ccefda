#pragma once

#include <cstdint>

/// Registers of bank 0 of the ICM-42688-P (TDK data sheet DS-000347) that the driver uses; the data
/// sheet's names are beside them.
namespace gimbal::icm42688 {

constexpr std::uint8_t kReset = 0x11;             // DEVICE_CONFIG
constexpr std::uint8_t kInterruptPin = 0x14;      // INT_CONFIG
constexpr std::uint8_t kFifoMode = 0x16;          // FIFO_CONFIG
constexpr std::uint8_t kData = 0x1F;              // ACCEL_DATA_X1; then GYRO_DATA
constexpr std::uint8_t kFifoCount = 0x2E;         // FIFO_COUNTH, FIFO_COUNTL
constexpr std::uint8_t kFifoPort = 0x30;          // FIFO_DATA
constexpr std::uint8_t kSignalPath = 0x4B;        // SIGNAL_PATH_RESET
constexpr std::uint8_t kInterface0 = 0x4C;        // INTF_CONFIG0
constexpr std::uint8_t kPower = 0x4E;             // PWR_MGMT0
constexpr std::uint8_t kGyroConfig = 0x4F;        // GYRO_CONFIG0: GYRO_FS_SEL 7:5, GYRO_ODR 3:0
constexpr std::uint8_t kAccelConfig = 0x50;       // ACCEL_CONFIG0: ACCEL_FS_SEL 7:5, ACCEL_ODR 3:0
constexpr std::uint8_t kFifoSources = 0x5F;       // FIFO_CONFIG1
constexpr std::uint8_t kInterruptConfig1 = 0x64;  // INT_CONFIG1
constexpr std::uint8_t kInterruptSource = 0x65;   // INT_SOURCE0
constexpr std::uint8_t kIdentity = 0x75;          // WHO_AM_I
constexpr std::uint8_t kBank = 0x76;              // REG_BANK_SEL

constexpr std::uint8_t kResetNow = 0x01;           // SOFT_RESET_CONFIG
constexpr std::uint8_t kInterface0Records = 0x70;  // FIFO_COUNT_REC; both ENDIANs big
constexpr std::uint8_t kPowerLowNoise = 0x0F;      // GYRO_MODE and ACCEL_MODE
constexpr std::uint8_t kFifoStream = 0x40;         // FIFO_MODE
constexpr std::uint8_t kFifoBypass = 0x00;
constexpr std::uint8_t kFifoPackets = 0x47;      // RESUME_PARTIAL_RD, TEMP, GYRO, ACCEL
constexpr std::uint8_t kSignalPathFlush = 0x02;  // FIFO_FLUSH
constexpr std::uint8_t kPinPulsed = 0x03;        // INT1: push-pull, active high, pulsed
constexpr std::uint8_t kSourceDataReady = 0x08;  // UI_DRDY_INT1_EN
constexpr std::uint8_t kHeaderEmpty = 0x80;      // of a packet: HEADER_MSG
constexpr std::uint8_t kHeaderKinds = 0x70;      // HEADER_ACCEL, HEADER_GYRO, HEADER_20
constexpr std::uint8_t kHeaderGyroAccel = 0x60;

}  // namespace gimbal::icm42688
