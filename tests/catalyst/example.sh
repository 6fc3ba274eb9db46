#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# example.sh PROGRAM FOLDER: the example makes a picture of each twentieth step.
set -eu
rm -rf "$2"
mkdir -p "$2"
cd "$2"
"$1"
[ "$(echo heat.*)" = 'heat.000.png heat.020.png heat.040.png' ] || { echo "example: made $(echo heat.*)" >&2; exit 1; }
for picture in heat.*; do
  [ "$(wc -c <"$picture")" -gt 5000 ] || { echo "example: $picture is too small to show anything" >&2; exit 1; }
done
