# SPDX-License-Identifier: Apache-2.0
# A process that may start no further thread, by the limit that `ulimit -u` and a container's pids.max are, too. It does not hold for root: what is
# needed is a user without other processes.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
nobody=65534
limited() {
  local processes=$1
  shift
  setpriv --reuid $nobody --regid $nobody --clear-groups prlimit --nproc="$processes" -- "$@"
}
if [ "$(id -u)" != 0 ] || ! limited 1 true 2>/dev/null || ! limited 1 test -x "$tetcast" || pgrep -u $nobody >/dev/null; then
  echo 'skipped: needs root, setpriv and prlimit, and a user without processes that may run the command'
  exit 77
fi
if limited 1 sh -c 'true & wait' 2>/dev/null; then
  echo 'skipped: the limit does not hold here'
  exit 77
fi
if nm -D "$tetcast" 2>/dev/null | grep -q ' __asan_\| __tsan_'; then
  echo 'skipped: sanitizers start threads of their own'
  exit 77
fi
chmod 777 .
vtu cube.vtu "$five_tetrahedra" 10
accept render cube.vtu -o free.png --size 64x48 --quiet
for processes in 1 2 3 5 9; do
  checks=$((checks + 2))
  limited $processes "$tetcast" render cube.vtu -o "$processes.png" --size 64x48 --threads 4 --quiet >"$work.out" 2>"$work.err" ||
    fail "exit code $? with $processes processes: $(head -3 "$work.err")"
  [ ! -s "$work.err" ] || fail "standard error with $processes processes: $(head -3 "$work.err")"
  same free.png "$processes.png" "$processes processes"
  limited $processes "$tetcast" info cube.vtu >"$work.out" 2>"$work.err" || fail "info: exit code $? with $processes processes"
done
# What OpenImageIO can't do without a thread is said.
for name in a.exr a.tif; do
  checks=$((checks + 1))
  limited 1 "$tetcast" render cube.vtu -o $name --size 64x48 --quiet >"$work.out" 2>"$work.err"
  [ $? = 1 ] || fail "exit code $? for $name"
  grep -q "cannot write image '$name': .*thread" "$work.err" || fail "$name: $(head -3 "$work.err")"
  [ ! -e $name ] || fail "$name is there"
done
finish
