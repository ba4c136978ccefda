# bash completion for gimbalctl and gimbald. What there is to complete is asked of the programs
# themselves, so that it is always what they take.

# Words of a section of a help text on standard input: _gimbald_words Subcommands|Options
_gimbald_words() {
  awk -v section="$1:" '
    /^[^ ]/ { inside = $0 == section; next }
    inside && /^  [^ ]/ { gsub(",", " ", $1); print $1 }'
}

# The words that an option may be followed by, where its help names them: _gimbald_values OPTION
_gimbald_values() {
  awk -v option="$1" '
    /^  -/ && ("," $1 ",") ~ ("," option ",") && $2 ~ /[|]/ { gsub("[|]", " ", $2); print $2 }'
}

_gimbald() {
  local program=$1 word=$2 before=$3 command=() help next
  help=$("$program" --help 2>/dev/null) || return
  for next in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ " $(_gimbald_words Subcommands <<<"$help" | xargs) " == *" $next "* ]] || continue
    command+=("$next")
    help=$("$program" "${command[@]}" --help 2>/dev/null) || return
  done

  local choices
  if [[ $word == -* ]]; then
    choices=$(_gimbald_words Options <<<"$help")
  elif [[ $before == -* ]]; then
    choices=$(_gimbald_values "$before" <<<"$help")
  else
    choices=$(_gimbald_words Subcommands <<<"$help")
  fi
  mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
}

# Where nothing of its own fits, a file is meant.
complete -o default -F _gimbald gimbalctl gimbald
