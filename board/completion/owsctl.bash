# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# bash completion of owsctl: verbs, signals, instances, options. owsctl itself says what there is.

_owsctl() {
	local cur=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
	local verb='' at=0 i said words=''
	local -a name=()

	COMPREPLY=()
	for ((i = 1; i < COMP_CWORD; i++)); do
		case ${COMP_WORDS[i]} in
		-n) name=(-n "${COMP_WORDS[++i]}") ;;
		-t) ((i++)) ;;
		-*) ;;
		*) verb=${COMP_WORDS[i]} at=$i && break ;;
		esac
	done
	if [[ $before = -n && -z $verb || $verb = remove ]]; then
		words=$(owsctl instances 2>/dev/null | awk 'NR > 1 { print $1 }')
	elif [[ -z $verb || $verb = help ]]; then
		words=$(owsctl --help 2>/dev/null | awk '/^  [a-z]/ { print $1 }')
		[[ $cur != -* || -n $verb ]] || words='-n -t --json --help --version'
	elif [[ $cur = -* ]]; then
		words=$(owsctl help "$verb" 2>/dev/null | grep -o -e '--\?[a-zA-Z][a-zA-Z0-9-]*' | sort -u)
	elif [[ $verb = enable || $verb = disable ]]; then
		words=$(owsctl enable --dry-run '' 2>&1 | sed -n 's/.*there are: //p')
	elif [[ $verb = record ]]; then
		words='scan dir read write'
	elif [[ $verb = convert ]]; then
		compopt -o filenames 2>/dev/null
		mapfile -t COMPREPLY < <(compgen -f -- "$cur")
		return
	elif [[ $verb = config ]]; then
		case $((COMP_CWORD - at)) in
		1)
			compopt -o filenames 2>/dev/null
			mapfile -t COMPREPLY < <(compgen -f -- "$cur")
			return
			;;
		2) words='list show add set rename unset remove move' ;;
		3) words=$(owsctl config "${COMP_WORDS[at + 1]}" list 2>/dev/null |
			awk 'seen { print $1 } /^NAME / { seen = 1 }') ;;
		esac
	else
		said=$(owsctl help "$verb" 2>/dev/null | head -n 1)
		[[ $said != *NAME* && $said != *PATTERN* ]] ||
			words=$(owsctl "${name[@]}" list 2>/dev/null | awk 'NR > 1 { print $1 }')
		[[ $verb != alarms || $((COMP_CWORD - at)) != 1 ]] || words+=' history ack shelve unshelve'
	fi
	mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
}
complete -F _owsctl owsctl owsctl-sim
