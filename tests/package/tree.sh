#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tree.sh SOURCE: what lies at the top, that every source names its licence, and that no text knows one particular machine.
set -eu
cd "$1"
status=0

complain() {
  echo "tree: $1" >&2
  status=1
}

# The files of the repository, in its folders also those not yet committed; without git all that lies here, builds apart.
list() {
  if git rev-parse --git-dir >/dev/null 2>&1; then
    git ls-files
    git ls-files --others --exclude-standard src include tests meshes
  else
    find . -path './.git' -prune -o -path './build*' -prune -o -path ./.cache -prune -o -type f -print | sed 's|^\./||'
  fi
}

for name in $(list | sed 's|/.*||' | sort -u); do
  case $name in
    src | include | tests | meshes | CMakeLists.txt | CMakePresets.json | README.md | CHANGELOG.md | LICENSE | .*) ;;
    *) complain "$name does not belong at the top level" ;;
  esac
done

for file in $(list | grep -E '\.(c|h|cpp|hpp|f90|in|cmake|sh|py)$|CMakeLists\.txt$'); do
  [ -f "$file" ] || continue # deleted, not yet committed
  head -n 3 "$file" | grep -q 'SPDX-License-Identifier: Apache-2.0' || complain "$file does not name its licence"
done

# Paths of somebody's machine. The brackets keep this file from finding itself.
for file in $(list | grep -vE '\.(png|vtu|jpg|exr|tif)$'); do
  [ -f "$file" ] || continue
  if grep -nE '(^|[^[:alnum:]_.])/(hom[e]|Users|wor[k]|roo[t]|mn[t]|medi[a])/[[:alnum:]]' "$file" /dev/null >&2; then
    complain "$file has a path of one particular machine"
  fi
done
exit $status
