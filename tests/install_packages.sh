#!/usr/bin/env bash
# Installs the Debian packages that a list names (one a line, # begins a comment), if any of them
# is missing. Says nothing when all are there.
set -eu
list=$1
if ! command -v dpkg-query >/dev/null; then
	echo "this is no Debian; install what corresponds to the packages in $list" >&2
	exit 0
fi
missing=()
while read -r package _; do
	case $package in
	'' | '#'*) continue ;;
	esac
	status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
	[ "$status" = installed ] || missing+=("$package")
done <"$list"
[ ${#missing[@]} -gt 0 ] || exit 0

sudo=()
if [ "$(id -u)" -ne 0 ]; then
	command -v sudo >/dev/null || {
		echo "root has to install: apt-get install ${missing[*]}" >&2
		exit 1
	}
	sudo=(sudo)
fi
echo "installing ${missing[*]}" >&2
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { "${sudo[@]}" apt-get update -q && "${sudo[@]}" apt-get install -q -y \
	--no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
	tail -n 30 "$log" >&2
	exit 1
fi
