// Samples that no filter should believe, through `gimbalctl orient` from end to end: whatever came,
// the orientations are numbers in order of time, the tilt is right again some seconds later, and a
// line says what was odd.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/sample/attitude.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kInterval_s = 0.005;
constexpr double kDuration_s = 60;
constexpr double kSpoilt_s = 20;    ///< where most of the damage begins ...
constexpr double kRepaired_s = 40;  ///< ... and by when the tilt is right again
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Row {
  double t_s;
  Eigen::Vector3d value;
};

struct Recording {
  std::vector<Row> gyro;
  std::vector<Row> accel;
};

Eigen::Quaterniond truth(double t) {
  const Eigen::AngleAxisd x(0.5 * std::sin(2.1 * t), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd y(0.6 * std::sin(1.4 * t + 1), Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd z(0.6 * std::sin(0.9 * t + 2), Eigen::Vector3d::UnitZ());
  return x * y * z;
}

/// A hand, with the noise of a phone's sensors.
Recording hand() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) -> Eigen::Vector3d {
    const double x = normal(random);
    const double y = normal(random);
    return sigma * Eigen::Vector3d(x, y, normal(random));
  };
  Recording recording;
  for (int i = 0; i * kInterval_s < kDuration_s; ++i) {
    const double t = i * kInterval_s;
    constexpr double kInstant_s = 1e-4;
    const Eigen::AngleAxisd turn(truth(t - kInstant_s / 2).conjugate() * truth(t + kInstant_s / 2));
    const Eigen::Vector3d push(1.2 * std::sin(7 * t), 0.8 * std::sin(5 * t), 0.5 * std::cos(9 * t));
    recording.gyro.push_back({t, turn.angle() / kInstant_s * turn.axis() + noise(0.003)});
    recording.accel.push_back(
        {t, truth(t).conjugate() * (push + Eigen::Vector3d(0, 0, 9.81)) + noise(0.05)});
  }
  return recording;
}

std::size_t row_at(double t) {
  return static_cast<std::size_t>(std::lround(t / kInterval_s));
}

void write(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::ofstream stream(file);
  stream.precision(12);
  stream << "t_s,x,y,z\n";
  for (const auto& [t_s, value] : rows) {
    stream << t_s << ',' << value.x() << ',' << value.y() << ',' << value.z() << '\n';
  }
}

struct Case {
  std::string name;
  std::string said;
  std::function<void(Recording&)> spoil;
  double worst_deg = 2;  ///< tilt, once it is repaired
};

void PrintTo(const Case& c, std::ostream* stream) {
  *stream << c.name;
}

/// Changes some samples of both sensors, alone and in a row.
void change_some(Recording& recording, const std::function<void(Row&, const Row& before)>& change) {
  for (const double t : {20.0, 20.1, 20.105, 20.11, 25.0, 30.0}) {
    const std::size_t i = row_at(t);
    change(recording.gyro[i], recording.gyro[i - 1]);
    change(recording.accel[i], recording.accel[i - 1]);
  }
}

void scale(std::vector<Row>& rows, double factor) {
  for (Row& row : rows) row.value *= factor;
}

void stick(std::vector<Row>& rows, double value) {
  for (std::size_t i = row_at(kSpoilt_s); i < row_at(kSpoilt_s + 5); ++i) rows[i].value.y() = value;
}

void remove(std::vector<Row>& rows, double length_s) {
  const auto at = [&](double t) { return rows.begin() + static_cast<std::ptrdiff_t>(row_at(t)); };
  rows.erase(at(kSpoilt_s), at(kSpoilt_s + length_s));
}

constexpr double kAnything_deg = 180;

