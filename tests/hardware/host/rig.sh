# shellcheck shell=bash
# What the host's scripts share: where generated things are, what names them, how a run says no.

hardware=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
repository=$(cd "$hardware/../.." && pwd)
rig=${GIMBALD_RIG:-$repository/build/hardware}

say() { echo "hardware: $*" >&2; }

die() {
  say "$*"
  exit 1
}

# For what a machine lacks and nobody did wrong.
skip() {
  say "skipped: $*"
  exit 77
}

# The words of a file without its comments.
words_of() { sed 's/#.*//' "$1" | xargs; }

# Sixteen digits that change whenever one of the arguments does: texts, or @FILE for its content.
key_of() {
  local part
  for part in "$@"; do
    if [[ $part == @* ]]; then cat "${part#@}"; else printf '%s\n' "$part"; fi
  done | sha256sum | cut -c1-16
}

# cached NAME KEY SCRIPT [ARGUMENT..]: prints the folder $rig/NAME-KEY, which `SCRIPT FOLDER ARGUMENT..`
# has filled, now or in an earlier run. A build that fails or is killed leaves nothing that a later run
# would take; one that succeeds replaces those of other keys.
cached() {
  local name=$1 key=$2 script=$3 start=$SECONDS
  shift 3
  local folder=$rig/$name-$key log=$rig/$name.log
  if [[ ! -d $folder ]]; then
    rm -rf "${rig:?}/$name"-*
    mkdir -p "$folder.partial"
    "$BASH" "$hardware/host/$script" "$folder.partial" "$@" >"$log" 2>&1 </dev/null || {
      say "$script failed; the end of $log:"
      tail -n 5 "$log" >&2
      return 1
    }
    mv "$folder.partial" "$folder"
    say "$name built in $((SECONDS - start)) s"
  fi
  echo "$folder"
}
