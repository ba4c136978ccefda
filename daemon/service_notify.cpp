#include "daemon/service_notify.hpp"

#ifdef GIMBALD_HAS_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

namespace gimbal {

void notify_service([[maybe_unused]] const std::string& state) {
#ifdef GIMBALD_HAS_SYSTEMD
  sd_notify(0, state.c_str());
#endif
}

}  // namespace gimbal