std::vector<Case> cases() {
  return {
      {"not_a_number", "not finite",
       [](Recording& r) { change_some(r, [](Row& row, const Row&) { row.value.y() = kNan; }); }},
      {"infinite", "not finite",
       [](Recording& r) {
         change_some(r, [](Row& row, const Row&) { row.value.x() = -kInfinity; });
       }},
      {"huge", "faster than gyros measure",
       [](Recording& r) { change_some(r, [](Row& row, const Row&) { row.value.z() = 1e300; }); }},
      {"repeated_stamp", "stamps do not rise",
       [](Recording& r) {
         change_some(r, [](Row& row, const Row& before) { row.t_s = before.t_s; });
       }},
      {"backward_stamp", "stamps do not rise",
       [](Recording& r) { change_some(r, [](Row& row, const Row&) { row.t_s -= 1; }); }},
      {"stamp_that_is_none", "not finite",
       [](Recording& r) { change_some(r, [](Row& row, const Row&) { row.t_s = kNan; }); }},
      {"stamp_an_hour_ahead", "stamps do not rise",
       [](Recording& r) { change_some(r, [](Row& row, const Row&) { row.t_s += 3600; }); }},
      {"hole_of_ten_seconds", "gap",
       [](Recording& r) {
         remove(r.gyro, 10);
         remove(r.accel, 10);
       }},
      {"gyro_axis_stuck", "an axis of the gyroscope", [](Recording& r) { stick(r.gyro, 0.31); }},
      {"accel_axis_stuck", "an axis of the accelerometer", [](Recording& r) { stick(r.accel, 4); }},
      {"gyro_in_degrees", "deg/s", [](Recording& r) { scale(r.gyro, 1 / kDegree); }, kAnything_deg},
      // 4000 deg/s in 16 bits.
      {"gyro_raw", "raw counts", [](Recording& r) { scale(r.gyro, 470); }, kAnything_deg},
      {"accel_in_g", "gravity", [](Recording& r) { scale(r.accel, 1 / 9.81); }, kAnything_deg},
      {"accel_in_mg", "gravity", [](Recording& r) { scale(r.accel, 1e3 / 9.81); }, kAnything_deg},
  };
}

struct Answer {
  double t_s;
  Eigen::Quaterniond q_world_imu;
};

std::vector<Answer> read_answers(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::vector<Answer> answers;
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    std::array<double, 5> values{};
    for (double& value : values) {
      std::string field;
      std::getline(fields, field, ',');
      value = std::stod(field);
    }
    answers.push_back({values[0], {values[1], values[2], values[3], values[4]}});
  }
  return answers;
}

double tilt_deg(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return std::acos(std::min(1.0, (a.conjugate() * z).dot(b.conjugate() * z))) / kDegree;
}

void expect_sound(const std::vector<Answer>& answers, double worst_allowed_deg) {
  double last_s = -kInfinity;
  double worst_deg = 0;
  for (const auto& [t_s, q] : answers) {
    ASSERT_GT(t_s, last_s);
    last_s = t_s;
    ASSERT_NEAR(q.norm(), 1, 1e-6);
    if (t_s > kRepaired_s) worst_deg = std::max(worst_deg, tilt_deg(q, truth(t_s)));
  }
  EXPECT_NEAR(last_s, kDuration_s, 0.1);
  EXPECT_LT(worst_deg, worst_allowed_deg);
}

class OrientBadSamples : public ::testing::TestWithParam<Case> {
 protected:
  OrientBadSamples() {
    folder_.write("session.toml",
                  "[imu]\naccel_unit = \"m/s2\"\naccel_sign = \"specific-force\"\n"
                  "delay_s = 0.0\n");
    Recording recording = hand();
    GetParam().spoil(recording);
    write(folder_.path() / "gyro.csv", recording.gyro);
    write(folder_.path() / "accel.csv", recording.accel);
  }

  /// Runs the program and reads what it wrote.
  [[nodiscard]] std::vector<Answer> orient(const std::vector<std::string>& options) const {
    const std::filesystem::path out = folder_.path() / "out.csv";
    std::vector<std::string> command{GIMBALCTL, "orient", folder_.path(), "-o", out};
    command.insert(command.end(), options.begin(), options.end());
    const test::ProgramRun run = test::run_program(command, 60);
    EXPECT_EQ(run.exit_status, 0) << run.standard_error;
    EXPECT_THAT(run.standard_error, HasSubstr(GetParam().said));
    return read_answers(out);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_P(OrientBadSamples, NeverPoisonTheOrientation) {
  using Options = std::vector<std::string>;
  for (const Options& options : {Options{"--causal"}, Options{"--lag", "1"}, Options{}}) {
    expect_sound(orient(options), GetParam().worst_deg);
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, OrientBadSamples, ::testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace gimbal
