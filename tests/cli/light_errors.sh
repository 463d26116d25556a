# Whatever is wrong with a light, the message names the word and where it stands.
run() {
	glowworm bake a.ply -o out.ply --light "$1" 2>&1
	[ $? -eq 2 ] || echo "status was not 2: $1"
}
run ''
run 'spt at 1,2,3'
run 'spot at 1,2 to 3,4,5'
run 'spot at 1,2,x to 3,4,5'
run 'spot at'
run 'spot at 1,2,3 to 4,5,6'
run 'spot at 1,2,3 intensity 4'
run 'spot at 1,2,3 to 1,2,3 intensity 4'
run 'spot at 1,2,3 to 4,5,6 toward 0,0,1 intensity 4'
run 'spot at 1,2,3 toward 0,0,0 intensity 4'
run 'spot at 1,2,3 to 4,5,6 intensity 4 inner 50 outer 40'
run 'spot at 1,2,3 to 4,5,6 intensity 4 outer 181'
run 'point at 1,2,3 intensity -4'
run 'point at 1,2,3 intensity inf'
run 'point at 1,2,3 intensity 1,2'
run 'point at 1,2,3 at 1,2,3 intensity 1'
run 'point at 1,2,3 intensity 1 inner 3'
run 'point at 1,2,3 intensty 1'
run 'sun from 135 irradiance 3'
run 'sun from 135,91 irradiance 3'
run 'sun irradiance 3'
run 'sky radiance 1,2,3,4'
run 'sky name this-name-is-longer-than-the-sixty-three-characters-that-a-name-can-have'
