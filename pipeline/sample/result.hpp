#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace gimbal {

/// An error as a person reads it: one line that says what is wrong, where, and what to do.
struct Error {
  enum class Kind {
    bad_input,  ///< usage, configuration, file or device: exit status 2
    failed,     ///< went wrong while running: exit status 1
  };
  Kind kind;
  std::string message;
};

template <typename T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> bad_input(std::string message) {
  return tl::unexpected<Error>(Error{Error::Kind::bad_input, std::move(message)});
}

inline tl::unexpected<Error> failed(std::string message) {
  return tl::unexpected<Error>(Error{Error::Kind::failed, std::move(message)});
}

}  // namespace gimbal
