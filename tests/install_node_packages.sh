#!/usr/bin/env bash
# Installs the npm package copc, which reads LAZ and COPC, into a folder: install_node_packages.sh
# FOLDER. Takes npm, which is installed as a Debian package where it is missing.
set -eu
folder=$1
here=$(cd "$(dirname "$0")" && pwd)
[ ! -d "$folder/node_modules/copc" ] || exit 0
if ! command -v npm >/dev/null; then
	"$here/install_packages.sh" <(echo npm)
fi
mkdir -p "$folder"
npm install --silent --no-audit --no-fund --prefix "$folder" copc@0.0.8
