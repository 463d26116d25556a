# Asked to stop: the first signal ends the work in good order, with its status and no files left.
stop() { # signal
	mkfifo pipe
	sleep 60 >pipe &
	writer=$!
	glowworm bake - --light 'sky radiance 1' -o out.ply <pipe 2>message &
	program=$!
	# The temporary file is there before the input is read.
	tries=0
	while [ "$(find . -name '*out.ply*' | wc -l)" -eq 0 ] && [ $tries -lt 100 ]; do
		sleep 0.1
		tries=$((tries + 1))
	done
	sleep 0.3
	kill -"$1" $program
	wait $program
	echo "$1: $?"
	kill $writer
	wait $writer 2>/dev/null
	rm -f pipe message
	ls -A
}
stop INT
stop TERM
