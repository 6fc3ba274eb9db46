# SPDX-License-Identifier: Apache-2.0
# What shells complete is what the commands take.
. "$(dirname "$0")/lib.sh"
refuse 2 'bash, zsh or fish' completion
refuse 2 'bash, zsh or fish' completion tcsh
refuse 2 'bash, zsh or fish' completion bash zsh
for shell in bash zsh fish; do
  accept completion $shell
  printf '%s\n' "$output" >$shell.txt
done
bash -n bash.txt || fail 'bash does not take its script'
for shell in zsh fish; do
  if command -v $shell >/dev/null; then $shell -n $shell.txt || fail "$shell does not take its script"; fi
done

# completes WORDS…: what bash offers for the last of them goes to $output.
completes() {
  checks=$((checks + 1))
  output=$(bash --norc -c '. ./bash.txt; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _tetcast; echo "${COMPREPLY[*]}"' - tetcast "$@")
}
# offers EXPECTED WORDS…
offers() {
  local expected=$1
  shift
  completes "$@"
  [ "$output" = "$expected" ] || fail "'$output' instead of '$expected': $*"
}
offers render re
offers 'converge cast completion' c
offers 'render converge transfer cast info mesh completion' help ''
offers 'bash zsh fish' completion ''
offers '--preset' render --pre
offers 'viridis' render --preset v
offers 'viridis' render --preset = v
offers 'inferno' render --preset inf
offers 'unit-distance' converge x.vtu --opacity-model u
offers 'shell faces' render x.vtu -o a.png --traversal ''
offers '--formats' info --f
offers 'gaussians gyroid glow' mesh --field g
offers 'teal transparent' render --background t
offers '' render --output a # files, by readline's own default
offers '' render x

# Every option that is offered is taken, and is in the manual; every one that the help has is offered, in all shells.
for command in render converge transfer cast info mesh; do
  completes $command --
  offered=$(tr ' ' '\n' <<<"$output" | sort)
  helped=$("$tetcast" $command --help | grep -oE -- '(^|[ ,])--[a-z][a-z-]+' | tr -d ' ,' | sort -u)
  missing=$(comm -13 <(echo "$offered") <(echo "$helped"))
  [ -z "$missing" ] || fail "$command --help has what is not offered: $missing"
  for option in $offered; do
    checks=$((checks + 1))
    if "$tetcast" $command $option 2>&1 </dev/null | grep -q 'unknown'; then fail "$command does not take $option"; fi
  done
  in_zsh=$(sed -n "/^    $command)\$/,/;;/p" zsh.txt | grep -o -- "'--[a-z-]*" | tr -d "'" | sort)
  in_fish=$(sed -n "s/.*seen_subcommand_from $command' -l \([a-z-]*\).*/--\1/p" fish.txt | sort)
  [ "$in_zsh" = "$offered" ] || fail "zsh and bash offer different options of $command:" $(comm -3 <(echo "$in_zsh") <(echo "$offered"))
  [ "$in_fish" = "$offered" ] || fail "fish and bash offer different options of $command:" $(comm -3 <(echo "$in_fish") <(echo "$offered"))
done
for option in $("$tetcast" render --help | grep -oE -- '--[a-z][a-z-]+' | sort -u); do
  completes render "$option"
  [[ " $output " = *" $option "* ]] || fail "$option of render's help is not offered"
done

# The words that are offered for a value are taken as one.
for pair in preset:"$(sed -n "s/.*'render --preset') words='\(.*\)' ;;/\1/p" bash.txt)" \
  background:"$(sed -n "s/.*'render --background') words='\(.*\)' ;;/\1/p" bash.txt)" \
  isa:"$(sed -n "s/.*'render --isa') words='\(.*\)' ;;/\1/p" bash.txt)"; do
  [ -n "${pair#*:}" ] || fail "no words for ${pair%%:*}"
  for word in ${pair#*:}; do refuse 2 'no input' render "--${pair%%:*}" "$word"; done
done
finish
