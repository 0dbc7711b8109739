#compdef candela
# Completion of candela's verbs, options, words and files in zsh: `source <(candela completion zsh)` after compinit.
# The program knows its words itself: `candela completion words WORD...` says what the last of them may become.

_candela() {
  local program=${(Q)words[1]/#\~/$HOME} kind line word found=1
  local -a lines closed open
  lines=("${(@f)$($program completion words "${(@Q)words[2,CURRENT-1]}" "${(Q)PREFIX}" 2>/dev/null)}")
  kind=$lines[1]
  for line in "${(@)lines[2,-1]}"; do
    word=${line%%$'\t'*}
    line=${word//:/\\:}:${line#*$'\t'}
    # More may follow: another word of a list, a number.
    if [[ $kind == open* || $word == *[=:/] ]]; then open+=("$line"); else closed+=("$line"); fi
  done
  (( $#closed )) && _describe -t words 'words of candela' closed && found=0
  (( $#open )) && _describe -t words 'words of candela' open -S '' && found=0
  [[ $kind == *fil* || $kind == *fold* ]] && [[ $PREFIX == --*=* ]] && compset -P '*='
  [[ $kind == *files* ]] && _files && found=0
  [[ $kind == *folders* ]] && _files -/ && found=0
  return found
}

# Run as a function of its own name when it was found in fpath, declared when it was sourced.
if [[ $funcstack[1] == _candela ]]; then _candela "$@"; else compdef _candela candela; fi
