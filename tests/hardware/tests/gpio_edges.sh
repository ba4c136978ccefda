#!/usr/bin/env bash
# Edges of a line are seen, in order, stamped on CLOCK_MONOTONIC; what a program drives can be read.
source /hardware/guest/test.sh
needs gpio_sim

line_is_used() { gpioinfo --chip "$gpio_chip" "$1" | grep -q consumer; }

gpiomon --chip "$gpio_chip" --num-events=4 --event-clock=monotonic --format='%E %S' strobe \
  >"$scratch/edges" 2>&1 &
monitor=$!
wait_until "the line is watched" line_is_used strobe
for direction in up down up down; do
  pull 0 "$direction"
  sleep 0.2
done
wait "$monitor"

expect_equal "edges" "$(cut -d ' ' -f 1 "$scratch/edges" | xargs)" "rising falling rising falling"
cut -d ' ' -f 2 "$scratch/edges" | expect_rising "stamp"

gpioset --chip "$gpio_chip" --daemonize led=1
expect_equal "level of the LED" "$(level 3)" 1
pkill -x gpioset
