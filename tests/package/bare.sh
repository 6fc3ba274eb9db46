#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# bare.sh RELEASE [FOLDER] [COMMAND…]: runs README.md's two commands in a bare Debian of this release (bookworm is 12, trixie 13), as root, with
# debootstrap and Debian's mirror at hand. Not one of ctest's tests: it takes an hour, most of it the builds.
#
# FOLDER, /var/tmp/tetcast-RELEASE if there is none, becomes the root of that system and stays, so that a further run is sooner; a system that is
# there is used as it is. What is tested is a clone of what is committed here, anew each time. With COMMANDs, "build" or "test" or both, only these.
# MIRROR, in the environment, is where packages come from.
set -eu
[ "$(id -u)" -eq 0 ] || {
  echo 'bare.sh: debootstrap and chroot need root' >&2
  exit 1
}
# What is mounted is seen from here alone, and gone at the end.
[ -n "${TETCAST_BARE-}" ] || TETCAST_BARE=yes exec unshare --mount --propagation private sh "$0" "$@"
release=${1:?bare.sh: which release? bookworm or trixie}
root=${2:-/var/tmp/tetcast-$release}
shift
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- build test
source=$(cd "$(dirname "$0")/../.." && pwd)
mirror=${MIRROR:-http://deb.debian.org/debian}

if [ ! -e "$root/etc/debian_version" ]; then
  mkdir -p "$root"
  debootstrap --variant=minbase "$release" "$root" "$mirror"
fi

# The system sees the processes, devices and processors of this one, the last of which MPI asks for, and a name server.
mkdir -p "$root/proc" "$root/dev" "$root/sys"
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --rbind -o ro /sys "$root/sys"
cp -L /etc/resolv.conf "$root/etc/resolv.conf" 2>/dev/null || :
cp -L /etc/hosts "$root/etc/hosts" 2>/dev/null || :

# A clone, as a newcomer has it.
clone="$root/srv/tetcast"
rm -rf "$clone"
mkdir -p "$root/srv"
git clone -q --no-hardlinks "$source" "$clone"
git -C "$clone" checkout -q "$(git -C "$source" rev-parse HEAD)"

# command NUMBER: the README's NUMBER-th block of shell, which is one command: the picture, or the tests.
command() {
  awk -v wanted="$1" '/^```sh$/ { ++n; inside = 1; next } /^```$/ { inside = 0 } inside && n == wanted' "$clone/README.md"
}

inside() {
  echo "── Debian $(cat "$root/etc/debian_version"): $1"
  started=$(date +%s)
  status=0
  chroot "$root" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    sh -c "cd /srv/tetcast && $1" || status=$?
  echo "── exit status $status after $(($(date +%s) - started)) s"
  return $status
}

status=0
for what in "$@"; do
  case $what in
    build) inside "$(command 1) && ls -l build/hydrogen.png" || status=1 ;;
    test) inside "$(command 2)" || status=1 ;;
    *) inside "$what" || status=1 ;; # anything else to run there
  esac
done
exit $status
