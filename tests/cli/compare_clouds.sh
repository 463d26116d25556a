# Figures of compare against sums done by hand, partners by position and by index, the worst
# points, limits, and what is refused.
head_of() { # points, then names of float columns
	printf 'ply\nformat ascii 1.0\nelement vertex %d\n' "$1"
	shift
	printf 'property double %s\n' x y z
	[ $# -eq 0 ] || printf 'property float %s\n' "$@"
	echo end_header
}
light='scalar_radiance_r scalar_radiance_g scalar_radiance_b'
# Grey points: the truth 1 1 3 3; the result 1 2 2 6, backwards, and one more that emits.
{
	head_of 5 radiance_r radiance_g radiance_b emission_r emission_g emission_b stderr
	for p in '0 0 1' '1 0 1' '2 0 3' '3.1 0 3' '4 7 9'; do
		set -- $p
		echo "500000.$1 $2 0 $3 $3 $3 $((${2%.*} > 0)) 0 0 0.04"
	done
} >truth.ply
{
	head_of 6 $light infrared
	for p in '9 0 8' '4 7 1' '3.1 0 6' '2 0 2' '1 0 2' '0 0 1'; do
		set -- $p
		echo "500000.$1 $2 0 $3 $3 $3 ${1%.*}5"
	done
} >result.ply
sed -i 's/500000\.3\.1/500000.31/' truth.ply result.ply
glowworm compare result.ply truth.ply
glowworm compare - truth.ply --json - --max-relrmse 0.83 <result.ply
glowworm compare result.ply truth.ply --max-relrmse none --max-best99 0.9 --max-bias 0.37 \
	--json a.json --worst worst.ply --worst-count 2 >/dev/null
echo "status $?, missed: $(grep -c '"missed": true' a.json)"
glowworm info worst.ply --json | grep -o '"points": 2,'
glowworm info worst.ply | grep -E 'infrared|error|truth_radiance_g'
for limit in --max-relrmse --max-best99; do
	glowworm compare result.ply truth.ply $limit 0.82 >/dev/null
	echo "status $?"
done
# Against itself nothing differs; by index the places do not matter.
glowworm compare result.ply result.ply --max-relrmse 0 --max-bias 0 | sed -n 3p
# Rounded coordinates: by order, unless one of them is off by more.
{ head_of 3 $light; printf '0.1000004 0 0 1 1 1\n1 2 3 2 2 2\n5 5 5 3 3 3\n'; } >one.ply
sed 's/0.1000004/0.1/' one.ply >rounded.ply
sed 's/0.1000004/0.1002/' one.ply >moved.ply
for other in rounded moved; do
	glowworm compare $other.ply one.ply --max-relrmse 0 2>&1 | sed -n 1p
done
{ head_of 2 $light index; printf '0 0 0 1 2 3 7\n1 0 0 4 5 6 3000000\n'; } >a.ply
{ head_of 2 $light index; printf '9 0 0 4 5 6 3000000\n9 0 1 1 2 3 7\n'; } >b.ply
glowworm compare a.ply b.ply --max-relrmse 0 | head -n 3
# Points of one place: whatever their order is, what both know of them tells them apart, and light
# last, which is said where it matters. Where all are in one order, that does.
shared() { # other, then its points, of a truth with two at 0 0 0
	other=$1.ply
	shift
	{ head_of $# $columns; printf '%s\n' "$@"; } >"$other"
	glowworm compare "$other" two.ply | sed -n '1p;3s/ *[-+].*//p'
}
up='0 0 0 0 0 1' down='0 0 0 0 0 -1' beside='1 0 0 0 0 1 3 3 3'
columns="nx ny nz $light"
{ head_of 3 $columns; printf '%s\n' "$up 1 1 1" "$down 5 5 5" "$beside"; } >two.ply
shared normals "$beside" "$down 5 5 5" "$up 1 1 1"
shared swapped "$beside" "$down 1 1 1" "$up 5 5 5"
shared ordered "$up 1.5 1 1" "$down 5 5 5" "$beside"
columns=$light
{ head_of 3 $columns; printf '%s\n' '0 0 0 1 1 1' '0 0 0 5 5 5' '1 0 0 3 3 3'; } >two.ply
shared alike '1 0 0 3 3 3' '0 0 0 5 5 5' '0 0 0 1 1 1'
shared brighter '1 0 0 3 3 3' '0 0 0 5.5 5.5 5.5' '0 0 0 1.5 1.5 1.5'
shared ordered '0 0 0 5 5 5' '0 0 0 1 1 1' '1 0 0 3 3 3'
# More of them than the truth has: those in the middle.
shared more '1 0 0 3 3 3' '0 0 0 9 9 9' '0 0 0 2 2 2' '0 0 0 0 0 0' '0 0 0 6 6 6'
glowworm compare more.ply two.ply --json - | grep -e shared -e told
rm two.ply normals.ply swapped.ply ordered.ply alike.ply brighter.ply more.ply
# Where all emit, all are compared.
{ head_of 1 $light emission_r emission_g emission_b; echo 0 0 0 2 2 2 1 1 1; } >glow.ply
glowworm compare glow.ply glow.ply | head -n 1
# More quantities, under the same names.
{ head_of 1 $light scalar_direct_r scalar_direct_g scalar_direct_b; echo 0 0 0 2 2 2 1 1 1; } >d.ply
sed 's/^0 0 0 .*/0 0 0 2 2 2 2 4 8/' d.ply >e.ply
glowworm compare d.ply e.ply | tail -n 4
sed -i 's/scalar_direct/scalar_indirect_irradiance/' d.ply e.ply
glowworm compare d.ply e.ply | tail -n 8
# Refused.
run() {
	glowworm compare "$@"
	echo "status $?"
}
run result.ply 2>&1
run - - 2>&1
run truth.ply result.ply 2>&1
sed 's/3000000/3000001/' b.ply >c.ply
run a.ply c.ply 2>&1
{ head_of 1; echo 0 0 0; } >dark.ply
run dark.ply dark.ply 2>&1
sed 's/^0 0 0 2/0 0 0 nan/' d.ply >nan.ply
run nan.ply d.ply 2>&1
run result.ply truth.ply --worst result.ply 2>&1
run result.ply truth.ply --worst worst.ply 2>&1
run result.ply truth.ply --worst worst.obj 2>&1
run result.ply truth.ply --worst - --json - 2>&1
run result.ply truth.ply --max-bias 5%% 2>&1
run result.ply nowhere.ply 2>&1
ls -A | tr '\n' ' '
