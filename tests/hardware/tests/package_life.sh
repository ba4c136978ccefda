#!/usr/bin/env bash
# The package can be installed over itself while the service runs, and leaves nothing behind but the user.
# limit: 600 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

start_usual_service
dpkg --install --force-confold /program/*.deb
wait_until "it runs again" is_active
[[ $(main_process) != "$process" ]] || fail "the old program still runs"
wait_until "pictures are shown again" have_shown 10
stop_service
unplugging=("${unplugging[@]:1}")

dpkg --purge gimbald
left=$(dpkg -L gimbald 2>/dev/null || true)
expect_equal "files left" "$left$(ls -d /etc/gimbald /usr/share/gimbald /var/cache/gimbald 2>/dev/null)" ""
expect_equal "unit" "$(systemctl show --property LoadState --value gimbald)" not-found
id gimbald
dpkg --install /program/*.deb
