# The effective scene: options before the file, the file before defaults, inputs beside the file;
# and what was printed gives the same again.
mkdir folder
cat >folder/scene.json <<'EOF'
{"version": 1, "units": "photometric",
 "inputs": [{"file": "a.ply", "emission": [5, 4, 3], "albedo": 0.25}, {"file": "/b.ply"}],
 "lights": [{"name": "lamp", "type": "spot", "position": [500000.125, 2, 3],
             "direction": [0, 0, -1], "intensity": 0.1}],
 "bake": {"rays": 128, "albedo": "constant:0.3", "bounces": 3, "memory": "2G"}}
EOF
glowworm bake folder/scene.json c.ply --rays 7 --up z --light 'sun from 90,0 irradiance 1,2,3' \
	--print-scene | tee printed.json
glowworm bake printed.json --print-scene | cmp - printed.json
# Azimuth and elevation: from the north and from the zenith, with z up and with y up.
for up in y z; do
	glowworm bake a.ply --up $up --light 'sun from 0,0 irradiance 1' \
		--light 'sun from 0,90 irradiance 1' --print-scene |
		sed -n '/"sun"/{s/-*6.123233995736766e-17/0/g;p}'
done
