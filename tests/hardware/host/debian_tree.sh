#!/usr/bin/env bash
# Makes a small Debian 13 in a folder, from the archive that this machine's own apt is set up with.
# Usage: debian_tree.sh FOLDER "PACKAGE.." [OPTION OF MMDEBSTRAP..]
set -euo pipefail

folder=$1
packages=$2
shift 2

# shellcheck disable=SC2016  # the dollar is apt's
archive=$(apt-get indextargets --format '$(REPO_URI)' \
  'Created-By: Packages' 'Origin: Debian' 'Label: Debian' 'Component: main' | sort -u | head -n 1)
[[ -n $archive ]] || {
  echo "apt on this machine knows no Debian archive" >&2
  exit 1
}

mmdebstrap --mode=root --variant=minbase --include="${packages// /,}" \
  --aptopt='Acquire::Languages "none"' --aptopt='APT::Install-Recommends "false"' \
  --dpkgopt=force-unsafe-io --dpkgopt='path-exclude=/usr/share/doc/*' \
  --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
  "$@" trixie "$folder" "$archive"
