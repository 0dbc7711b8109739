# Completion of candela's verbs, options, words and files in bash: `source <(candela completion bash)`.
# The program knows its words itself: `candela completion words WORD...` says what the last of them may become.
# shellcheck shell=bash

_candela() {
  COMPREPLY=()
  # Readline divides words at = and :, too (COMP_WORDBREAKS). Pieces without a blank between them are one word.
  local rest=${COMP_LINE:0:COMP_POINT} piece="" words=() i
  for ((i = 0; i <= COMP_CWORD; ++i)); do
    piece=${COMP_WORDS[i]}
    if [[ $rest == [[:space:]]* || ${#words[@]} -eq 0 ]]; then
      rest=${rest#"${rest%%[![:space:]]*}"}
      words+=("")
    fi
    [[ $rest == "$piece"* ]] || piece=$rest # what is behind the cursor does not count
    words[${#words[@]} - 1]+=$piece
    rest=${rest#"$piece"}
  done
  [[ $piece != [=:] ]] || piece=""
  local word=${words[${#words[@]} - 1]}
  local before=${word%"$piece"} # which readline leaves as it is

  local lines=() program=${words[0]/#\~/$HOME}
  mapfile -t lines < <("$program" completion words "${words[@]:1}" 2>/dev/null)
  local kind=${lines[0]-} line found
  for line in "${lines[@]:1}"; do
    line=${line%%$'\t'*}
    COMPREPLY+=("${line#"$before"}")
  done
  found=()
  if [[ -z $before || $before == --*= ]]; then # no file is named by what follows studio:
    case $kind in
      *files) mapfile -t found < <(compgen -f -- "$piece") ;;
      *folders) mapfile -t found < <(compgen -d -- "$piece") ;;
    esac
  fi
  if ((${#found[@]} > 0)); then
    compopt -o filenames 2>/dev/null
    COMPREPLY+=("${found[@]}")
  fi
  # More may follow: another word of a list, a number.
  if [[ $kind == open* ]] || { ((${#COMPREPLY[@]} == 1)) && [[ ${COMPREPLY[0]} == *[=:/] ]]; }; then
    compopt -o nospace 2>/dev/null
  fi
}

complete -F _candela candela
