#pragma once

#include <cstdint>

/// Registers of the MPU-6050 (RM-MPU-6000A, revision 4.2) and the MPU-6500 (RM-MPU-6500A, revision
/// 2.1) that the driver uses; the data sheets' names are beside them.
namespace gimbal::mpu6500 {

constexpr std::uint8_t kRateDivider = 0x19;      // SMPLRT_DIV
constexpr std::uint8_t kFilter = 0x1A;           // CONFIG: DLPF_CFG 2:0
constexpr std::uint8_t kGyroConfig = 0x1B;       // GYRO_CONFIG: FS_SEL 4:3
constexpr std::uint8_t kAccelConfig = 0x1C;      // ACCEL_CONFIG: AFS_SEL 4:3
constexpr std::uint8_t kAccelFilter = 0x1D;      // ACCEL_CONFIG 2: A_DLPF_CFG 2:0; not on the 6050
constexpr std::uint8_t kFifoSources = 0x23;      // FIFO_EN
constexpr std::uint8_t kInterruptPin = 0x37;     // INT_PIN_CFG
constexpr std::uint8_t kInterruptEnable = 0x38;  // INT_ENABLE
constexpr std::uint8_t kData = 0x3B;             // ACCEL_XOUT_H; then TEMP_OUT, GYRO_XOUT
constexpr std::uint8_t kUserControl = 0x6A;      // USER_CTRL
constexpr std::uint8_t kPower1 = 0x6B;           // PWR_MGMT_1
constexpr std::uint8_t kPower2 = 0x6C;           // PWR_MGMT_2
constexpr std::uint8_t kFifoCount = 0x72;        // FIFO_COUNTH, FIFO_COUNTL
constexpr std::uint8_t kFifoPort = 0x74;         // FIFO_R_W
constexpr std::uint8_t kIdentity = 0x75;         // WHO_AM_I

constexpr std::uint8_t kPower1Reset = 0x80;    // DEVICE_RESET
constexpr std::uint8_t kPower1Gyro = 0x01;     // CLKSEL: the gyroscope's PLL
constexpr std::uint8_t kUserFifoOn = 0x40;     // FIFO_EN
constexpr std::uint8_t kUserFifoReset = 0x04;  // FIFO_RESET
constexpr std::uint8_t kFifoGyroAccel = 0x78;  // XG, YG, ZG and ACCEL
constexpr std::uint8_t kInterruptDataReady = 0x01;

}  // namespace gimbal::mpu6500
