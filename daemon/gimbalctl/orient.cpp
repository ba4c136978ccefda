#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/estimation.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/decimal_time.hpp"
#include "drivers/replay/session.hpp"

namespace gimbal {
namespace {

struct Arguments {
  std::filesystem::path session;
  std::string out;
  EstimatorKind estimator = EstimatorKind::thesis;
};

Result<void> write_orientations(const Session& session, Estimator& estimator, std::ostream& stream,
                                const std::string& name) {
  stream << "t_s,qw,qx,qy,qz\n";
  const auto replayed = replay_samples(session, [&](const ImuSample& sample) {
    const Attitude attitude = estimator.update(sample);
    const Eigen::Quaterniond& q = attitude.q_world_imu;
    stream << fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                          format_seconds(attitude.time.time_since_epoch()), q.w(), q.x(), q.y(),
                          q.z());
  });
  if (!replayed) return replayed;
  stream.flush();
  if (!stream) return failed(name + ": the orientations could not be written");
  return {};
}

Result<void> run(const Arguments& arguments) {
  const auto session = open_session(arguments.session);
  if (!session) return tl::unexpected(session.error());
  print_warnings(session->warnings);
  if (session->gyro.empty()) {
    return bad_input(arguments.session.string() + ": no gyro samples, so no orientation");
  }
  const auto estimator = make_estimator(arguments.estimator);
  if (arguments.out == "-") {
    return write_orientations(*session, *estimator, std::cout, "standard output");
  }
  std::ofstream file(arguments.out);
  if (!file) return bad_input(arguments.out + ": cannot be written (does the folder exist?)");
  return write_orientations(*session, *estimator, file, arguments.out);
}

}  // namespace

void add_orient_command(CLI::App& app, CommandOutcome& outcome) {
  CLI::App* command =
      app.add_subcommand("orient", "Write the IMU's orientation at every gyro sample");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("session", arguments->session, "Session folder, camera not needed")
      ->required();
  command
      ->add_option("-o,--output", arguments->out,
                   "FILE.csv or - with t_s,qw,qx,qy,qz: q_world_imu, world z up")
      ->required();
  command->add_flag_callback(
      "--causal", [] {}, "Use the past only, which is all that the thesis' filter ever uses");
  command->add_option("--estimator", arguments->estimator, "How orientation is estimated")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, EstimatorKind>{{"thesis", EstimatorKind::thesis}}))
      ->option_text("thesis [thesis]");
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
