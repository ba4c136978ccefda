#!/usr/bin/env bash
# A configuration that is not sound changes nothing; a sound one is taken over; the stream goes on.
# limit: 600 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

has_amount() { [[ $(status_of .settings.amount) == "$1" ]]; }

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

# Drop-ins that come and go count as well.
readonly drop_in=/etc/gimbald/conf.d/half.toml
mkdir -p "${drop_in%/*}"
printf '[stabilization]\namount = 0.5\n' >"$drop_in"
gimbalctl reload
expect_equal "amount with a drop-in" "$(status_of .settings.amount)" 0.5
rm "$drop_in"
systemctl reload gimbald
wait_until "the drop-in is forgotten" has_amount 0.25
expect_pictures_go_on
expect_equal "process" "$(main_process)" "$process"
