#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# killed.sh SECONDS COMMAND…: the command, a program of several ranks of which one is killed, ends within this time, fails, and says
# what has happened, and no rank has a picture.
set -u
limit=$1
shift
output=$(timeout "$limit" "$@" 2>&1)
status=$?
if [ $status -eq 124 ]; then
  echo "killed: still running after $limit s" >&2
  exit 1
fi
says() {
  printf '%s\n' "$output" | grep -qiE "$1"
}
if [ $status -eq 0 ] || ! says 'a picture is begun' || says 'a picture was made' || ! says 'signal|killed'; then
  printf 'killed: exit status %s, and it says: %s\n' "$status" "$output" >&2
  exit 1
fi
