#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# killed.sh SECONDS COMMAND…: the command, a program of several ranks of which one is killed, ends within this time, fails, and says something.
set -u
limit=$1
shift
output=$(timeout "$limit" "$@" 2>&1)
status=$?
if [ $status -eq 124 ]; then
  echo "killed: still running after $limit s" >&2
  exit 1
fi
if [ $status -eq 0 ] || [ -z "$output" ]; then
  printf 'killed: exit status %s, and it says: %s\n' "$status" "$output" >&2
  exit 1
fi
