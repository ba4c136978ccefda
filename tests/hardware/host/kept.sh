# shellcheck shell=bash
# Sourced by what makes large things once and keeps them: what names them, and how a run says no.
# Usage: source kept.sh SUBJECT FOLDER    the lines that are said begin with the one, things go to the other

subject=$1
kept=$2

say() { echo "$subject: $*" >&2; }

die() {
  say "$*"
  exit 1
}

# For what a machine lacks and nobody did wrong.
skip() {
  say "skipped: $*"
  exit 77
}

# Making a tree wants these, and the archive in reach.
require_tree_tools() {
  [[ $(id -u) == 0 ]] || skip "root is needed to make a Debian tree"
  local tool
  for tool in mmdebstrap rsync apt-get "$@"; do
    command -v "$tool" >/dev/null || skip "no $tool on this machine"
  done
}

# Holds the folder for this run alone, until the shell ends.
lock_kept() {
  mkdir -p "$kept"
  exec {kept_lock}>"$kept/lock"
  flock "$kept_lock"
}

# Sixteen digits that change whenever one of the arguments does: texts, or @FILE for its content.
key_of() {
  local part
  for part in "$@"; do
    if [[ $part == @* ]]; then cat "${part#@}"; else printf '%s\n' "$part"; fi
  done | sha256sum | cut -c1-16
}

# cached NAME KEY SCRIPT [ARGUMENT..]: prints the folder $kept/NAME-KEY, which `SCRIPT FOLDER ARGUMENT..`
# has filled, now or in an earlier run. A build that fails or is killed leaves nothing that a later run
# would take; one that succeeds replaces those of other keys.
cached() {
  local name=$1 key=$2 script=$3 start=$SECONDS
  shift 3
  local folder=$kept/$name-$key log=$kept/$name.log
  if [[ ! -d $folder ]]; then
    rm -rf "${kept:?}/$name"-*
    mkdir -p "$folder.partial"
    "$BASH" "$script" "$folder.partial" "$@" >"$log" 2>&1 </dev/null || {
      say "$(basename "$script") failed; the end of $log:"
      tail -n 5 "$log" >&2
      return 1
    }
    mv "$folder.partial" "$folder"
    say "$name built in $((SECONDS - start)) s"
  fi
  echo "$folder"
}
