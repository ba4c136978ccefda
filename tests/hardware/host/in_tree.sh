# shellcheck shell=bash
# Sourced by what compiles gimbald in a Debian tree that debian_tree.sh has made.

# copy_source REPOSITORY TREE: lays the sources in TREE/source. A file keeps its time unless its content
# changes, so that sources from several checkouts, or from a fresh one, do not look new, or old, to ninja.
copy_source() {
  rsync --recursive --links --checksum --delete \
    --exclude=/.git --exclude='/build*' --exclude=/demo-output "$1/" "$2/source/"
}

# in_tree TREE CCACHE COMMAND [ARGUMENT..]: runs it there, with that folder for compiled objects. The
# mounts end with the shell.
in_tree() {
  # shellcheck disable=SC2016  # expanded by the shell inside
  unshare --mount sh -euc '
    tree=$1
    mount --bind "$2" "$tree/ccache"
    mount -t proc proc "$tree/proc"
    shift 2
    exec env CCACHE_DIR=/ccache chroot "$tree" "$@"
  ' sh "$@"
}
