# Asked to stop: the first signal ends the work within a second, with its status and no files left.
# alone: yes
stop() { # signal
	mkfifo pipe
	sleep 60 >pipe &
	writer=$!
	glowworm bake - --light 'sky radiance 1' -o out.ply <pipe 2>message &
	program=$!
	# The temporary file is there before the input is read.
	tries=0
	while [ "$(find . -name '*.part' | wc -l)" -eq 0 ] && [ $tries -lt 100 ]; do
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
stop HUP
# Under nohup the terminal may close: the cloud arrives afterwards and is lit.
mkfifo pipe
(
	trap '' HUP
	exec glowworm bake - --light 'sky radiance 1' -q -o out.ply <pipe
) &
program=$!
exec 3>pipe
sleep 0.5
kill -HUP $program
printf 'ply\nformat ascii 1.0\nelement vertex 1\n' >&3
printf 'property float %s\n' x y z >&3
printf 'end_header\n0 0 0\n' >&3
exec 3>&-
wait $program
echo "HUP ignored: $?"
rm -f pipe out.ply
# Within a second, in the middle of octree and rays, by the program's own steps or without; twice
# that is for a busy machine.
make_box --scene cornell --points 20000 -o box.ply
for after in 0.3 1 3; do
	glowworm bake box.ply -q --depth 9 --rays 4096 --light-samples 4096 --threads 1 -o out.ply \
		2>message &
	program=$!
	sleep $after
	start=$(date +%s%N)
	kill -INT $program
	wait $program
	status=$?
	took=$((($(date +%s%N) - start) / 1000000))
	[ $status -eq 130 ] || echo "after $after s: status $status"
	[ $took -lt 2000 ] || echo "after $after s: stopped $took ms later"
done
# Input that has no end is given up, or stopped.
glowworm bake /dev/zero --light 'sky radiance 1' -o out.ply 2>message &
program=$!
sleep 0.3
kill -INT $program
wait $program
echo "endless: $?"
rm -f message box.ply
ls -A
