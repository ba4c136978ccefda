# shellcheck shell=bash
# What the host's scripts share: where generated things are.

hardware=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
repository=$(cd "$hardware/../.." && pwd)
rig=${GIMBALD_RIG:-$repository/build/hardware}

source "$hardware/host/kept.sh" hardware "$rig"

# The words of a file without its comments.
words_of() { sed 's/#.*//' "$1" | xargs; }
