#!/usr/bin/env bash
# Mesa's software renderer compiles what it draws with; what shuts the service in must let it.
# limit: 600 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh

watchdog_s=300
start_service <<TOML
outputs = ["identity ! fakesink"]
[replay]
session = "$session"
[stabilization]
warper = "gles"
TOML
wait_until "5 pictures are drawn" have_shown 5
[[ $(status_of .renderer) == *llvmpipe* ]] || fail "drawn by $(status_of .renderer)"
