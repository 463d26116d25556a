# The generated manual and completions are well formed and know every verb and option.
glowworm --generate bash >bash.txt && bash -n bash.txt
glowworm --generate zsh | grep -c -e '--light' -e '^bake)' -e '^info)' -e '^render)'
glowworm --generate fish | grep -c -- '-l light-samples'
for page in '' -bake -plan -info -compare -mix -sample -convert -render -tradeoff -albedo \
	-doctor -lamp -measure -probes -methods; do
	glowworm --generate man-glowworm$page | grep -vE '^\.(SH|SS|TP|B|BR)( |$)' | grep '^[.]'
done
# Completion of an option's values.
bash -c '. ./bash.txt; COMP_WORDS=(glowworm bake --shadows t); COMP_CWORD=3; _glowworm
	echo "${COMPREPLY[@]}"; COMP_WORDS=(glowworm bake --light-); COMP_CWORD=2; _glowworm
	echo "${COMPREPLY[@]}"'
