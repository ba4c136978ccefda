#include "pipeline/smoother/attitude_stream.hpp"

#include <deque>
#include <utility>

#include "pipeline/estimator/plausibility.hpp"
#include "pipeline/estimator/spike_gate.hpp"
#include "pipeline/smoother/gradual_correction.hpp"

namespace gimbal {
namespace {

std::optional<AttitudeEstimate> take_first(std::deque<AttitudeEstimate>& ready) {
  if (ready.empty()) return std::nullopt;
  const AttitudeEstimate first = ready.front();
  ready.pop_front();
  return first;
}

std::optional<GyroBias> learned_bias(const AttitudeEkf& filter) {
  if (!filter.state().last || filter.plausibility() != Plausibility::plausible) return std::nullopt;
  return filter.gyro_bias();
}

class PlainStream final : public AttitudeStream {
 public:
  explicit PlainStream(std::unique_ptr<Estimator> estimator) : estimator_(std::move(estimator)) {}

  void push(const ImuSample& sample) override {
    ready_.push_back({estimator_->update(sample), kUnknownAngle_rad2 * Eigen::Matrix3d::Identity(),
                      AttitudeOrigin::exact});
  }

  void finish() override {}

  std::optional<AttitudeEstimate> pop() override { return take_first(ready_); }

  [[nodiscard]] std::string_view suspicion() const override { return {}; }
  [[nodiscard]] std::optional<GyroBias> gyro_bias() const override { return std::nullopt; }

 private:
  std::unique_ptr<Estimator> estimator_;
  std::deque<AttitudeEstimate> ready_;
};

class CausalStream final : public AttitudeStream {
 public:
  explicit CausalStream(const AttitudeEkfParameters& parameters,
                        std::optional<GradualCorrection> correction = std::nullopt)
      : filter_(parameters), correction_(correction) {}

  void push(const ImuSample& sample) override { take(gate_.push(sample)); }
  void finish() override { take(gate_.finish()); }

  std::optional<AttitudeEstimate> pop() override { return take_first(ready_); }

  [[nodiscard]] std::string_view suspicion() const override {
    return describe(filter_.plausibility());
  }
  [[nodiscard]] std::optional<GyroBias> gyro_bias() const override { return learned_bias(filter_); }

 private:
  void take(const SpikeGate::Passed& passed) {
    for (std::size_t i = 0; i < passed.count; ++i) {
      const ImuSample& sample = passed.samples[i];
      const std::size_t skipped = filter_.counts().skipped_gyro;
      filter_.update(sample);
      if (filter_.counts().skipped_gyro != skipped) continue;
      AttitudeEstimate answer = filter_.predict(sample.time);
      if (correction_) {
        answer.attitude.q_world_imu = correction_->follow(
            answer.attitude, sample.gyro_rad_s - filter_.gyro_bias().bias_rad_s);
      }
      ready_.push_back(answer);
    }
  }

  SpikeGate gate_;
  AttitudeEkf filter_;
  std::optional<GradualCorrection> correction_;
  std::deque<AttitudeEstimate> ready_;
};

class SmoothedStream final : public AttitudeStream {
 public:
  explicit SmoothedStream(const FixedLagSmootherParameters& parameters) : smoother_(parameters) {}

  void push(const ImuSample& sample) override { take(gate_.push(sample)); }
  void finish() override {
    take(gate_.finish());
    smoother_.finish();
  }

  std::optional<AttitudeEstimate> pop() override { return smoother_.pop(); }

  [[nodiscard]] std::string_view suspicion() const override {
    return describe(smoother_.filter().plausibility());
  }
  [[nodiscard]] std::optional<GyroBias> gyro_bias() const override {
    return learned_bias(smoother_.filter());
  }

 private:
  void take(const SpikeGate::Passed& passed) {
    for (std::size_t i = 0; i < passed.count; ++i) smoother_.push(passed.samples[i]);
  }

  SpikeGate gate_;
  FixedLagSmoother smoother_;
};

}  // namespace

std::unique_ptr<AttitudeStream> make_causal_stream(std::unique_ptr<Estimator> estimator) {
  return std::make_unique<PlainStream>(std::move(estimator));
}

std::unique_ptr<AttitudeStream> make_causal_stream(const AttitudeEkfParameters& parameters) {
  return std::make_unique<CausalStream>(parameters);
}

std::unique_ptr<AttitudeStream> make_gradual_stream(const AttitudeEkfParameters& parameters,
                                                    SensorDuration memory) {
  return std::make_unique<CausalStream>(parameters, GradualCorrection(memory));
}

std::unique_ptr<AttitudeStream> make_smoothed_stream(const FixedLagSmootherParameters& parameters) {
  return std::make_unique<SmoothedStream>(parameters);
}

}  // namespace gimbal
