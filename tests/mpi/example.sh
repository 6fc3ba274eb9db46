#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# example.sh FOLDER COMMAND…: the example, run there, loses nothing and writes a picture that shows something.
set -eu
mkdir -p "$1"
cd "$1"
shift
rm -f partitioned.ppm
"$@" >log
cat log
grep -q ' 0 lost' log || {
  echo 'example: something was lost' >&2
  exit 1
}
[ "$(od -An -v -tu1 -w1 partitioned.ppm | sort -u | wc -l)" -gt 50 ] || {
  echo 'example: the picture shows nothing' >&2
  exit 1
}
