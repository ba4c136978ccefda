#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/estimation.hpp"
#include "daemon/gimbalctl/warnings.hpp"
#include "daemon/stabilization.hpp"
#include "drivers/replay/decimal_time.hpp"
#include "drivers/replay/session.hpp"

namespace gimbal {
namespace {

struct Arguments {
  std::filesystem::path session;
  std::string out;
  std::string estimator = "ekf";
  bool causal = false;
  std::optional<double> lag_s;
};

constexpr double kLongestLag_s = 86400;

Result<Lookahead> lookahead_of(const Arguments& arguments) {
  if (arguments.lag_s && estimator_names().at(arguments.estimator) == EstimatorKind::thesis) {
    return bad_input(
        "--lag: the thesis' filter never looks ahead; leave it out, or --estimator ekf");
  }
  if (arguments.causal) return Lookahead::nothing();
  if (!arguments.lag_s) return Lookahead::everything();
  if (!(*arguments.lag_s >= 0 && *arguments.lag_s <= kLongestLag_s)) {
    return bad_input("--lag: expected seconds, from 0 to a day");
  }
  return Lookahead{duration_from_seconds(*arguments.lag_s)};
}

void write_ready(AttitudeStream& attitudes, std::ostream& stream) {
  while (const auto estimate = attitudes.pop()) {
    const auto& [time, q] = estimate->attitude;
    stream << fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                          format_seconds(time.time_since_epoch()), q.w(), q.x(), q.y(), q.z());
  }
}

Result<void> write_orientations(const Session& session, AttitudeStream& attitudes,
                                std::ostream& stream, const std::string& name) {
  stream << "t_s,qw,qx,qy,qz\n";
  auto replayed = replay_samples(session, [&](const ImuSample& sample) {
    attitudes.push(sample);
    write_ready(attitudes, stream);
  });
  if (!replayed) return replayed;
  attitudes.finish();
  write_ready(attitudes, stream);
  stream.flush();
  if (!stream) return failed(name + ": the orientations could not be written");
  if (!attitudes.suspicion().empty()) {
    const std::string warning(attitudes.suspicion());
    print_warnings({&warning, 1});
  }
  return {};
}

Result<void> run(const Arguments& arguments) {
  const auto session = open_session(arguments.session);
  if (!session) return tl::unexpected(session.error());
  print_warnings(session->warnings);
  if (session->gyro.empty()) {
    return bad_input(arguments.session.string() + ": no gyro samples, so no orientation");
  }
  const auto lookahead = lookahead_of(arguments);
  if (!lookahead) return tl::unexpected(lookahead.error());
  const auto attitudes = make_attitudes(estimator_names().at(arguments.estimator), *lookahead);
  if (arguments.out == "-") {
    return write_orientations(*session, *attitudes, std::cout, "standard output");
  }
  std::ofstream file(arguments.out);
  if (!file) return bad_input(arguments.out + ": cannot be written (does the folder exist?)");
  return write_orientations(*session, *attitudes, file, arguments.out);
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
                   "FILE.csv or - with t_s,qw,qx,qy,qz: q_world_imu, world z up (without an "
                   "accelerometer the world is the IMU at its first sample), at t_s: "
                   "the gyro's stamps less the delay of its filters")
      ->required();
  CLI::Option* causal =
      command->add_flag("--causal", arguments->causal,
                        "Use the past only, as a live camera has to [the whole recording]");
  command->add_option("--lag", arguments->lag_s, "Use so many seconds of future at most")
      ->excludes(causal);
  command->add_option("--estimator", arguments->estimator, "How orientation is estimated")
      ->transform(CLI::IsMember(names_of(estimator_names())))
      ->option_text("ekf|thesis [ekf]");
  command->callback([arguments, &outcome] { outcome = run(*arguments); });
}

}  // namespace gimbal
