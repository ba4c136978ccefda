#!/usr/bin/env bash
# A configuration that is not sound changes nothing; a sound one is taken over; the stream goes on.
# limit: 600 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

start_usual_service

cp /etc/gimbald/gimbald.toml "$scratch/sound.toml"
echo 'amount = "much"' >>/etc/gimbald/gimbald.toml
systemctl reload gimbald
wait_until "it says why not" has_said 'not reloaded: .*gimbald.toml.*amount'
expect_pictures_go_on

{ cat "$scratch/sound.toml"; echo 'amount = 0.25'; } >/etc/gimbald/gimbald.toml
systemctl reload gimbald
wait_until "it has taken it over" has_said 'reloaded: .*amount.* changed'
expect_equal "amount" "$(status_of .settings.amount)" 0.25
expect_pictures_go_on
expect_equal "process" "$(main_process)" "$process"
