# The angle between what was said and the truth, whose heading begins elsewhere.
#   first file   t_s,qw,qx,qy,qz,.. after a heading: the truth, in the recording's time
#   second file  t_s qw qx qy qz, on a clock on which the recording began at begin_ns with first_s
# Fails where one of them is more than most_deg off, or none lies in the recording.

function remember(   i) { for (i = 0; i < 5; i++) truth[rows, i] = $(i + 1); rows++ }

# The truth at an instant, its last rows being those that were found before.
function true_at(t_s, i,   part) {
  while (row + 2 < rows && truth[row + 1, 0] <= t_s) row++
  part = (t_s - truth[row, 0]) / (truth[row + 1, 0] - truth[row, 0])
  return truth[row, i] + part * (truth[row + 1, i] - truth[row, i])
}

# Sets e: the rotation from the truth's world to the one that was said, said * conj(truth).
function set_error(t_s,   w, x, y, z) {
  w = true_at(t_s, 1); x = -true_at(t_s, 2); y = -true_at(t_s, 3); z = -true_at(t_s, 4)
  e[0] = $2 * w - $3 * x - $4 * y - $5 * z
  e[1] = $2 * x + $3 * w + $4 * z - $5 * y
  e[2] = $2 * y - $3 * z + $4 * w + $5 * x
  e[3] = $2 * z + $3 * y - $4 * x + $5 * w
}

function degrees(radians) { return radians * 57.29577951 }
function in_half_turn(deg) { while (deg > 180) deg -= 360; while (deg <= -180) deg += 360; return deg }
function size(number) { return number < 0 ? -number : number }

FNR == NR { if (FNR > 1) remember(); next }
{
  t_s = $1 - begin_ns * 1e-9 + first_s
  if (t_s > truth[rows - 1, 0] || t_s < truth[0, 0]) next
  set_error(t_s)
  tilt = degrees(2 * atan2(sqrt(e[1] ^ 2 + e[2] ^ 2), sqrt(e[0] ^ 2 + e[3] ^ 2)))
  heading = degrees(2 * atan2(e[3], e[0]))
  if (compared++ == 0) first_heading = heading
  turned = size(in_half_turn(heading - first_heading))
  printf "%.3f s: tilt %.2f deg off, heading %.2f deg since the first\n", t_s, tilt, turned
  if (tilt > most_deg || turned > most_deg) failed = 1
}
END {
  if (compared < 5) { printf "only %d orientations lie in the recording\n", compared; failed = 1 }
  exit failed
}
